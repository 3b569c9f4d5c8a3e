// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// AEDAT4: every compression, damage, the real recordings.
#include "edged/io/aedat/aedat4.hpp"

#include <gmock/gmock.h>

#include <numbers>
#include <random>

#include "edged/io/aedat/aedat4_test_support.hpp"
#include "edged/io/prophesee/evt_test_support.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

constexpr int kDavisWidth = 346, kDavisHeight = 260;

/// 100 packets of 100 events each, a frame in every tenth, an IMU sample in each.
std::string small_aedat4(int compression, std::vector<Event>& events) {
  events = generated_events(10'000, kDavisWidth, kDavisHeight, 50);
  Aedat4Writer writer(compression, kDavisWidth, kDavisHeight);
  for (auto at = events.begin(); at < events.end(); at += 100) {
    if ((at - events.begin()) % 1000 == 0)
      writer.frame(at->t, 4, 2, CV_8UC1,
                   {1, 2, 3, 4, 5, 6, 7, static_cast<std::uint8_t>((at - events.begin()) / 1000)});
    writer.imu(at->t, {0, 0, 1}, {180, 0, -90});
    writer.events({at, at + 100});
  }
  return writer.text();
}

class Aedat4 : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(, Aedat4, ::testing::Range(0, 5));

TEST_P(Aedat4, GivesBackWhatWasWritten) {
  TempFolder folder;
  std::vector<Event> events;
  const Recording recording = open_recording(folder.write("a.aedat4", small_aedat4(GetParam(), events)));
  const DatasetInfo& info = recording.dataset->info();
  EXPECT_TRUE(info.has_events && info.has_frames && info.has_imu);
  EXPECT_EQ(info.begin, events.front().t);
  const Contents c = read_all(*recording.dataset);
  EXPECT_TRUE(c.events == events);
  ASSERT_EQ(c.frames.size(), 10u);
  EXPECT_EQ(c.frames[3].image.size(), cv::Size(4, 2));
  EXPECT_EQ(c.frames[3].image.at<std::uint8_t>(1, 3), 3);
  EXPECT_EQ(c.frames[3].t, events[3000].t);  // the middle of the exposure, not the frame's own stamp
  ASSERT_EQ(c.imu.size(), 100u);
  EXPECT_EQ(c.imu[7].t, events[700].t);
  EXPECT_TRUE(c.imu[7].accel_B.isApprox(Eigen::Vector3d(0, 0, 9.80665)));
  EXPECT_TRUE(c.imu[7].gyro_B.isApprox(std::numbers::pi * Eigen::Vector3d(1, 0, -0.5)));
  EXPECT_THAT(recording.dataset->repairs(), ::testing::ElementsAre(::testing::Pair("file: no table", 1u)));
}

TEST_P(Aedat4, CutAnywhereItGivesTheWholePacketsBefore) {
  TempFolder folder;
  std::vector<Event> events;
  const std::string whole = small_aedat4(GetParam(), events);
  std::size_t before = 0;
  for (int percent = 0; percent < 100; ++percent) {
    const auto file = folder.write("a.aedat4", whole.substr(0, whole.size() * static_cast<std::size_t>(percent) / 100));
    std::vector<Event> read;
    std::ignore = input_error([&] { read = read_all(*open_recording(file).dataset).events; });
    ASSERT_GE(read.size(), before) << percent;
    EXPECT_TRUE(std::equal(read.begin(), read.end(), events.begin())) << percent;
    before = read.size();
  }
  EXPECT_GE(before, 9500u);
}

TEST_P(Aedat4, FlippedBitsAreRefusedOrMended) {
  TempFolder folder;
  std::vector<Event> events;
  const std::string whole = small_aedat4(GetParam(), events);
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) {
    std::string damaged = whole;
    // The header, where all depends on every bit, in every third file.
    const std::size_t at = random() % (i % 3 == 0 ? 1000 : whole.size());
    damaged[at] = static_cast<char>(damaged[at] ^ 1 << random() % 8);
    const auto file = folder.write("a.aedat4", damaged);
    std::vector<Event> read;
    std::ignore = input_error([&] { read = read_all(*open_recording(file).dataset).events; });
    for (const Event& e : read) ASSERT_TRUE(e.x < 16384 && e.y < 16384);
  }
}

TEST(Aedat4File, ColourFramesBecomeGreyAndOthersAreCounted) {
  TempFolder folder;
  Aedat4Writer writer(1, kDavisWidth, kDavisHeight);
  const auto t = [](int ms) { return timestamp_from_ns(1'000'000LL * ms); };
  writer.frame(t(10), 2, 1, CV_8UC3, {90, 90, 90, 7, 7, 7});
  writer.frame(t(20), 2, 1, CV_8UC4, {50, 50, 50, 255, 7, 7, 7, 255});
  writer.frame(t(30), 2, 1, CV_8UC1, {1, 2, 3});
  writer.frame(t(40), 1, 1, CV_8UC1, {1});
  const Recording recording = open_recording(folder.write("a.aedat4", writer.text()));
  const Contents c = read_all(*recording.dataset);
  ASSERT_EQ(c.frames.size(), 2u);
  EXPECT_EQ(c.frames[0].image.at<std::uint8_t>(0, 0), 90);
  EXPECT_EQ(c.frames[1].image.at<std::uint8_t>(0, 0), 50);
  EXPECT_EQ(recording.dataset->repairs().at("file: packet unreadable"), 2u);
}

TEST(Aedat4File, RefusalsSayWhatIsWrong) {
  TempFolder folder;
  const auto refusal = [&](const std::string& content) {
    const auto file = folder.write("a.aedat4", content);
    return input_error([&] { open_recording(file); });
  };
  EXPECT_THAT(refusal("#!AER-DAT4.0\r\n"), HasSubstr("header is damaged"));
  EXPECT_THAT(refusal(Aedat4Writer(1, kDavisWidth, kDavisHeight).text()), HasSubstr("nothing to read"));
  EXPECT_THAT(refusal(Aedat4Writer(7, kDavisWidth, kDavisHeight).text()), HasSubstr("compression"));
  EXPECT_THAT(refusal(Aedat4Writer(1, 0, 0).text()), HasSubstr("--geometry"));
  std::vector<Event> events = generated_events(5000, kDavisWidth, kDavisHeight, 10);
  Aedat4Writer small(1, 100, 100);
  small.events(events);
  EXPECT_THAT(refusal(small.text()), HasSubstr("outside"));
}

TEST(Aedat4File, ReadsTheRealDavis346Recordings) {
  const auto folder = data_folder() / "formats";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no data";
  struct Counts {
    const char* name;
    std::size_t events, frames, imu;
  };
  for (const Counts& want :
       {Counts{"davis346_0.17s.aedat4", 6676, 4, 160}, {"davis346_0.13s.aedat4", 117'667, 3, 130}}) {
    const Recording recording = open_recording(folder / want.name);
    const Contents c = read_all(*recording.dataset);
    EXPECT_EQ(c.events.size(), want.events);
    EXPECT_EQ(c.frames.size(), want.frames);
    EXPECT_EQ(c.imu.size(), want.imu);
    EXPECT_EQ(c.frames.at(0).image.size(), cv::Size(346, 260));
    EXPECT_NEAR(c.imu.at(0).accel_B.norm(), 9.81, 1.0);
    EXPECT_LT(c.imu.at(0).gyro_B.norm(), 10.0);
    for (const auto& [kind, count] : recording.dataset->repairs()) ADD_FAILURE() << kind << " " << count;
  }
}

}  // namespace
}  // namespace edged
