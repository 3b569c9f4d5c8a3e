// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A body at rest in front of an image of blocks: the whole odometry, small enough for every sanitizer.
#include "edged/odometry.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>
#include <thread>

#include "edged/core/check.hpp"
#include "edged/core/measurement_stamps.hpp"
#include "edged/pipeline/mode.hpp"
#include "edged/pipeline/packet_odometry.hpp"
#include "edged/pipeline/packetizer.hpp"

namespace edged {
namespace {

constexpr int kWidth = 120, kHeight = 90;
constexpr SensorDelays kPatient{10.0, 10.0, 10.0};

Timestamp stamp(int ms) { return Timestamp(std::chrono::milliseconds(ms)); }

ImuSample resting(Timestamp t) { return {t, {0, 0, 0}, {0, 0, 9.81}}; }

Rig small_rig() {
  const CameraModel lens(kWidth, kHeight, 100, 100, 60, 45, DistortionModel::None);
  return {"small",
          {{"dvs", Modality::Events, lens, SE3(), Duration(0)}, {"cam", Modality::Frames, lens, SE3(), Duration(0)}}};
}

cv::Mat blocks() {
  cv::Mat image(kHeight, kWidth, CV_8UC1);
  std::mt19937 random(1);
  std::vector<int> grey(12 * 9);
  for (int& g : grey) g = 30 + static_cast<int>(random() % 200);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x)
      image.at<unsigned char>(y, x) = static_cast<unsigned char>(grey[y / 10 * 12 + x / 10]);
  }
  return image;
}

/// In the order of a Dataset: ties IMU, events, frame.
std::vector<Measurement> measurements(int length_ms) {
  std::vector<Measurement> all;
  const cv::Mat image = blocks();
  std::mt19937 random(2);
  for (int ms = 0; ms < length_ms; ++ms) {
    if (ms % 5 == 0) all.emplace_back(resting(stamp(ms)));
    EventBatch batch{"dvs", {}};
    for (int i = 0; i < 20; ++i) {
      batch.events.push_back({stamp(ms) + std::chrono::microseconds(40 * i),
                              static_cast<std::uint16_t>(random() % kWidth),
                              static_cast<std::uint16_t>(random() % kHeight), true});
    }
    all.emplace_back(std::move(batch));
    if (ms % 50 == 1) all.emplace_back(Frame{stamp(ms) - std::chrono::microseconds(1), "cam", image});
  }
  std::ranges::stable_sort(all, {}, [](const Measurement& m) { return *first_stamp(m); });
  return all;
}

std::vector<double> numbers_of(const Step& step) {
  const NavState& s = step.state;
  const Eigen::Quaterniond& q = s.T_W_B.rotation();
  std::vector<double> numbers{to_seconds(step.t), static_cast<double>(step.status), q.w(), q.x(), q.y(), q.z(),
                              step.scene_depth};
  for (const Eigen::Vector3d& v : {s.T_W_B.translation(), s.v_W, s.bias_gyro, s.bias_accel}) {
    numbers.insert(numbers.end(), v.data(), v.data() + 3);
  }
  for (const CameraStep& camera : step.cameras) {
    numbers.push_back(camera.event_rate_hz);
    for (const Track& track : camera.tracks) numbers.insert(numbers.end(), {track.pixel.x(), track.pixel.y()});
  }
  return numbers;
}

using Numbers = std::vector<std::vector<double>>;

void expect_same_bits(const Numbers& a, const Numbers& b) {
  ASSERT_GT(a.size(), 20U);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].size(), b[i].size()) << "step " << i;
    ASSERT_EQ(std::memcmp(a[i].data(), b[i].data(), a[i].size() * sizeof(double)), 0) << "step " << i;
  }
}

Numbers rest_of(Odometry& odometry) {
  Numbers steps;
  while (const auto step = odometry.next()) steps.push_back(numbers_of(*step));
  return steps;
}

Numbers fed_in_order(const std::vector<Measurement>& all, Mode mode) {
  Odometry odometry(small_rig(), {}, mode, {}, {kInOrder});
  Numbers steps;
  drive(
      odometry, [&, next = all.begin()]() mutable { return next == all.end() ? std::nullopt : std::optional(*next++); },
      [&](const Step& step) {
        steps.push_back(numbers_of(step));
        return true;
      });
  return steps;
}

