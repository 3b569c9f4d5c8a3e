// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Plain event files: columns, separators, units, damage.
#include "edged/io/text/event_text.hpp"

#include <gmock/gmock.h>

#include <random>

#include "edged/io/open_recording.hpp"
#include "edged/io/parse/evt_test_support.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

const cv::Size kSensor(346, 260);

/// 20000 events in some 0.2 s, with stamps of whole microseconds.
std::vector<Event> csv_events() { return generated_events(20'000, kSensor.width, kSensor.height, 100); }

std::string stamp_text(Timestamp t, TimeUnit unit) {
  if (unit == TimeUnit::Seconds) return format_seconds(t);
  return std::to_string(to_ns(t) / static_cast<std::int64_t>(std::pow(10.0, static_cast<int>(unit))));
}

/// columns: the order, such as "xypt"; one letter each.
std::string csv_text(const std::vector<Event>& events, const std::string& columns, const std::string& separator,
                     TimeUnit unit, bool signed_polarity = false) {
  std::string text;
  for (const Event& e : events) {
    const std::map<char, std::string> fields = {{'t', stamp_text(e.t, unit)},
                                                {'x', std::to_string(e.x)},
                                                {'y', std::to_string(e.y)},
                                                {'p', e.positive        ? "1"
                                                      : signed_polarity ? "-1"
                                                                        : "0"},
                                                {'n', "77"}};
    for (const char column : columns) text += (column == columns[0] ? "" : separator) + fields.at(column);
    text += "\n";
  }
  return text;
}

Recording open_csv(const std::filesystem::path& file, std::optional<TimeUnit> unit = std::nullopt) {
  return open_recording(file, nullptr, {.geometry = kSensor, .time_unit = unit});
}

TEST(EventCsv, EveryOrderSeparatorAndPolarityIsFoundFromTheContent) {
  TempFolder folder;
  const std::vector<Event> events = csv_events();
  for (const char* order : {"txyp", "xypt", "xytp", "tpxy"})
    for (const char* separator : {" ", ",", ", ", "\t", ";"})
      for (const bool is_signed : {false, true}) {
        const auto file = folder.write("a.csv", csv_text(events, order, separator, TimeUnit::Microseconds, is_signed));
        const Recording recording = open_csv(file);
        EXPECT_TRUE(read_all(*recording.dataset).events == events) << order << separator;
        EXPECT_TRUE(recording.dataset->repairs().empty());
        EXPECT_EQ(recording.dataset->info().end, events.back().t);
      }
}

TEST(EventCsv, AHeaderNamesColumnsAndUnit) {
  TempFolder folder;
  std::vector<Event> events = csv_events();
  events.resize(3);  // too few for any guess
  const struct {
    const char *header, *order, *separator;
    TimeUnit unit;
  } cases[] = {
      {"t[s],x,y,p\n", "txyp", ",", TimeUnit::Seconds},
      {"timestamp (us); col; row; polarity\n", "txyp", ";", TimeUnit::Microseconds},
      {"# x y polarity timestamp [ns]\n", "xypt", " ", TimeUnit::Nanoseconds},
      {"# some tool\n#\"id\",\"y\",\"x\",\"t_us\",\"p\"\n", "nyxtp", ",", TimeUnit::Microseconds},
  };
  for (const auto& c : cases) {
    const Recording recording =
        open_csv(folder.write("a.txt", c.header + csv_text(events, c.order, c.separator, c.unit)));
    EXPECT_TRUE(read_all(*recording.dataset).events == events) << c.header;
    EXPECT_TRUE(recording.dataset->repairs().empty()) << c.header;
  }
}

TEST(EventCsv, TheSizeOfTheSensorMayStandInTheFile) {
  TempFolder folder;
  const std::vector<Event> events = csv_events();
  for (const char* header : {"346 260\n", "# geometry 346x260\n", "%geometry:346,260\n"}) {
    const auto file = folder.write("a.txt", header + csv_text(events, "txyp", " ", TimeUnit::Seconds));
    const Recording recording = open_recording(file);
    EXPECT_EQ(recording.dataset->info().event_sensor, kSensor);
    EXPECT_EQ(read_all(*recording.dataset).events.size(), events.size());
    EXPECT_TRUE(recording.dataset->repairs().empty());
  }
  const auto silent = folder.write("a.txt", csv_text(events, "txyp", " ", TimeUnit::Seconds));
  EXPECT_THAT(input_error([&] { open_recording(silent); }), HasSubstr("--geometry"));
}

TEST(EventCsv, PolaritiesMayBeTrueAndFalse) {
  TempFolder folder;
  const std::vector<Event> events = csv_events();
  std::string text = "x,y,p,t[us]\n";
  for (const Event& e : events)
    text +=
        fmt::format("{},{},{},{}\n", e.x, e.y, e.positive ? "True" : "False", stamp_text(e.t, TimeUnit::Microseconds));
  const Recording recording = open_csv(folder.write("a.csv", text));
  EXPECT_TRUE(read_all(*recording.dataset).events == events);
  EXPECT_TRUE(recording.dataset->repairs().empty());
}

/// A recording of this duration and event rate, with stamps in that unit from `begin_s` on.
StampSample stamps_of(double rate_hz, double lasts_s, TimeUnit unit, double begin_s = 0) {
  const double per_s = std::pow(10.0, 9 - static_cast<double>(unit));
  StampSample s;
  s.count = 4000;
  s.first = std::floor(begin_s * per_s);
  s.last = std::floor((begin_s + 4000 / rate_hz) * per_s);
  s.end = std::floor((begin_s + lasts_s) * per_s);
  return s;
}

TEST(EventCsvUnit, IsFoundForUsualRecordings) {
  for (const double rate_hz : {1e5, 1e6, 5e6})
    for (const double lasts_s : {10.0, 60.0, 600.0})
      for (const double begin_s : {0.0, 500.0, 1.5e9}) {
        for (const TimeUnit unit : {TimeUnit::Microseconds, TimeUnit::Nanoseconds})
          EXPECT_EQ(guess_time_unit(stamps_of(rate_hz, lasts_s, unit, begin_s)), unit)
              << rate_hz << " Hz, " << lasts_s << " s from " << begin_s << " s, 1e" << static_cast<int>(unit);
        StampSample seconds = stamps_of(rate_hz, lasts_s, TimeUnit::Seconds, begin_s);
        seconds.last = begin_s + 4000 / rate_hz;
        seconds.fractions = true;
        EXPECT_EQ(guess_time_unit(seconds), TimeUnit::Seconds);
      }
}

TEST(EventCsvUnit, IsNeverGuessedWrongly) {
  for (double rate_hz = 1e3; rate_hz <= 5e7; rate_hz *= 2)
    for (double lasts_s = 0.01; lasts_s <= 3600; lasts_s *= 3)
      for (const TimeUnit unit : {TimeUnit::Milliseconds, TimeUnit::Microseconds, TimeUnit::Nanoseconds}) {
        if (rate_hz < 3e3 || lasts_s < 0.1) continue;  // not a realistic recording of an event camera
        const auto guess = guess_time_unit(stamps_of(rate_hz, std::max(lasts_s, 5000 / rate_hz), unit));
        EXPECT_EQ(guess.value_or(unit), unit) << rate_hz << " Hz for " << lasts_s << " s";
      }
}

TEST(EventCsvUnit, IsAskedForWhereItIsNotCertain) {
  TempFolder folder;
  const auto file = folder.write("a.csv", "0,1,2,1\n10,2,2,0\n20,3,2,1\n");
  EXPECT_THAT(input_error([&] { open_csv(file); }), HasSubstr("--time-unit"));
  EXPECT_EQ(to_ns(read_all(*open_csv(file, TimeUnit::Milliseconds).dataset).events[2].t), 20'000'000);
  EXPECT_EQ(to_ns(read_all(*open_csv(file, TimeUnit::Seconds).dataset).events[2].t), 20'000'000'000);
}

TEST(EventCsv, OtherTextsAreNotTakenForEvents) {
  TempFolder folder;
  for (const char* text : {"0.0 1 2 3 0 0 0 1\n0.1 1 2 3 0 0 0 1\n", "0.1 a b c\n", "t,x,y,p\n", "# nothing\n", "",
                           "1 2 3\n", "0.1 1.5 2.5 0.3\n0.2 1.5 2.5 0.3\n", "a,b,c,d\n1,2,3,4\n"})
    EXPECT_THAT(input_error([&] { open_csv(folder.write("a.txt", text)); }), HasSubstr("unknown file format")) << text;
}

TEST(EventCsv, CutAnywhereItGivesTheWholeLinesBefore) {
  TempFolder folder;
  const std::vector<Event> events = csv_events();
  const std::string whole = "x,y,t[us],p\n" + csv_text(events, "xytp", ",", TimeUnit::Microseconds);
  for (std::size_t percent = 1; percent < 100; ++percent) {
    const Recording recording = open_csv(folder.write("a.csv", whole.substr(0, whole.size() * percent / 100)));
    const std::vector<Event> read = read_all(*recording.dataset).events;
    ASSERT_GE(read.size() + 2, events.size() * percent / 100);
    EXPECT_TRUE(std::equal(read.begin(), read.end() - 1, events.begin())) << percent;
  }
}

TEST(EventCsv, FlippedBitsAreMendedOrRefused) {
  TempFolder folder;
  std::vector<Event> events = csv_events();
  events.resize(2000);
  const std::string whole = "# geometry 346x260\nt[s],x,y,p\n" + csv_text(events, "txyp", ",", TimeUnit::Seconds);
  std::mt19937 random(11);
  for (int i = 0; i < 400; ++i) {
    std::string damaged = whole;
    for (int flips = 0; flips < 3; ++flips) {
      const std::size_t at = random() % (i % 2 == 0 ? 100 : whole.size());
      damaged[at] = static_cast<char>(damaged[at] ^ 1 << random() % 8);
    }
    const auto file = folder.write("a.csv", damaged);
    const std::string message = input_error([&] {
      Timestamp before = Timestamp::min();
      for (const Event& e : read_all(*open_csv(file).dataset).events) {
        ASSERT_TRUE(e.x < kSensor.width && e.y < kSensor.height && e.t >= before);
        before = e.t;
      }
    });
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace edged
