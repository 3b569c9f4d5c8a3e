// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Real bags as recordings.
#include "edged/io/ros/ros.hpp"

#include <gmock/gmock.h>

#include <array>
#include <random>

#include "edged/io/damage_test_support.hpp"
#include "edged/io/ros/bag/bag_test_support.hpp"
#include "edged/io/ros/bag/open_messages.hpp"
#include "edged/io/ros/messages/event_packets.hpp"

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

// The count of 1280 x 720 is a result of this decoder. Its sums are checked below.
INSTANTIATE_TEST_SUITE_P(Samples, RealBag,
                         ::testing::Values(BagSample{"event_camera_msgs_evt3.bag", 343'474, 640, 480, 2.08},
                                           BagSample{"rosbag2_sqlite_evt3", 343'474, 640, 480, 2.08},
                                           BagSample{"rosbag2_sqlite_evt3_1280x720", 82'469, 1280, 720, 1.2513},
                                           BagSample{"rosbag2_sqlite_mono", 100, 640, 480, 0.0001},
                                           BagSample{"rosbag2_mcap_evt3", 571'266, 346, 260, 1.0}));

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

/// Counts and first stamp that event_camera_py, the encoding's own binding, states of this recording; its name says
/// evt3, its packets libcaer_cmp.
TEST(RosDataset, ACompressedDavisRecordingHasThePolaritiesAndTheBeginThatItsOwnLibraryStates) {
  const fs::path path = data_folder() / "formats" / "rosbag2_mcap_evt3";
  if (!fs::exists(path)) GTEST_SKIP() << "no data";
  const auto events = read_all(*open_recording(path).dataset).events;
  EXPECT_EQ(std::ranges::count(events, true, &Event::positive), 211'043);
  EXPECT_EQ(std::ranges::count(events, false, &Event::positive), 360'223);
  const Timestamp begin = timestamp_from_ns(1'744'227'144'732'712'000);
  EXPECT_EQ(events.front().t, begin);
  EXPECT_EQ(std::ranges::max(events, {}, &Event::x).x, 345);
  EXPECT_EQ(std::ranges::max(events, {}, &Event::y).y, 259);
  std::int64_t sum_us = 0;
  for (const Event& e : events) sum_us += (e.t - begin) / std::chrono::microseconds(1);
  EXPECT_EQ(sum_us, 335'555'680'277);
}

/// Each packet begins at its time base and ends before that of the next packet, 10 ms later.
TEST(RosDataset, PacketsOfACompressedDavisRecordingKeepToTheirTimeBases) {
  const fs::path path = data_folder() / "formats" / "rosbag2_mcap_evt3";
  if (!fs::exists(path)) GTEST_SKIP() << "no data";
  Repairs repairs;
  const auto source = open_messages(path, &repairs);
  ASSERT_EQ(source->topics().size(), 1u);
  EXPECT_EQ(source->topics().front().count, 100u);
  EventMessageDecoder decoder;
  std::size_t messages = 0;
  Timestamp last = Timestamp::min();
  while (const auto message = source->next()) {
    ++messages;
    const EventPacket packet = read_event_packet(WireReader(source->wire(), message->data));
    const std::vector<Event> events = decoder.decode(packet);
    EXPECT_EQ(to_ns(events.front().t), static_cast<std::int64_t>(packet.time_base));
    EXPECT_GT(events.front().t, last);
    EXPECT_TRUE(std::ranges::is_sorted(events, {}, &Event::t));
    last = events.back().t;
    EXPECT_LT(last, events.front().t + std::chrono::milliseconds(10));
  }
  EXPECT_EQ(messages, 100u);
  EXPECT_TRUE(repairs.counts().empty());
}

/// A sensor whose clock runs fast by 50 ppm, with packets of 1 ms that are stamped up to 3 ms late.
TEST(SensorClock, FollowsADriftWithoutTheJitterOfTheStamps) {
  SensorClock clock;
  Duration largest_error{0}, largest_step{0};
  Timestamp last_end;
  Duration last_offset{0};
  std::mt19937 random(1);
  for (int i = 0; i < 600'000; ++i) {
    const Timestamp begin = timestamp_from_ns(std::int64_t{i} * 1'000'050),
                    end = begin + std::chrono::microseconds(999);
    const Timestamp stamp =
        timestamp_from_ns(std::int64_t{i} * 1'000'000 + static_cast<std::int64_t>(random() % 3'000'000));
    const Duration offset = clock.offset(begin, end, stamp);
    if (i > 60'000) {  // the start, of unknown delay, is forgotten
      largest_error =
          std::max(largest_error, std::chrono::abs(begin + offset - timestamp_from_ns(std::int64_t{i} * 1'000'000) -
                                                   std::chrono::microseconds(1500)));
      largest_step = std::max(largest_step, std::chrono::abs(offset - last_offset));
    }
    ASSERT_TRUE(i == 0 || begin + offset >= last_end) << i;
    last_end = end + offset;
    last_offset = offset;
  }
  EXPECT_LT(largest_error, std::chrono::microseconds(400));  // 30 ms without
  EXPECT_LE(largest_step, std::chrono::nanoseconds(501));
}

TEST(SensorClock, ExactStampsChangeNothing) {
  SensorClock clock;
  for (int i = 0; i < 1000; ++i) {
    const Timestamp begin = timestamp_from_ns(std::int64_t{i} * 1'000'000);
    EXPECT_EQ(clock.offset(begin, begin, begin + std::chrono::seconds(7)), std::chrono::seconds(7));
  }
}

/// Packets of 1 ms, stamped up to 3 ms late, after 0.5 s by a clock that has been set; returns those that are more than
/// 5 ms away from the stamps' time.
int packets_off(SensorClock& clock, Duration step) {
  std::mt19937 random(1);
  int off = 0;
  for (int i = 0; i < 1000; ++i) {
    const Timestamp begin = timestamp_from_ns(std::int64_t{i} * 1'000'000);
    const Timestamp now = begin + (i < 500 ? Duration(0) : step);
    const Duration offset = clock.offset(begin, begin, now + Duration(random() % 3'000'000));
    off += std::chrono::abs(begin + offset - now) > std::chrono::milliseconds(5) ? 1 : 0;
  }
  return off;
}

TEST(SensorClock, IsAlignedAnewWithin25MsWhereOneOfTheTwoIsSet) {
  for (const double step_s : {-100.0, -20.0, -0.5, -0.05, 0.05, 0.5, 20.0, 100.0}) {
    SensorClock clock;
    EXPECT_LE(packets_off(clock, duration_from_seconds(step_s)), 25) << step_s;
    ASSERT_EQ(clock.steps().size(), 1U) << step_s;
    EXPECT_NEAR(to_seconds(clock.steps()[0].stamps_by), step_s, 0.005);
    EXPECT_TRUE(clock.steps()[0].of_stamps);
  }
}

/// The computer is busy for 0.3 s, then takes what has waited.
TEST(SensorClock, IsNotSetByAStall) {
  SensorClock clock;
  for (int i = 0; i < 2000; ++i) {
    const Timestamp begin = timestamp_from_ns(std::int64_t{i} * 1'000'000), stall_ends = timestamp_from_seconds(1.3);
    const bool waits = i >= 1000 && begin < stall_ends;
    const Timestamp arrival = waits ? stall_ends + std::chrono::microseconds(10 * (i - 1000)) : begin;
    EXPECT_LT(std::chrono::abs(clock.offset(begin, begin, arrival)), std::chrono::milliseconds(1)) << i;
  }
  EXPECT_TRUE(clock.steps().empty());
}

/// The small recording with a barometer, a sonar and wheels: 40 messages each, the last of the sonar out of its range.
fs::path bag_with_sensors(const TempFolder& folder, const BagContainer& container) {
  const Wire wire = container.make(folder.path() / "none")->wire();
  SmallBag bag(wire);
  TestTopic pressure{"/baro", "sensor_msgs/FluidPressure", {}, {}}, range{"/sonar", "sensor_msgs/Range", {}, {}},
      twist{"/wheels", "geometry_msgs/TwistWithCovarianceStamped", {}, {}},
      command{"/cmd", "geometry_msgs/TwistStamped", {}, {}};
  for (int i = 0; i < 40; ++i) {
    const Timestamp t = bag.topics[2].messages[static_cast<std::size_t>(i)].first;
    pressure.messages.emplace_back(t, pressure_message(wire, t, 101325.0 - 12.0132 * i, 144.0));
    range.messages.emplace_back(t, range_message(wire, t, i == 39 ? 99.0F : 1.5F));
    twist.messages.emplace_back(t, twist_message(wire, t, {1.0, 0.1 * i, 0.0}, Eigen::Vector3d(0.04, 0.0, 1e6)));
    command.messages.emplace_back(t, twist_message(wire, t, {9.0, 9.0, 9.0}));
  }
  for (TestTopic* topic : {&pressure, &range, &twist, &command}) bag.topics.push_back(std::move(*topic));
  return write_bag(folder, container, bag.topics);
}

std::vector<ExternalSample> external_of(Dataset& dataset) {
  std::vector<ExternalSample> samples;
  while (const auto measurement = dataset.next())
    if (const auto* sample = std::get_if<ExternalSample>(&*measurement)) samples.push_back(*sample);
  return samples;
}

TEST(RosDataset, HeightsAndVelocitiesAreReadFromTheTopicsThatAreNamed) {
  const double none = std::numeric_limits<double>::infinity();
  for (const BagContainer& container : {kBagContainers[0], kBagContainers[2], kBagContainers[5]}) {
    const TempFolder folder;
    const fs::path bag = bag_with_sensors(folder, container);
    EXPECT_TRUE(external_of(*open_recording(bag).dataset).empty()) << "two heights, and twists that may be commands";
    RecordingOptions options;
    options.topics = {{"height", "/baro"}, {"velocity", "/wheels"}};
    const Recording named = open_recording(bag, nullptr, options);
    const std::vector<ExternalSample> samples = external_of(*named.dataset);
    ASSERT_EQ(samples.size(), 80U) << container.name;
    const auto& height = std::get<HeightSample>(samples[78].index() == 0 ? samples[78] : samples[79]);
    EXPECT_NEAR(height.height_m, 39.0, 0.2);
    EXPECT_NEAR(height.sigma_m, 1.0, 0.01);
    const auto& velocity = std::get<VelocitySample>(samples[78].index() == 1 ? samples[78] : samples[79]);
    EXPECT_TRUE(velocity.v_S.isApprox(Eigen::Vector3d(1.0, 3.9, 0.0), 1e-12));
    EXPECT_EQ(velocity.sigma, Eigen::Vector3d(0.2, 0.0, none));
    options.topics = {{"height", "/sonar"}};
    const Recording sonar = open_recording(bag, nullptr, options);
    EXPECT_EQ(external_of(*sonar.dataset).size(), 39U);
    EXPECT_FALSE(sonar.dataset->repairs().empty());
  }
}

TEST(RosDataset, ABagCutAnywhereGivesWhatCameBeforeOrIsRefused) {
  const fs::path path = data_folder() / "formats" / "event_camera_msgs_evt3.bag";
  if (!fs::exists(path)) GTEST_SKIP() << "no data";
  const std::string whole = read_text(path);
  TempFolder folder;
  std::size_t before = 0;
  for (std::size_t percent = 0; percent < 100; percent += 11) {
    const DamagedRead read = read_damaged(folder, cut_at(whole, percent));
    EXPECT_GE(read.events.size(), before) << percent << " %: " << read.refusal;
    before = read.events.size();
  }
  EXPECT_GT(before, 290'000u);
}

}  // namespace
}  // namespace edged
