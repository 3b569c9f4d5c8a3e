// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Stamps, numbers and event lines; order and damage in events.txt.
#include "edged/io/text/event_text.hpp"

#include <gmock/gmock.h>

#include <random>

#include "edged/io/test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

std::optional<std::int64_t> ns(std::string_view text) {
  const auto t = parse_stamp(text, TimeUnit::Seconds);
  if (!t) return std::nullopt;
  return to_ns(*t);
}

TEST(Seconds, AreExactToTheNanosecond) {
  EXPECT_EQ(ns("0.003811001"), 3'811'001);
  EXPECT_EQ(ns("1468939993.067416019"), 1'468'939'993'067'416'019);
  EXPECT_EQ(ns("1.403715529112143517e+09"), 1'403'715'529'112'143'517);
  EXPECT_EQ(ns("17"), 17'000'000'000);
  EXPECT_EQ(ns("-0.5"), -500'000'000);
  EXPECT_EQ(ns("5e-10"), 1);
  EXPECT_EQ(ns("4.9e-10"), 0);
  EXPECT_EQ(ns("0.0000000005"), 1);
  EXPECT_EQ(ns("1e-30"), 0);
}

TEST(Seconds, RefuseWhatIsNoStamp) {
  for (const char* text : {"", "nan", "inf", "-", ".", "1.2.3", "12a", "1e", "1e9x", "9999999999999", "1e400", "0x10"})
    EXPECT_EQ(ns(text), std::nullopt) << text;
}

TEST(Seconds, PrintAndReadBack) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 1000; ++i) {
    const auto t = timestamp_from_ns(static_cast<std::int64_t>(random() >> 2) - (std::int64_t{1} << 60));
    EXPECT_EQ(parse_stamp(format_seconds(t), TimeUnit::Seconds), t);
  }
}

TEST(EventLine, IsReadExactly) {
  Event e;
  ASSERT_TRUE(parse_event_fields("1468939993.067416019 239 179 1\r", {}, e));
  EXPECT_EQ(to_ns(e.t), 1'468'939'993'067'416'019);
  EXPECT_EQ(e.x, 239);
  EXPECT_EQ(e.y, 179);
  EXPECT_TRUE(e.positive);
}

TEST(EventLine, RefusesWhatIsNoEvent) {
  for (const std::string text : {"\n", "0.1\n", "0.1 2\n", "0.1 2 3\n", "0.1 2 3 \n", "0.1 2 3 2\n", "0.1 2 3 1 4\n",
                                 "nan 2 3 1\n", "0.1 nan 3 1\n", "0.1 -2 3 1\n", "0.1 70000 3 1\n", "0.1 2 123456 1\n",
                                 "99999999999 2 3 1\n", "x\n", "0.1 2 3 10\n", " \t\n"}) {
    Event e;
    EXPECT_FALSE(parse_event_fields(text.substr(0, text.size() - 1), {}, e)) << text;
  }
}

TEST(EventLine, OfAnotherWriterIsReadFieldByField) {
  Event e;
  ASSERT_TRUE(parse_event_fields("1.468939993067416019e+09,9.6e+01,133.0,0", {}, e));
  EXPECT_EQ(e, (Event{timestamp_from_ns(1'468'939'993'067'416'019), 96, 133, false}));
}

