// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/input/sequencer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

Timestamp millisecond(int ms) { return Timestamp(std::chrono::milliseconds(ms)); }
Measurement imu(int ms) { return ImuSample{millisecond(ms)}; }
Measurement frame(int ms) { return Frame{millisecond(ms), "cam", cv::Mat(2, 2, CV_8UC1)}; }
Measurement events(std::initializer_list<int> stamps_ms) {
  EventBatch batch{"dvs", {}};
  for (const int ms : stamps_ms) batch.events.push_back({millisecond(ms), 0, 0, true});
  return batch;
}

/// Event cameras by these names, and frame cameras.
Rig cameras(std::initializer_list<const char*> of_events, std::initializer_list<const char*> of_frames) {
  Rig rig;
  for (const char* name : of_events)
    rig.cameras.push_back({.name = name, .modality = Modality::Events, .model = {}, .T_B_C = {}});
  for (const char* name : of_frames)
    rig.cameras.push_back({.name = name, .modality = Modality::Frames, .model = {}, .T_B_C = {}});
  return rig;
}
const Rig kBoth = cameras({"dvs"}, {"cam"}), kEvents = cameras({"dvs"}, {});

std::string to_text(const Measurement& measurement) {
  const auto ms = [](Timestamp t) { return t.time_since_epoch() / std::chrono::milliseconds(1); };
  if (const auto* sample = std::get_if<ImuSample>(&measurement)) return fmt::format("i{}", ms(sample->t));
  if (const auto* image = std::get_if<Frame>(&measurement)) return fmt::format("f{}", ms(image->t));
  if (const auto* sample = std::get_if<ExternalSample>(&measurement)) return fmt::format("x{}", ms(time_of(*sample)));
  std::vector<std::int64_t> stamps_ms;
  for (const Event& event : std::get<EventBatch>(measurement).events) stamps_ms.push_back(ms(event.t));
  return fmt::format("e{}", fmt::join(stamps_ms, ","));
}

/// All that is ready.
std::string ready(Sequencer& sequencer) {
  std::string text;
  while (const auto measurement = sequencer.next()) {
    if (!text.empty()) text += ' ';
    text += to_text(*measurement);
  }
  return text;
}

TEST(Sequencer, PassesOnWhatItGetsWithoutACopyWhereNothingIsWaitedFor) {
  Sequencer sequencer(kBoth, kInOrder);
  Measurement batch = events({1, 2, 9});
  const Event* const place = std::get<EventBatch>(batch).events.data();
  sequencer.add(std::move(batch));
  const auto same = sequencer.next();
  ASSERT_TRUE(same);
  EXPECT_EQ(std::get<EventBatch>(*same).events.data(), place);
  for (const Measurement& m :
       {imu(10), frame(10), imu(3), events({5, 12}), frame(11), imu(13), events({13}), imu(12)}) {
    sequencer.add(m);
    EXPECT_EQ(ready(sequencer), to_text(m)) << "in order or not";
  }
}

TEST(Sequencer, BreaksTiesByImuEventsFrameWhateverComesFirst) {
  std::vector<Measurement> tied{frame(10), events({10}), imu(10)};
  std::vector<int> order{0, 1, 2};
  do {
    Sequencer sequencer(kBoth, {});
    for (const int i : order) sequencer.add(tied[static_cast<std::size_t>(i)]);
    sequencer.finish();
    EXPECT_EQ(ready(sequencer), "i10 e10 f10");
  } while (std::ranges::next_permutation(order).found);
}

TEST(Sequencer, CutsABatchWhereAnotherMeasurementFallsInside) {
  Sequencer sequencer(kBoth, {});
  for (Measurement m : {events({1, 5, 6, 10, 12}), imu(5), imu(11), frame(10)}) sequencer.add(std::move(m));
  EXPECT_EQ(ready(sequencer), "e1 i5 e5,6,10 f10");  // at 11 another frame may follow
  sequencer.finish();
  EXPECT_EQ(ready(sequencer), "i11 e12");
  EXPECT_TRUE(sequencer.ended());
}

TEST(Sequencer, WaitsForASilentSensorAsLongAsItsDelayAndNoLonger) {
  Sequencer sequencer(kBoth, {.events_s = 0.02, .frames_s = 0.03, .imu_s = 0.0});
  sequencer.add(imu(10));
  sequencer.add(imu(39));
  EXPECT_EQ(ready(sequencer), "");
  sequencer.add(imu(40));
  EXPECT_EQ(ready(sequencer), "i10");
  sequencer.add(events({35}));
  sequencer.add(frame(38));
  EXPECT_EQ(ready(sequencer), "e35") << "before the frame events up to 38 may still arrive";
  sequencer.add(events({39}));
  EXPECT_EQ(ready(sequencer), "f38") << "before the sample at 39 a frame may still arrive";
}

TEST(Sequencer, DoesNotWaitForSensorsThatTheModeDoesNotUse) {
  Sequencer of_events(kEvents, {}), of_frames(cameras({}, {"cam"}), {});
  for (const Measurement& m : {imu(10), events({11}), imu(12)}) of_events.add(m);
  EXPECT_EQ(ready(of_events), "i10 e11");
  for (const Measurement& m : {imu(10), frame(11), imu(12)}) of_frames.add(m);
  EXPECT_EQ(ready(of_frames), "i10 f11");
}

