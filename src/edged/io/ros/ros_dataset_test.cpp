// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Bags as recordings: the real ones.
#include "edged/io/ros/ros_dataset.hpp"

#include <gmock/gmock.h>

#include <array>

#include "edged/io/recording.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;

struct BagSample {
  const char* path;
  std::size_t events;
  int width, height;
  double seconds;
};

class RealBag : public ::testing::TestWithParam<BagSample> {};

TEST_P(RealBag, GivesAllItsEventsInOrder) {
  const BagSample& sample = GetParam();
  const fs::path path = data_folder() / "formats" / sample.path;
  if (!fs::exists(path)) GTEST_SKIP() << "no data";
  Recording r = open_recording(path);
  EXPECT_TRUE(r.dataset->info().has_events);
  EXPECT_FALSE(r.dataset->info().has_frames || r.dataset->info().has_imu);
  const Contents c = read_all(*r.dataset);
  EXPECT_EQ(c.events.size(), sample.events);
  EXPECT_TRUE(std::ranges::is_sorted(c.events, {}, &Event::t));
  for (const Event& e : c.events) ASSERT_TRUE(e.x < sample.width && e.y < sample.height);
  EXPECT_EQ(c.events.front().t, r.dataset->info().begin);
  EXPECT_NEAR(to_seconds(c.events.back().t - c.events.front().t), sample.seconds, 0.01);
  for (const auto& [kind, count] : r.dataset->repairs()) ADD_FAILURE() << kind << ": " << count;
}

// The count of the second but last is what the decoder gave, its sums are checked below.
INSTANTIATE_TEST_SUITE_P(Samples, RealBag,
                         ::testing::Values(BagSample{"event_camera_msgs_evt3.bag", 343'474, 640, 480, 2.08},
                                           BagSample{"rosbag2_sqlite_evt3", 343'474, 640, 480, 2.08},
                                           BagSample{"rosbag2_sqlite_evt3_1280x720", 82'469, 1280, 720, 1.2513},
                                           BagSample{"rosbag2_sqlite_mono", 100, 640, 480, 0.0001}));

/// Sums of columns, rows and polarities that event_camera_codecs, the encoding's own library, states of its samples.
TEST(RosDataset, EventPacketsDecodeToTheSumsThatTheirOwnLibraryStates) {
  const auto sums = [](const char* name) {
    std::array<std::uint64_t, 3> sum{};
    for (const Event& e : read_all(*open_recording(data_folder() / "formats" / name).dataset).events)
      sum[0] += e.x, sum[1] += e.y, sum[2] += e.positive;
    return sum;
  };
  if (!fs::exists(data_folder() / "formats")) GTEST_SKIP() << "no data";
  EXPECT_EQ(sums("rosbag2_sqlite_mono"), (std::array<std::uint64_t, 3>{34'450, 26'450, 50}));
  EXPECT_EQ(sums("rosbag2_sqlite_evt3_1280x720"), (std::array<std::uint64_t, 3>{42'078'718, 31'656'267, 41'439}));
}

TEST(RosDataset, AnMcapWhoseEventsAreOfAnUnknownEncodingIsRefusedByItsName) {
  const fs::path path = data_folder() / "formats" / "rosbag2_mcap_evt3";
  if (!fs::exists(path)) GTEST_SKIP() << "no data";
  EXPECT_THAT(input_error([&] { open_recording(path); }), ::testing::HasSubstr("libcaer_cmp"));
  Repairs repairs;
  const auto source = open_messages(path, &repairs);
  ASSERT_EQ(source->topics().size(), 1u);
  EXPECT_EQ(source->topics().front().count, 100u);
  std::size_t messages = 0;
  while (source->next()) ++messages;
  EXPECT_EQ(messages, 100u);
  EXPECT_TRUE(repairs.counts().empty());
}

TEST(RosDataset, ABagCutAnywhereGivesWhatCameBeforeOrIsRefused) {
  const fs::path path = data_folder() / "formats" / "event_camera_msgs_evt3.bag";
  if (!fs::exists(path)) GTEST_SKIP() << "no data";
  const std::string whole = read_text(path);
  TempFolder folder;
  std::size_t before = 0;
  for (std::size_t percent = 0; percent < 100; percent += 11) {
    const fs::path cut = folder.write("cut.bag", whole.substr(0, whole.size() * percent / 100));
    std::size_t events = 0;
    const std::string refusal = input_error([&] { events = read_all(*open_recording(cut).dataset).events.size(); });
    EXPECT_GE(events, before) << percent << " %: " << refusal;
    before = events;
  }
  EXPECT_GT(before, 290'000u);
}

}  // namespace
}  // namespace edged