/// A pixel of up to five digits, one in a hundred too large.
std::string any_pixel(std::mt19937& random) {
  constexpr std::array<unsigned, 5> kBelow{10, 100, 1000, 10'000, 65'536};
  return std::to_string(random() % 100 == 0 ? 100'000 : random() % kBelow.at(random() % kBelow.size()));
}

TEST(EventStream, ReadsEachLineAsFieldByFieldHoweverManyDigitsItHas) {
  std::mt19937 random(11);
  const std::array<std::string, 7> separators{" ", " ", ",", ";", "\t", ", ", " , "};
  const std::array<std::string, 4> ends{"\n", "\n", "\r\n", " \n"};
  std::string text;
  std::vector<Event> expected;
  for (std::int64_t s = 0; s < 20'000; ++s) {
    const std::string& by = separators.at(random() % separators.size());
    const std::string number = std::string(random() % 5, '0') + std::to_string(1'000'000 + s / 10);
    const std::string decimals = random() % 2 == 0 ? fmt::format("{:09}", s % 10 * 100'000'007)
                                                   : std::to_string(s % 10) + std::string(random() % 10, '0');
    const std::string x = any_pixel(random), y = any_pixel(random);
    const std::string line = fmt::format("{}.{}{}{}{}{}{}{}", number, decimals, by, x, by, y, by, random() % 2);
    text += line + ends.at(random() % ends.size());
    Event event;
    if (parse_event_fields(line, {}, event)) expected.push_back(event);
  }
  TempFolder folder;
  Repairs repairs;
  EventTextStream stream(folder.write("events.txt", text), {}, 65536, 65536, repairs);
  std::vector<Event> events;
  while (const Event* first = stream.peek()) {
    const auto batch = stream.take_before(first->t + std::chrono::seconds(100));
    events.insert(events.end(), batch.begin(), batch.end());
  }
  EXPECT_GT(expected.size(), 10'000U);
  EXPECT_EQ(events, expected);
}

/// 5000 events every 10 us, as text.
std::string steady_events(int n = 5000) {
  std::string text;
  for (int i = 0; i < n; ++i)
    text += fmt::format("{} {} {} {}\n", format_seconds(timestamp_from_ns(i * 10'000)), i % 240, i % 180, i % 2);
  return text;
}

struct Stream {
  std::vector<Event> events;
  std::map<std::string, std::size_t> repairs;
};

Stream read_stream(const std::filesystem::path& file, Duration step = std::chrono::milliseconds(2)) {
  Repairs repairs;
  EventTextStream stream(file, {}, 240, 180, repairs);
  Stream out;
  while (const Event* first = stream.peek()) {
    const auto batch = stream.take_before(first->t + step);
    EXPECT_FALSE(batch.empty());
    out.events.insert(out.events.end(), batch.begin(), batch.end());
  }
  EXPECT_TRUE(
      std::is_sorted(out.events.begin(), out.events.end(), [](const Event& a, const Event& b) { return a.t < b.t; }));
  out.repairs = repairs.counts();
  return out;
}

TEST(EventStream, GivesEveryEventOnceWhateverTheSteps) {
  TempFolder folder;
  const auto file = folder.write("events.txt", steady_events(60'000));
  for (const auto step : {Duration(1), Duration(25'000), Duration(5'000'000), Duration(1'000'000'000)}) {
    const Stream s = read_stream(file, step);
    ASSERT_EQ(s.events.size(), 60'000u);
    for (std::size_t i = 0; i < s.events.size(); ++i)
      ASSERT_EQ(to_ns(s.events[i].t), static_cast<std::int64_t>(i) * 10'000);
    EXPECT_TRUE(s.repairs.empty());
  }
}

TEST(EventStream, SurvivesACutAtAnyPlace) {
  TempFolder folder;
  const std::string text = steady_events(500);
  for (int percent = 1; percent < 100; ++percent) {
    const std::string part = text.substr(0, text.size() * static_cast<std::size_t>(percent) / 100);
    const auto whole = static_cast<std::size_t>(std::count(part.begin(), part.end(), '\n'));
    const Stream s = read_stream(folder.write("events.txt", part));
    EXPECT_GE(s.events.size(), whole);
    EXPECT_LE(s.events.size(), whole + 1);  // a cut before a line end loses no event
    const bool mended = s.repairs.count("events: last line cut") > 0;
    EXPECT_EQ(s.events.size() == whole && part.back() != '\n', mended) << percent;
  }
}

TEST(EventStream, LeavesOutAndCountsDamagedLines) {
  TempFolder folder;
  const Stream s = read_stream(folder.write(
      "events.txt", "# comment\n0.1 1 1 1\nnan 2 2 1\n0.2 inf 2 0\nrubbish\n0.3 240 1 1\n0.3 1 180 1\n\n0.4 5 5 0\n"));
  ASSERT_EQ(s.events.size(), 2u);
  EXPECT_EQ(s.repairs.at("events: unreadable line"), 3u);
  EXPECT_EQ(s.repairs.at("events: pixel outside the sensor"), 2u);
}

TEST(EventStream, SortsLateEventsInAndDropsVeryLateOnes) {
  TempFolder folder;
  std::string text = steady_events(1000);  // up to 9.99 ms
  text += "0.009500 7 7 1\n0.009990 8 8 1\n0.002000 9 9 1\n0.010000 1 1 1\n0.009200 6 6 0\n";
  const Stream s = read_stream(folder.write("events.txt", text));
  EXPECT_EQ(s.events.size(), 1004u);
  EXPECT_EQ(s.repairs.at("events: out of order, sorted in"), 2u);
  EXPECT_EQ(s.repairs.at("events: out of order, dropped"), 1u);
}

TEST(EventStream, DropsOneWrongStampAheadInsteadOfTheRest) {
  TempFolder folder;
  const Stream s = read_stream(folder.write("events.txt", "0.1 1 1 1\n0.2 2 2 1\n500.0 3 3 1\n0.3 4 4 1\n0.4 5 5 1\n"));
  ASSERT_EQ(s.events.size(), 4u);
  EXPECT_EQ(s.events[2].x, 4);
  EXPECT_EQ(s.repairs.at("events: stamp far ahead, dropped"), 1u);
}

TEST(EventStream, KeepsBitsOfDuplicatedLines) {
  TempFolder folder;
  const Stream s = read_stream(folder.write("events.txt", "0.1 1 1 1\n0.1 1 1 1\n0.1 1 1 1\n"));
  EXPECT_EQ(s.events.size(), 3u);
  EXPECT_TRUE(s.repairs.empty());
}

TEST(EventStream, RefusesAFileThatIsMostlyDamaged) {
  TempFolder folder;
  std::string text = "0.1 1 1 1\n";
  for (int i = 0; i < 2000; ++i) text += "1 2 3\n";
  const auto file = folder.write("events.txt", text);
  const std::string message = input_error([&] { read_stream(file); });
  EXPECT_THAT(message, HasSubstr("events.txt:2: 3 columns where an event of this file has 4: t x y p"));
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(EventStream, RefusesBinaryFiles) {
  TempFolder folder;
  const auto file = folder.write("events.txt", std::string(1 << 20, '\0'));
  EXPECT_THAT(input_error([&] { read_stream(file); }), HasSubstr("not a text file"));
  EXPECT_THAT(input_error([&] { read_stream(folder.path()); }), HasSubstr("cannot be read"));
}

TEST(EventStream, HoldsLittleInMemoryWhenStampsStandStill) {
  TempFolder folder;
  std::string text;
  for (int i = 0; i < 400'000; ++i) text += "0.5 1 1 1\n";
  const Stream s = read_stream(folder.write("events.txt", text));
  EXPECT_EQ(s.events.size(), 400'000u);
}

}  // namespace
}  // namespace edged