TEST(Sequencer, HandsOnAtOnceWhatComesLaterThanItsDelay) {
  Sequencer sequencer(kEvents, {.events_s = 0.01, .imu_s = 0.01});
  for (int ms = 0; ms <= 50; ms += 5) sequencer.add(imu(ms));
  EXPECT_EQ(ready(sequencer), "i0 i5 i10 i15 i20 i25 i30 i35 i40");
  sequencer.add(events({20, 42, 47}));
  EXPECT_EQ(ready(sequencer), "e20,42 i45 e47");
}

/// What the sensors measure in one second, all in order.
std::vector<Measurement> one_second() {
  std::vector<Measurement> all;
  for (int ms = 0; ms < 1000; ++ms) {
    if (ms % 5 == 0) all.push_back(imu(ms));
    all.push_back(events({ms, ms}));
    if (ms % 50 == 0) all.push_back(frame(ms));
  }
  return all;
}

/// Every event by itself, as batch boundaries are arbitrary.
std::string order_of(Sequencer& sequencer) {
  std::string text;
  while (const auto m = sequencer.next()) {
    const auto* batch = std::get_if<EventBatch>(&*m);
    if (batch == nullptr) text += to_text(*m) + " ";
    for (std::size_t i = 0; batch != nullptr && i < batch->events.size(); ++i) {
      text += to_text(EventBatch{"dvs", {batch->events[i]}}) + " ";
    }
  }
  return text;
}

TEST(Sequencer, GivesOneOrderHoweverTheSensorsLagWithinTheirDelays) {
  Sequencer in_order(kBoth, kInOrder);
  std::string wanted;
  for (const Measurement& m : one_second()) {
    in_order.add(m);
    wanted += order_of(in_order);
  }
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    const std::array<std::size_t, 3> lag{random() % 30, random() % 30, random() % 30};
    std::vector<std::pair<std::size_t, Measurement>> arrivals;
    std::size_t i = 0;
    for (const Measurement& m : one_second()) arrivals.emplace_back(i++ + 2 * lag[m.index()], m);
    std::ranges::stable_sort(arrivals, {}, &std::pair<std::size_t, Measurement>::first);
    Sequencer sequencer(kBoth, {});
    std::string got;
    for (auto& [when, m] : arrivals) {
      sequencer.add(std::move(m));
      if (random() % 3 == 0) got += order_of(sequencer);
    }
    sequencer.finish();
    got += order_of(sequencer);
    ASSERT_EQ(got, wanted) << "seed " << seed;
  }
}

TEST(Sequencer, HoldsABoundedAmountAndStopsWaitingBefore) {
  Sequencer waiting(kBoth, {.events_s = 10, .frames_s = 10, .imu_s = 10}, 100 * sizeof(Event));
  for (int ms = 0; ms < 50; ++ms) EXPECT_TRUE(waiting.add(events({ms})));
  EXPECT_EQ(ready(waiting), "");
  EXPECT_TRUE(waiting.add(events({50})));
  EXPECT_EQ(ready(waiting), "e0") << "and waits again";
  for (int ms = 51; ms < 101; ++ms) EXPECT_TRUE(waiting.add(events({ms})));
  EXPECT_FALSE(waiting.add(events({101})));
  EXPECT_TRUE(waiting.add(imu(101))) << "a gap in the IMU would end the estimate";
}

TEST(Sequencer, TakesNothingAfterTheEndAndPassesOverEmptyBatches) {
  Sequencer sequencer(kBoth, {});
  EXPECT_EQ(ready(sequencer), "");
  EXPECT_TRUE(sequencer.add(events({})));
  sequencer.finish();
  EXPECT_TRUE(sequencer.ended());
  EXPECT_FALSE(sequencer.add(imu(1)));
  EXPECT_EQ(ready(sequencer), "");
}

TEST(SensorDelays, AreRefusedWhereTheyAreNone) {
  EXPECT_THROW(SensorDelays{.frames_s = -0.01}.validate(), InputError);
  EXPECT_THROW(SensorDelays{.events_s = std::nan("")}.validate(), InputError);
  EXPECT_THROW(SensorDelays{.imu_s = 11}.validate(), InputError);
}

Measurement height(int ms) { return ExternalSample(HeightSample{millisecond(ms), 1.0, 0.1}); }

TEST(Sequencer, AnExternalSampleComesBeforeAllElseOfItsStamp) {
  Sequencer sequencer(kBoth, {});
  for (const Measurement& m : {frame(10), events({10, 11}), imu(10), height(10), height(11)}) sequencer.add(m);
  sequencer.finish();
  EXPECT_EQ(ready(sequencer), "x10 i10 e10 f10 x11 e11");
}

TEST(Sequencer, AnExternalSensorIsWaitedForFromItsFirstSampleOnAndForNoLongerThanItsDelay) {
  Sequencer sequencer(kEvents, {.events_s = 0.01, .imu_s = 0.01, .external_s = 0.02});
  for (const Measurement& m : {events({1}), imu(1), events({30}), imu(30)}) sequencer.add(m);
  EXPECT_EQ(ready(sequencer), "i1 e1 i30 e30");
  sequencer.add(height(31));
  for (const Measurement& m : {events({40}), imu(40)}) sequencer.add(m);
  EXPECT_EQ(ready(sequencer), "x31") << "its next may be of 32";
  sequencer.add(height(35));
  for (const Measurement& m : {events({61}), imu(61)}) sequencer.add(m);
  EXPECT_EQ(ready(sequencer), "x35 i40 e40") << "later than its delay";
  sequencer.add(height(36));
  EXPECT_EQ(ready(sequencer), "x36") << "too late for the order, for the packetizer to use or to count";
}

}  // namespace
}  // namespace edged
