// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Damaged stamps and clocks that are set back: three sensors at 200, 100 and 20 Hz, stamps in ms.
#include "edged/pipeline/input/measurement_validator.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <vector>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/pipeline/mode.hpp"

namespace edged {
namespace {

constexpr int kHour = 3'600'000;

Timestamp at_ms(int ms) { return Timestamp(std::chrono::milliseconds(ms)); }

Rig two_cameras() {
  const CameraModel lens(10, 10, 10, 10, 5, 5, DistortionModel::None);
  return {"small",
          {{"dvs", Modality::Events, lens, SE3(), Duration(0)}, {"cam", Modality::Frames, lens, SE3(), Duration(0)}}};
}

/// The output: numbers of events, frames and samples, and where a new time began.
struct Received {
  std::size_t events = 0, frames = 0, samples = 0;
  std::vector<Timestamp> stamps, begins;

  void release(MeasurementValidator& validator) {
    while (const auto item = validator.next()) {
      const Measurement& m = item->measurement;
      if (item->begins_epoch) begins.push_back(*first_stamp(m));
      stamps.push_back(*first_stamp(m));
      if (const auto* batch = std::get_if<EventBatch>(&m)) events += batch->events.size();
      frames += std::holds_alternative<Frame>(m);
      samples += std::holds_alternative<ImuSample>(m);
    }
  }
};

/// Two seconds of measurements, each with the stamp of `clock` at its time.
Received received(MeasurementValidator& validator, int from_ms, int to_ms, const std::function<int(int)>& clock) {
  Received all;
  for (int ms = from_ms; ms < to_ms; ms += 5) {
    const Timestamp t = at_ms(clock(ms));
    validator.add(ImuSample{t, {0, 0, 0}, {0, 0, 9.81}});
    if (ms % 10 == 0) validator.add(EventBatch{"dvs", {{t, 1, 1, true}, {t + Duration(1), 1, 1, true}}});
    if (ms % 50 == 0) validator.add(Frame{t, "cam", cv::Mat(10, 10, CV_8UC1)});
    all.release(validator);
  }
  return all;
}

int right(int ms) { return ms; }

TEST(MeasurementValidator, CountsWhatComesFromCamerasThatItDoesNotUse) {
  Rig rig = two_cameras();
  rig.cameras.push_back(rig.cameras.front());
  rig.cameras.back().name = "dvs2";
  MeasurementValidator validator(rig, used_cameras(rig, Mode::Fused), kInOrder);
  validator.add(EventBatch{"dvs2", {{at_ms(1), 1, 1, true}}});
  EXPECT_EQ(validator.counters().unused_camera, 1U);
  EXPECT_EQ(validator.counters().unknown_camera, 0U);
  MeasurementValidator without_frames(rig, used_cameras(rig, Mode::Events), kInOrder);
  without_frames.add(Frame{at_ms(1), "cam", cv::Mat(10, 10, CV_8UC1)});
  EXPECT_EQ(without_frames.counters().unused_camera, 1U) << "the mode does not use it";
}

TEST(MeasurementValidator, ADamagedStampCostsOneMeasurement) {
  for (const SensorDelays& delays : {SensorDelays{}, kInOrder}) {
    MeasurementValidator validator(two_cameras(), two_cameras(), delays);
    Received all = received(validator, 0, 1000, right);
    validator.add(ImuSample{at_ms(998 + kHour), {0, 0, 0}, {0, 0, 9.81}});
    validator.add(Frame{at_ms(998 + kHour), "cam", cv::Mat(10, 10, CV_8UC1)});
    validator.add(EventBatch{"dvs", {{at_ms(996), 1, 1, true}, {at_ms(kHour), 1, 1, true}, {at_ms(997), 1, 1, true}}});
    validator.add(EventBatch{"dvs", {{at_ms(998), 1, 1, true}, {at_ms(2 * kHour), 1, 1, true}}});
    const Received rest = received(validator, 1000, 2000, right);
    validator.finish();
    all.release(validator);
    EXPECT_EQ(all.events + rest.events, 403U);
    EXPECT_EQ(all.frames + rest.frames, 40U);
    EXPECT_EQ(all.samples + rest.samples, 400U);
    EXPECT_EQ(validator.counters().far_ahead, 4U);
    EXPECT_EQ(validator.counters().clocks_set_back, 0U);
  }
}

TEST(MeasurementValidator, ADamagedFirstStampCostsHalfASecond) {
  MeasurementValidator validator(two_cameras(), two_cameras(), {});
  validator.add(ImuSample{at_ms(kHour), {0, 0, 0}, {0, 0, 9.81}});
  const Received all = received(validator, 0, 2000, right);
  ASSERT_EQ(all.begins.size(), 1U);
  EXPECT_LE(all.begins.front(), at_ms(505));
  EXPECT_GT(all.stamps.back(), at_ms(1900));
}

TEST(MeasurementValidator, AClockThatIsSetBackBeginsANewTimeOnce) {
  for (const int back_ms : {2'000, 10'000, kHour}) {
    MeasurementValidator validator(two_cameras(), two_cameras(), {});
    const Received before = received(validator, 0, 1000, right);
    const Received after = received(validator, 1000, 3000, [=](int ms) { return ms - back_ms; });
    EXPECT_TRUE(before.begins.empty());
    ASSERT_EQ(after.begins.size(), 1U);
    EXPECT_LE(after.begins.front(), at_ms(1505 - back_ms));
    EXPECT_GT(after.stamps.back(), at_ms(2900 - back_ms));
    EXPECT_EQ(validator.counters().clocks_set_back, 1U);
  }
}

TEST(MeasurementValidator, ASensorWhoseDriverSetsItsClockBackLaterBeginsAnotherTime) {
  MeasurementValidator validator(two_cameras(), two_cameras(), {});
  received(validator, 0, 1000, right);
  Received all;
  for (int ms = 1000; ms < 5000; ms += 5) {
    validator.add(ImuSample{at_ms(ms - kHour), {0, 0, 0}, {0, 0, 9.81}});
    validator.add(EventBatch{"dvs", {{at_ms(ms < 3000 ? ms : ms - kHour), 1, 1, true}}});
    all.release(validator);
  }
  ASSERT_EQ(all.begins.size(), 2U);
  EXPECT_GT(all.stamps.back(), at_ms(4900 - kHour));
  EXPECT_LT(all.stamps.back(), at_ms(5000 - kHour));
}

TEST(MeasurementValidator, LessThanASecondBackIsLateUntilTheOldTimeIsReached) {
  MeasurementValidator validator(two_cameras(), two_cameras(), {});
  received(validator, 0, 1000, right);
  EXPECT_TRUE(received(validator, 1000, 3000, [](int ms) { return ms - 900; }).begins.empty());
}

TEST(MeasurementValidator, WhatWasNotAskedForIsStillThereAfterAClockWasSetBack) {
  MeasurementValidator validator(two_cameras(), two_cameras(), {});
  for (int ms = 0; ms < 2000; ms += 5) {
    validator.add(ImuSample{at_ms(ms < 1000 ? ms : ms - kHour), {0, 0, 0}, {0, 0, 9.81}});
  }
  validator.finish();
  Received all;
  all.release(validator);
  EXPECT_EQ(all.samples, 400U);
  EXPECT_EQ(all.begins.size(), 1U);
  EXPECT_TRUE(validator.ended());
}

TEST(MeasurementValidator, AHoleOfAllSensorsLeavesTheOrderAsItWas) {
  MeasurementValidator whole(two_cameras(), two_cameras(), kInOrder), holed(two_cameras(), two_cameras(), kInOrder);
  const auto feed = [](MeasurementValidator& validator, int hole_ms) {
    const Received all = received(validator, 0, 1000, [=](int ms) { return ms < 500 ? ms : ms + hole_ms; });
    std::vector<Timestamp> stamps = all.stamps;
    for (Timestamp& t : stamps) {
      if (t > at_ms(500 + hole_ms - 1)) t -= std::chrono::milliseconds(hole_ms);
    }
    return stamps;
  };
  EXPECT_EQ(feed(holed, 60'000), feed(whole, 0));
  EXPECT_EQ(holed.counters().far_ahead, 0U);
}

TEST(MeasurementValidator, EventsUnderTheMaskNeverComeIn) {
  Rig rig = two_cameras();
  std::vector<std::uint8_t> used(100, 255);
  used[11] = 0;  // (1, 1)
  rig.cameras[0].model = rig.cameras[0].model.masked(used);
  MeasurementValidator validator(rig, used_cameras(rig, Mode::Events), kInOrder);
  validator.add(ImuSample{at_ms(0), {0, 0, 0}, {0, 0, 9.81}});
  validator.add(EventBatch{"dvs", {{at_ms(1), 1, 1, true}, {at_ms(1), 2, 1, true}, {at_ms(2), 1, 1, false}}});
  validator.finish();
  Received all;
  all.release(validator);
  EXPECT_EQ(all.events, 1U);
  EXPECT_EQ(validator.counters().events_outside, 0U);
}

Measurement height_at(int ms, double height_m = 1.0) { return ExternalSample(HeightSample{at_ms(ms), height_m, 0.1}); }

TEST(MeasurementValidator, ExternalSamplesThatNoSensorMeasuresAreCounted) {
  MeasurementValidator validator(two_cameras(), two_cameras(), kInOrder);
  validator.add(ImuSample{at_ms(0), {0, 0, 0}, {0, 0, 9.81}});
  validator.add(height_at(1));
  validator.add(height_at(2, std::numeric_limits<double>::quiet_NaN()));
  validator.add(height_at(3, 1e7));
  validator.add(ExternalSample(HeightSample{Timestamp::max(), 1.0, 0.1}));
  validator.add(ExternalSample(VelocitySample{at_ms(4), {1, 0, 0}, {0.1, -0.1, 0.1}}));
  validator.add(ImuSample{at_ms(5), {0, 0, 0}, {0, 0, 9.81}});
  Received all;
  all.release(validator);
  EXPECT_EQ(all.stamps, (std::vector<Timestamp>{at_ms(0), at_ms(1), at_ms(5)}));
  EXPECT_EQ(validator.counters().external_unfit, 3U);
  EXPECT_EQ(validator.counters().absurd_stamps, 1U);
}

TEST(MeasurementValidator, AnotherClockOfAnExternalSensorTouchesNoOtherSensor) {
  for (const int offset_ms : {-kHour, kHour}) {
    MeasurementValidator plain(two_cameras(), two_cameras(), {}), validator(two_cameras(), two_cameras(), {});
    Received expected = received(plain, 0, 2000, right);
    plain.finish();
    expected.release(plain);
    Received all;
    for (int ms = 0; ms < 2000; ms += 20) {
      validator.add(height_at(ms + offset_ms));
      const Received some = received(validator, ms, ms + 20, right);
      all.events += some.events, all.frames += some.frames, all.samples += some.samples;
      EXPECT_TRUE(some.begins.empty());
    }
    validator.finish();
    all.release(validator);
    EXPECT_EQ(all.events, expected.events);
    EXPECT_EQ(all.frames, expected.frames);
    EXPECT_EQ(all.samples, expected.samples);
    EXPECT_EQ(validator.counters().far_ahead, 0U);
    EXPECT_EQ(validator.counters().clocks_set_back, 0U);
  }
}

TEST(MeasurementValidator, ADamagedStampOfAnExternalSensorIsDropped) {
  MeasurementValidator validator(two_cameras(), two_cameras(), kInOrder);
  Received all = received(validator, 0, 100, right);
  for (const int ms : {100, kHour, 120, 140}) validator.add(height_at(ms));
  all = received(validator, 200, 300, right);
  EXPECT_EQ(validator.counters().far_ahead, 1U);
}

}  // namespace
}  // namespace edged
