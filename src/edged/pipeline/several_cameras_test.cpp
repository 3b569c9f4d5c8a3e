// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Two event cameras and two frame cameras of one body at rest, from the packets to the steps.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/odometry.hpp"
#include "edged/pipeline/input/packetizer.hpp"
#include "edged/pipeline/mode.hpp"

namespace edged {
namespace {

constexpr int kColumns = 120, kRows = 90;
Timestamp instant(double ms) { return timestamp_from_seconds(1e-3 * ms); }
ImuSample sample_at(double ms) { return {instant(ms), {0, 0, 0}, {0, 0, 9.81}}; }

/// "dvs0", "dvs1", "cam0", "cam1"; the second of each is 10 cm to the right.
Rig four_cameras(double frame_offset_ms = 0.0) {
  const CameraModel lens(kColumns, kRows, 100, 100, 60, 45);
  const SE3 beside(Eigen::Quaterniond::Identity(), {0.1, 0, 0});
  return {"four",
          {{"dvs0", Modality::Events, lens, SE3(), Duration(0)},
           {"dvs1", Modality::Events, lens, beside, Duration(0)},
           {"cam0", Modality::Frames, lens, SE3(), Duration(0)},
           {"cam1", Modality::Frames, lens, beside, duration_from_seconds(1e-3 * frame_offset_ms)}}};
}

cv::Mat random_blocks(unsigned seed) {
  cv::Mat small(kRows / 10, kColumns / 10, CV_8UC1), image(kRows, kColumns, CV_8UC1);
  std::mt19937 random(seed);
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      unsigned char& grey = small.at<unsigned char>(y / 10, x / 10);
      if (y % 10 == 0 && x % 10 == 0) grey = static_cast<unsigned char>(30 + random() % 200);
      image.at<unsigned char>(y, x) = grey;
    }
  }
  return image;
}

/// In the order of a Dataset. Frames of the second frame camera arrive so much later.
std::vector<Measurement> recording(int length_ms, double second_frame_ms = 0.0) {
  std::vector<Measurement> all;
  std::mt19937 random(2);
  const cv::Mat left = random_blocks(1), right = random_blocks(2);
  for (int ms = 0; ms < length_ms; ++ms) {
    if (ms % 5 == 0) all.emplace_back(sample_at(ms));
    for (const char* camera : {"dvs0", "dvs1"}) {
      EventBatch batch{camera, {}};
      for (int i = 0; i < 20; ++i)
        batch.events.push_back({instant(ms) + std::chrono::microseconds(1 + 40 * i),
                                static_cast<std::uint16_t>(random() % kColumns),
                                static_cast<std::uint16_t>(random() % kRows), true});
      all.emplace_back(std::move(batch));
    }
    if (ms % 50 == 10) all.emplace_back(Frame{instant(ms), "cam0", left});
    if (ms % 50 == 10) all.emplace_back(Frame{instant(ms + second_frame_ms), "cam1", right});
  }
  std::ranges::stable_sort(all, {}, [](const Measurement& m) { return *first_stamp(m); });
  return all;
}

std::vector<Packet> packets_of(const std::vector<Measurement>& all, const Rig& rig, PacketizerCounters& counters) {
  Packetizer packetizer(rig, {});
  std::vector<Packet> packets;
  const auto take = [&] {
    while (auto packet = packetizer.next()) packets.push_back(std::move(*packet));
  };
  for (const Measurement& m : all) packetizer.add(m), take();
  packetizer.finish();
  take();
  counters = packetizer.counters();
  return packets;
}