TEST(Odometry, GivesTheBitsOfItsPartsInEveryMode) {
  const std::vector<Measurement> all = measurements(1500);
  for (const Mode mode : {Mode::Events, Mode::Frames, Mode::Fused}) {
    const Rig used = used_cameras(small_rig(), mode);
    Packetizer packetizer(used, {});
    PacketOdometry parts(used, {}, {}, Inference::Synchronous);
    Numbers steps;
    const auto process = [&] {
      while (auto packet = packetizer.next()) steps.push_back(numbers_of(parts.process(std::move(*packet))));
    };
    for (const Measurement& m : all) packetizer.add(m), process();
    packetizer.finish();
    process();
    expect_same_bits(steps, fed_in_order(all, mode));
  }
}

TEST(Odometry, ComesBackWhereTheClocksOfItsSensorsAreDecadesApart) {
  Odometry odometry(small_rig(), {}, Mode::Events);
  int steps = 0;
  for (int ms = 0; ms < 500; ms += 5) {
    odometry.add(resting(stamp(ms) + std::chrono::years(50)));
    if (ms >= 200) odometry.add(EventBatch{"dvs", {{stamp(ms), 1, 2, true}}});
    while (odometry.next()) ++steps;  // at standstill, on the clock of the IMU
  }
  EXPECT_LT(steps, 20);
}

/// On the clock of their sensor.
Measurement shifted(Measurement m, Duration by) {
  if (auto* batch = std::get_if<EventBatch>(&m)) {
    for (Event& event : batch->events) event.t += by;
  } else if (auto* frame = std::get_if<Frame>(&m)) {
    frame->t += by;
  } else {
    std::get<ImuSample>(m).t += by;
  }
  return m;
}

TEST(Odometry, StartsAgainWithinASecondOnceTheClockWasSetBack) {
  Odometry odometry(small_rig(), {}, Mode::Fused);
  const auto back = -std::chrono::seconds(10);
  std::vector<Step> steps;
  const auto feed = [&](Duration by) {
    for (const Measurement& m : measurements(3000)) {
      odometry.add(shifted(m, by));
      while (auto step = odometry.next()) steps.push_back(std::move(*step));
    }
  };
  feed(Duration(0));
  ASSERT_EQ(steps.back().status, TrackingStatus::Good);
  const std::size_t before = steps.size();
  feed(std::chrono::seconds(3) + back);
  ASSERT_GT(steps.size(), before + 50);
  const auto first =
      std::ranges::find_if(steps, [&](const Step& s) { return s.t < Timestamp(std::chrono::seconds(-2)); });
  ASSERT_NE(first, steps.end());
  EXPECT_LT(first->t, stamp(4000) + back);
  EXPECT_EQ(first->status, TrackingStatus::Lost);
  EXPECT_EQ(first->lost_because, "a clock was set back");
  EXPECT_EQ(steps.back().status, TrackingStatus::Good);
  EXPECT_TRUE(odometry.newest_state());
  EXPECT_EQ(odometry.counters().intake.clocks_set_back, 1U);
}

TEST(Odometry, GoesOnAfterAStampAnHourAhead) {
  const std::vector<Measurement> all = measurements(1500);
  Odometry odometry(small_rig(), {}, Mode::Fused, {}, {kInOrder});
  Numbers steps;
  for (const Measurement& m : all) {
    odometry.add(m);
    if (std::holds_alternative<ImuSample>(m) && *first_stamp(m) == stamp(700)) {
      for (const Measurement& damaged : {m, Measurement(EventBatch{"dvs", {{stamp(700), 1, 1, true}}})})
        odometry.add(shifted(damaged, std::chrono::hours(1)));
    }
    std::ranges::move(rest_of(odometry), std::back_inserter(steps));
  }
  odometry.finish();
  std::ranges::move(rest_of(odometry), std::back_inserter(steps));
  expect_same_bits(steps, fed_in_order(all, Mode::Fused));
  EXPECT_EQ(odometry.counters().intake.far_ahead, 2U);
}

