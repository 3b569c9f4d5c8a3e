// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Each writable format reads back what was written.
#include "edged/io/write_recording.hpp"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/calibration.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

class WritableFormats : public ::testing::TestWithParam<WritableFormat> {
 protected:
  std::filesystem::path target() const { return folder_.path() / ("out" + std::string(GetParam().extension)); }
  WriteCounts write(Dataset& dataset, const WriteOptions& options = {}) const {
    return write_recording(dataset, GetParam(), target(), load_rig("davis240c_ecd"), options);
  }
  Contents read_back() const { return read_all(*open_recording(target()).dataset); }

  TempFolder folder_;
};

TEST_P(WritableFormats, GiveBackEveryEventAndWhatElseTheyHold) {
  ListedDataset source = random_dataset(GetParam().tick);
  const WriteCounts counts = write(source);
  ListedDataset again = random_dataset(GetParam().tick);
  const Contents a = read_all(again), b = read_back();
  EXPECT_TRUE(a.events == b.events);
  EXPECT_EQ(counts.events, a.events.size());
  EXPECT_EQ(counts.frames, b.frames.size());
  EXPECT_EQ(counts.imu, b.imu.size());
  EXPECT_EQ(counts.frames + counts.frames_left_out, a.frames.size());
  EXPECT_EQ(counts.imu + counts.imu_left_out, a.imu.size());
  for (std::size_t i = 0; i < b.frames.size(); ++i)
    EXPECT_EQ(cv::norm(a.frames[i].image, b.frames[i].image, cv::NORM_INF), 0.0);
}

TEST_P(WritableFormats, LeaveOutWhatIsNotWantedAndGiveTheRestAsEver) {
  ListedDataset source = random_dataset(GetParam().tick);
  write(source);
  const Contents all = read_back();
  const auto stamps = [](const std::vector<ImuSample>& samples) {
    std::vector<Timestamp> out;
    for (const ImuSample& sample : samples) out.push_back(sample.t);
    return out;
  };
  for (const Modality unwanted : {Modality::Events, Modality::Frames}) {
    const Recording recording = open_recording(target());
    const DatasetInfo info = recording.dataset->info();
    recording.dataset->leave_out(unwanted);
    EXPECT_EQ(recording.dataset->info().begin, info.begin);
    EXPECT_EQ(recording.dataset->info().has_events, info.has_events);
    const Contents rest = read_all(*recording.dataset);
    EXPECT_EQ(rest.events.size(), unwanted == Modality::Events ? 0U : all.events.size());
    EXPECT_EQ(rest.frames.size(), unwanted == Modality::Frames ? 0U : all.frames.size());
    EXPECT_EQ(stamps(rest.imu), stamps(all.imu));
    EXPECT_TRUE(std::ranges::is_sorted(rest.all, {}, [](const Measurement& m) { return *first_stamp(m); }));
  }
}