TEST(PacketsOfSeveralCameras, HoldTheEventsOfEachAndTheFramesOfOneInstant) {
  PacketizerCounters counters;
  const auto packets = packets_of(recording(500, 0.3), four_cameras(), counters);
  std::size_t with_frames = 0, events = 0;
  for (const Packet& packet : packets) {
    ASSERT_EQ(packet.events.size(), 2U);
    EXPECT_EQ(packet.events[0].camera, "dvs0");
    EXPECT_EQ(packet.events[1].camera, "dvs1");
    for (const PacketEvents& of_camera : packet.events) {
      events += of_camera.new_events;
      ASSERT_FALSE(of_camera.events.empty());
      EXPECT_LE(of_camera.events.back().t, packet.t);
    }
    if (packet.frames.empty()) continue;
    ++with_frames;
    ASSERT_EQ(packet.frames.size(), 2U);
    EXPECT_EQ(packet.frames[0].camera, "cam0");
    EXPECT_EQ(packet.frames[0].t, packet.t);
    EXPECT_EQ(packet.frames[1].t, packet.t + std::chrono::microseconds(300));
  }
  EXPECT_EQ(with_frames, 10U);
  EXPECT_EQ(events + counters.events_lost, 2U * 20U * 500U);
  EXPECT_EQ(counters.events_late + counters.frames_late, 0U);
}

TEST(PacketsOfSeveralCameras, AreCutByEachFrameOfAPairThatIsNotSynchronised) {
  for (const double apart_ms : {2.0, 20.0}) {
    PacketizerCounters counters;
    std::vector<std::string> order;
    Timestamp before = instant(-1);
    for (const Packet& packet : packets_of(recording(500, apart_ms), four_cameras(), counters)) {
      EXPECT_GT(packet.t, before);
      before = packet.t;
      ASSERT_LE(packet.frames.size(), 1U);
      if (!packet.frames.empty()) order.push_back(packet.frames[0].camera);
    }
    ASSERT_EQ(order.size(), 20U) << apart_ms;
    for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i % 2 == 0 ? "cam0" : "cam1");
    EXPECT_EQ(counters.frames_late, 0U);
  }
}

TEST(PacketsOfSeveralCameras, GoByTheClockOfTheImu) {
  for (const double offset_ms : {20.0, -20.0}) {  // stamped so much too early: at one time with the first camera's
    PacketizerCounters counters;
    std::vector<Measurement> all = recording(500, -offset_ms);
    int pairs = 0;
    for (const Packet& packet : packets_of(all, four_cameras(offset_ms), counters)) pairs += packet.frames.size() == 2;
    EXPECT_GE(pairs, 9) << offset_ms;
    EXPECT_EQ(counters.frames_late, 0U);
    EXPECT_LE(counters.events_late, 400U) << "those before the first frame";
  }
}

TEST(PacketsOfSeveralCameras, AreCutByTheCountOfAnyEventCamera) {
  std::vector<Measurement> all;
  for (int ms = 0; ms < 200; ++ms) {
    all.emplace_back(sample_at(ms));
    EventBatch many{"dvs1", {}};
    for (int i = 0; i < 120; ++i)
      many.events.push_back({instant(ms) + std::chrono::microseconds(1 + 8 * i), 1, 1, true});
    all.emplace_back(std::move(many));
    if (ms == 10) all.emplace_back(EventBatch{"dvs0", {{instant(10.5), 1, 1, true}}});
  }
  PacketizerCounters counters;
  const auto packets = packets_of(all, used_cameras(four_cameras(), Mode::Events, "dvs0,dvs1"), counters);
  ASSERT_GT(packets.size(), 3U);
  for (std::size_t i = 0; i + 1 < packets.size(); ++i)
    EXPECT_EQ(packets[i].events[1].new_events, 3780U) << "0.35 a pixel, of the camera that has them first";
  EXPECT_EQ(packets[0].events[0].new_events, 1U);
}

/// The poses and features of every step.
using StepNumbers = std::vector<double>;
StepNumbers numbers_of_all(Odometry& odometry, const std::vector<Measurement>& all,
                           std::vector<Step>* steps = nullptr) {
  StepNumbers numbers;
  drive(
      odometry, [&, next = all.begin()]() mutable { return next == all.end() ? std::nullopt : std::optional(*next++); },
      [&](Step step) {
        const Eigen::Vector3d& p = step.state.T_W_B.translation();
        numbers.insert(numbers.end(), {to_seconds(step.t), p.x(), p.y(), p.z()});
        for (const CameraStep& camera : step.cameras)
          for (const Track& track : camera.tracks) numbers.insert(numbers.end(), {track.pixel.x(), track.pixel.y()});
        if (steps) steps->push_back(std::move(step));
        return true;
      });
  return numbers;
}