TEST(Odometry, TellsEveryFiveSecondsThatFramesStayAway) {
  Odometry odometry(small_rig(), {}, Mode::Frames);
  odometry.add(Frame{stamp(5), "cam", blocks()});
  std::vector<Timestamp> steps;
  for (int ms = 0; ms <= 60'000; ms += 5) {
    odometry.add(resting(stamp(ms)));
    while (const auto step = odometry.next()) steps.push_back(step->t);
  }
  ASSERT_EQ(steps.size(), 12U);
  EXPECT_EQ(steps.back(), stamp(55'005));
  EXPECT_EQ(odometry.counters().packets.frames_missing, 11U);
}

TEST(Odometry, LosesNothingWhereACamerasClockIsBehindByMoreThanItsDelay) {
  for (const auto offset : {std::chrono::milliseconds(200), std::chrono::milliseconds(-200)}) {
    Rig rig = small_rig();
    for (RigCamera& camera : rig.cameras) camera.time_offset = offset;
    Odometry odometry(rig, {}, Mode::Fused);
    std::size_t steps = 0;
    for (Measurement m : measurements(1500)) {
      if (auto* frame = std::get_if<Frame>(&m)) frame->t -= offset;
      if (auto* batch = std::get_if<EventBatch>(&m)) {
        for (Event& event : batch->events) event.t -= offset;
      }
      odometry.add(std::move(m));
      while (odometry.next()) ++steps;
    }
    const PacketizerCounters counters = odometry.counters().packets;
    EXPECT_EQ(counters.events_late + counters.frames_late + counters.imu_late, 0U);
    EXPECT_GT(steps, 20U);
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

TEST(Odometry, CountsWhatIsBadAndNeverThrows) {
  const Rig rig = small_rig();
  Odometry odometry(rig, {}, Mode::Events, {}, {kInOrder});
  const cv::Mat image = blocks();
  for (Measurement m : std::initializer_list<Measurement>{
           Frame{stamp(1), "cam", image}, Frame{stamp(1), "elsewhere", image},
           EventBatch{"cam", {{stamp(1), 1, 1, true}}},
           EventBatch{"dvs", {{stamp(1), kWidth, 1, true}, {stamp(1), 1, kHeight, true}, {stamp(2), 1, 1, true}}},
           EventBatch{"dvs", {{Timestamp::max(), 1, 1, true}}}, EventBatch{"dvs", {}}, resting(Timestamp::min()),
           ImuSample{stamp(1), {0, 0, std::nan("")}, {0, 0, 9.81}}, resting(stamp(5)), resting(stamp(4))}) {
    odometry.add(std::move(m));
  }
  Odometry with_frames(rig, {}, Mode::Frames, {}, {kInOrder});
  for (Measurement m : std::initializer_list<Measurement>{
           Frame{stamp(1), "cam", cv::Mat()}, Frame{stamp(2), "cam", cv::Mat(kHeight, kWidth, CV_8UC3)},
           Frame{stamp(3), "cam", cv::Mat(kHeight, kWidth - 1, CV_8UC1)}, Frame{stamp(4), "cam", image}}) {
    with_frames.add(std::move(m));
  }
  odometry.finish();
  odometry.add(resting(stamp(6)));
  while (odometry.next()) {
  }
  const OdometryCounters counters = odometry.counters();
  EXPECT_EQ(counters.intake.unknown_camera, 2U);
  EXPECT_EQ(counters.intake.events_outside, 2U);
  EXPECT_EQ(counters.intake.absurd_stamps, 2U);
  EXPECT_EQ(counters.intake.no_room, 1U);
  EXPECT_EQ(counters.packets.imu_not_finite, 1U);
  EXPECT_EQ(counters.packets.imu_late, 1U);
  EXPECT_EQ(with_frames.counters().intake.frames_unfit, 3U);
}

TEST(Odometry, LosesNothingOfSensorsThatLagWithinTheirDelaysAndCountsWhatTheyLoseBeyond) {
  std::vector<Measurement> all = measurements(1500);
  const Numbers wanted = fed_in_order(all, Mode::Fused);
  // The events arrive 30 ms, the frames 45 ms after the IMU sample of their time.
  const auto arrival = [](const Measurement& m) {
    const int lag_ms = std::holds_alternative<EventBatch>(m) ? 30 : std::holds_alternative<Frame>(m) ? 45 : 0;
    return *last_stamp(m) + std::chrono::milliseconds(lag_ms);
  };
  std::ranges::stable_sort(all, {}, arrival);
  const auto feed = [&](Odometry& odometry) {
    Numbers steps;
    for (const Measurement& m : all) {
      odometry.add(m);
      std::ranges::move(rest_of(odometry), std::back_inserter(steps));
    }
    odometry.finish();
    std::ranges::move(rest_of(odometry), std::back_inserter(steps));
    return steps;
  };
  Odometry patient(small_rig(), {}, Mode::Fused), hasty(small_rig(), {}, Mode::Fused, {}, {kInOrder});
  expect_same_bits(feed(patient), wanted);
  EXPECT_EQ(patient.counters().packets.events_late + patient.counters().packets.frames_late, 0U);
  feed(hasty);
  EXPECT_GT(hasty.counters().packets.events_late, 100U);
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
