// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A body at rest in front of an image of blocks: the whole odometry, small enough for every sanitizer.
#include "edged/odometry.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "edged/core/check.hpp"
#include "edged/pipeline/input/packetizer.hpp"
#include "edged/pipeline/mode.hpp"
#include "edged/pipeline/odometry_test_support.hpp"
#include "edged/pipeline/packet_step.hpp"
#include "edged/pipeline/vision/image_vision.hpp"

namespace edged {
namespace {

constexpr SensorDelays kPatient{10.0, 10.0, 10.0};

TEST(Odometry, GivesTheBitsOfItsPartsInEveryMode) {
  const std::vector<Measurement> all = measurements(1500);
  for (const Mode mode : {Mode::Events, Mode::Frames, Mode::Fused}) {
    const Rig used = used_cameras(small_rig(), mode);
    Packetizer packetizer(used, {});
    StageTimings timings;
    Localization localization(used, {}, {}, timings);
    ImageVision vision(without_offsets(used), {}, Inference::Synchronous, timings);
    Numbers steps;
    const auto process = [&] {
      while (auto packet = packetizer.next())
        steps.push_back(numbers_of(process_packet(std::move(*packet), localization, vision)));
    };
    for (const Measurement& m : all) packetizer.add(m), process();
    packetizer.finish();
    process();
    expect_same_bits(steps, fed_in_order(all, mode));
  }
}

TEST(Odometry, KeepsAnImageInADriversMemory) {
  Odometry odometry(small_rig(), {}, Mode::Frames, {}, {kInOrder});
  const cv::Mat image = blocks();
  cv::Mat buffer = image.clone();
  int frames = 0;
  for (int ms = 0; ms < 300; ms += 5) {
    odometry.add(resting(stamp(ms)));
    if (ms % 50 == 20) {
      image.copyTo(buffer);
      odometry.add(Frame{stamp(ms), "cam", cv::Mat(kHeight, kWidth, CV_8UC1, buffer.data)});
      buffer.setTo(0);
    }
    while (const auto step = odometry.next())
      frames += std::ranges::equal(cv::Mat_<uchar>(step->find("cam")->image), cv::Mat_<uchar>(image)) ? 1 : 0;
  }
  EXPECT_GT(frames, 4);
}

TEST(Odometry, TellsAllOfAStep) {
  const std::vector<Measurement> all = measurements(1500);
  Odometry odometry(small_rig(), {}, Mode::Fused, {}, {kInOrder});
  Step last;
  int starts = 0;
  for (const Measurement& m : all) {
    odometry.add(m);
    while (auto step = odometry.next()) {
      starts += step->started.empty() ? 0 : 1;
      if (!step->find("cam")->image.empty()) last = std::move(*step);
    }
  }
  EXPECT_EQ(starts, 1);
  EXPECT_EQ(last.status, TrackingStatus::Good);
  EXPECT_EQ(last.state.t, last.t);
  const CameraStep &cam = *last.find("cam"), &dvs = *last.find(Modality::Events);
  EXPECT_GT(cam.tracks.size(), 10U);
  EXPECT_EQ(dvs.image.size(), cv::Size(kWidth, kHeight));
  EXPECT_GT(dvs.rendered, 0U);
  EXPECT_LE(dvs.rendered_events().back().t, last.t);
  EXPECT_GT(odometry.counters().packets.packets, 20U);
}

TEST(Odometry, MayBeMovedWhileItRuns) {
  const std::vector<Measurement> all = measurements(1500);
  Odometry first(small_rig(), {}, Mode::Fused, {}, {kInOrder});
  const std::size_t half = all.size() / 2;
  for (std::size_t i = 0; i < half; ++i) first.add(all[i]);
  Numbers steps = rest_of(first);
  Odometry second = std::move(first);
  for (std::size_t i = half; i < all.size(); ++i) second.add(all[i]);
  second.finish();
  first = std::move(second);
  for (std::vector<double>& step : rest_of(first)) steps.push_back(std::move(step));
  expect_same_bits(steps, fed_in_order(all, Mode::Fused));
}

TEST(OdometryThreads, OneASensorGiveTheBitsOfTheOrderedFeed) {
  const std::vector<Measurement> all = measurements(1200);
  Odometry odometry(small_rig(), {}, Mode::Fused, {}, {kPatient});
  std::vector<std::jthread> drivers;
  for (std::size_t sensor = 0; sensor < 3; ++sensor) {
    drivers.emplace_back([&, sensor] {
      for (const Measurement& m : all) {
        if (m.index() == sensor) odometry.add(m);
        if (m.index() == sensor && sensor != 0) std::this_thread::yield();
      }
    });
  }
  std::jthread controller([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      if (const auto state = odometry.newest_state()) odometry.state_at(state->t - std::chrono::milliseconds(1));
      std::this_thread::yield();
    }
  });
  Numbers steps;
  const auto take = [&] { std::ranges::move(rest_of(odometry), std::back_inserter(steps)); };
  for (int i = 0; i < 50; ++i) take(), std::this_thread::yield();
  drivers.clear();
  odometry.finish();
  take();
  controller.request_stop();
  expect_same_bits(steps, fed_in_order(all, Mode::Fused));
}

TEST(Odometry, PredictsTheStateUpToTheNewestImuSample) {
  Odometry odometry(small_rig(), {}, Mode::Fused, {}, {kInOrder});
  EXPECT_FALSE(odometry.newest_state());
  std::optional<Step> last;
  for (const Measurement& m : measurements(1500)) {
    odometry.add(m);
    while (auto step = odometry.next()) last = std::move(step);
  }
  odometry.add(resting(stamp(1520)));
  const auto newest = odometry.newest_state();
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->t, stamp(1520));
  EXPECT_LT((newest->T_W_B.translation() - last->state.T_W_B.translation()).norm(), 1e-3);
  EXPECT_EQ(odometry.state_at(last->t)->T_W_B.translation(), last->state.T_W_B.translation());
  EXPECT_FALSE(odometry.state_at(last->t - Duration(1)));
}

TEST(Odometry, RefusesOptionsRigsAndNoiseThatCannotBe) {
  OdometryConfig config;
  config.packets.max_interval_s = -1.0;
  EXPECT_THROW(Odometry(small_rig(), {}, Mode::Fused, config), InputError);
  EXPECT_THROW(Odometry(small_rig(), {}, Mode::Fused, {}, {.delays = {.events_s = -1.0}}), InputError);
  ImuNoise silent;
  silent.gyro_noise = 0.0;
  EXPECT_THROW(Odometry(small_rig(), silent, Mode::Fused), InputError);
  Rig events_only = small_rig();
  events_only.cameras.pop_back();
  EXPECT_THROW(Odometry(events_only, {}, Mode::Fused), InputError);
  EXPECT_NO_THROW(Odometry(events_only, {}, Mode::Events));
}

}  // namespace
}  // namespace edged