OdometryConfig using_cameras(const std::string& names) {
  OdometryConfig config;
  config.cameras = names;
  return config;
}

TEST(OdometryOfSeveralCameras, TellsOfEachInTheOrderOfTheRig) {
  Odometry odometry(four_cameras(), {}, Mode::Fused, using_cameras("cam1,cam0,dvs1,dvs0"), {kInOrder});
  std::vector<Step> steps;
  numbers_of_all(odometry, recording(1500), &steps);
  ASSERT_GT(steps.size(), 20U);
  EXPECT_EQ(steps.back().status, TrackingStatus::Good);
  std::vector<std::string> names;
  for (const CameraStep& camera : steps.back().cameras) {
    names.push_back(camera.name);
    EXPECT_GT(camera.modality == Modality::Frames ? camera.tracks.size() : camera.events.size(), 5U) << camera.name;
  }
  EXPECT_EQ(names, (std::vector<std::string>{"dvs0", "dvs1", "cam0", "cam1"}));
  EXPECT_EQ(steps.back().find(Modality::Frames)->name, "cam0");
  EXPECT_EQ(steps.back().find("cam1"), &steps.back().cameras[3]);
  EXPECT_EQ(steps.back().find("cam2"), nullptr);
  EXPECT_EQ(odometry.counters().intake.unused_camera, 0U);
  EXPECT_EQ(odometry.rig().cameras.size(), 4U);
}

TEST(OdometryOfSeveralCameras, SharesTheCornersOfOne) {
  const std::vector<Measurement> all = recording(1500);
  const auto features = [&](const std::string& names) {
    Odometry odometry(four_cameras(), {}, Mode::Frames, using_cameras(names), {kInOrder});
    std::vector<Step> steps;
    numbers_of_all(odometry, all, &steps);
    std::size_t most = 0;
    for (const CameraStep& camera : steps.back().cameras) most += camera.tracks.size();
    return most;
  };
  const auto wanted = static_cast<std::size_t>(OdometryConfig().frame_tracker.detector.max_features);
  EXPECT_LE(features("cam0"), wanted);
  EXPECT_LE(features("cam0,cam1"), wanted * 4 / 3) << "two observe less of a scene with half of the features each";
}

TEST(OdometryOfSeveralCameras, GivesTheSameBitsHoweverTheyLagWithinTheirDelays) {
  const std::vector<Measurement> all = recording(1000, 7.0);
  const OdometryConfig config = using_cameras("dvs0,dvs1,cam0,cam1");
  Odometry in_order(four_cameras(), {}, Mode::Fused, config, {kInOrder});
  const StepNumbers wanted = numbers_of_all(in_order, all);
  ASSERT_GT(wanted.size(), 500U);
  const auto lag_ms = [](const Measurement& m) {
    if (const auto* batch = std::get_if<EventBatch>(&m)) return batch->camera == "dvs0" ? 30 : 13;
    if (const auto* frame = std::get_if<Frame>(&m)) return frame->camera == "cam0" ? 45 : 4;
    return 0;
  };
  std::vector<Measurement> lagging = all;
  std::ranges::stable_sort(lagging, {},
                           [&](const Measurement& m) { return *last_stamp(m) + std::chrono::milliseconds(lag_ms(m)); });
  Odometry patient(four_cameras(), {}, Mode::Fused, config);
  const StepNumbers got = numbers_of_all(patient, lagging);
  ASSERT_EQ(got.size(), wanted.size());
  EXPECT_EQ(std::memcmp(got.data(), wanted.data(), got.size() * sizeof(double)), 0);
  const PacketizerCounters counters = patient.counters().packets;
  EXPECT_EQ(counters.events_late + counters.frames_late, 0U);
}

TEST(OdometryOfSeveralCameras, RefusesNamesThatThereAreNot) {
  EXPECT_THROW(Odometry(four_cameras(), {}, Mode::Fused, using_cameras("dvs0,cam7")), InputError);
  EXPECT_THROW(Odometry(four_cameras(), {}, Mode::Fused, using_cameras("cam0,cam1")), InputError);
}

}  // namespace
}  // namespace edged