TEST_P(WritableFormats, SkipEventsByBlocksOnRequest) {
  if (GetParam().name == "ecd" || GetParam().name == "csv") GTEST_SKIP() << "text has no blocks";
  ListedDataset source;
  constexpr int kBatches = 6000, kEvents = 100;
  for (int i = 0; i < kBatches; ++i) {
    const Timestamp t = timestamp_from_ns(1'000'000'000 + 1'000'000LL * i);
    if (i % 10 == 0) source.measurements.push_back(ImuSample{t, {0, 0, 0}, {0, 0, 9.81}});
    EventBatch batch{"events", {}};
    for (int j = 0; j < kEvents; ++j)
      batch.events.push_back({t + std::chrono::microseconds(9 * j), static_cast<std::uint16_t>(j), 5, true});
    source.measurements.push_back(std::move(batch));
  }
  const WriteCounts written = write(source);
  for (const double share : {0.25, 0.75}) {
    const Recording recording = open_recording(target());
    recording.dataset->skip_events(share);
    const Contents read = read_all(*recording.dataset);
    EXPECT_NEAR(static_cast<double>(read.events.size()) / (kBatches * kEvents), 1.0 - share, 0.15);
    EXPECT_EQ(read.events.size() + recording.dataset->skip_events(0.0), kBatches * kEvents);
    EXPECT_EQ(read.imu.size(), written.imu);
    Timestamp before = read.events.front().t;
    for (const Event& event : read.events) {
      EXPECT_LT(event.t - before, std::chrono::milliseconds(2100));  // three blocks of HDF5, the longest
      before = event.t;
    }
  }
}

/// Formats that hold events only are not sufficient for a run.
TEST_P(WritableFormats, KeepWhosePosesTrajectoriesHold) {
  for (const char* frame : {"events", "frames", "body"}) {
    if (GetParam().name == "ecd" && frame != std::string("events")) continue;  // holds poses of the event camera
    TempFolder folder;
    ListedDataset source = random_dataset(GetParam().tick);
    source.describe().pose_frame = source.truth->frame = frame;
    const auto file = folder.path() / ("out" + std::string(GetParam().extension));
    write_recording(source, GetParam(), file, load_rig("davis240c_ecd"));
    EXPECT_EQ(open_recording(file).dataset->info().pose_frame, GetParam().imu ? frame : "body");
  }
}

TEST_P(WritableFormats, GiveTrajectoriesOfTheBodyWhereThereIsNoGroundTruth) {
  ListedDataset source = random_dataset(GetParam().tick);
  source.truth.reset();
  write(source);
  EXPECT_EQ(open_recording(target()).dataset->info().pose_frame, "body");
}

TEST_P(WritableFormats, KeepEventsApartByLongSilences) {
  ListedDataset source;
  for (const std::int64_t s : {1, 2, 20, 60, 300})
    source.measurements.push_back(EventBatch{"events", {Event{timestamp_from_ns(s * 1'000'000'000), 3, 5, true}}});
  write(source);
  std::vector<Timestamp> stamps;
  for (const Event& event : read_back().events) stamps.push_back(event.t);
  EXPECT_THAT(stamps,
              ::testing::ElementsAre(timestamp_from_seconds(1), timestamp_from_seconds(2), timestamp_from_seconds(20),
                                     timestamp_from_seconds(60), timestamp_from_seconds(300)));
}

TEST_P(WritableFormats, RefuseStampsTheyAreTooCoarseForUnlessToldToCutThem) {
  if (GetParam().tick == Duration(1)) GTEST_SKIP() << "holds every nanosecond";
  ListedDataset fine;
  fine.measurements.push_back(EventBatch{"events", {Event{timestamp_from_ns(1'234'567'891), 3, 5, true}}});
  ListedDataset again = fine;
  EXPECT_THAT(input_error([&] { write(fine); }), HasSubstr("1.234567891 s"));
  EXPECT_FALSE(std::filesystem::exists(target()));
  write(again, {.round = true});
  EXPECT_EQ(read_back().events.front().t, timestamp_from_ns(1'234'567'000));
}

TEST_P(WritableFormats, RefuseWhatTheyHaveNoRoomFor) {
  if (GetParam().frames || GetParam().imu) GTEST_SKIP() << "holds more than events";
  ListedDataset source;
  source.describe().has_events = false;
  EXPECT_THAT(input_error([&] { write(source); }), HasSubstr("holds no events"));
}

TEST_P(WritableFormats, LeaveNoHalfRecordingBehind) {
  ListedDataset source = random_dataset(GetParam().tick);
  source.failing = true;
  EXPECT_THAT(input_error([&] { write(source); }), HasSubstr("damaged"));
  EXPECT_FALSE(std::filesystem::exists(target()));
}

TEST_P(WritableFormats, LeaveAloneWhatIsThere) {
  ListedDataset source = random_dataset(GetParam().tick), again = source;
  write(source);
  EXPECT_THAT(input_error([&] { write(again); }), HasSubstr("already"));
}

TEST_P(WritableFormats, SayWhereNothingCanBeWritten) {
  ListedDataset source = random_dataset(GetParam().tick);
  const std::string path = "/proc/none/out" + std::string(GetParam().extension);
  EXPECT_THAT(input_error([&] { write_recording(source, GetParam(), path, load_rig("davis240c_ecd")); }),
              HasSubstr(path));
}

TEST(WrongStamps, OfEventsAheadOfTheOthersAreDroppedAlikeInEveryFormat) {
  constexpr std::size_t kWrong[] = {300, 301, 302, 900};  // a run of three, and one
  for (const char* name : {"ecd", "csv", "bag", "mcap", "aedat4"}) {
    TempFolder folder;
    const WritableFormat& format = writable_format(name, folder.path());
    ListedDataset source = random_dataset(std::chrono::microseconds(1));
    std::size_t count = 0;
    for (Measurement& m : source.measurements)
      if (auto* batch = std::get_if<EventBatch>(&m))
        for (Event& event : batch->events)
          if (std::ranges::find(kWrong, count++) != std::end(kWrong)) event.t += std::chrono::seconds(1);
    const auto target = folder.path() / ("out" + std::string(format.extension));
    write_recording(source, format, target, load_rig("davis240c_ecd"));
    const Recording recording = open_recording(target, nullptr, {.geometry = cv::Size(240, 180)});
    const Contents c = read_all(*recording.dataset);
    EXPECT_EQ(c.events.size(), count - std::size(kWrong)) << name;
    EXPECT_TRUE(std::ranges::is_sorted(c.events, {}, &Event::t)) << name;
    const std::map<std::string, std::size_t> expected{{"events: stamp far ahead, dropped", std::size(kWrong)}};
    EXPECT_EQ(recording.dataset->repairs(), expected) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, WritableFormats,
                         ::testing::ValuesIn(writable_formats().begin(), writable_formats().end()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(WritableFormat, IsFoundByNameOrExtensionElseTheRefusalListsThem) {
  EXPECT_EQ(writable_format("", "a/b.raw").name, "raw");
  EXPECT_EQ(writable_format("", "a/folder").name, "ecd");
  EXPECT_EQ(writable_format("dat", "a/b.bin").name, "dat");
  EXPECT_THAT(input_error([] { writable_format("", "a.xyz"); }),
              HasSubstr("`.xyz`; give --format, one of: ecd (a folder), raw"));
}

}  // namespace
}  // namespace edged
