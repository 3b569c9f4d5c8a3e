// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Long runs: what the program holds in memory does not grow with the time it runs, but for what it remembers of the
// path.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/live/live_source.hpp"
#include "edged/live/test_storm.hpp"
#include "edged/sim/simulator.hpp"
#include "end_to_end.hpp"
#include "memory_use.hpp"
#include "outputs/states.hpp"
#include "run/run_folder.hpp"

namespace edged {
namespace {

/// A short flight there and back again for as long as wanted. Played backwards it is a flight too: events change their
/// sign and angular rates theirs, accelerations stay. The flight must be at rest at both ends, or the turns would be
/// knocks that no accelerometer has felt, and its IMU without bias, which would not change.
class ToAndFro : public Dataset {
 public:
  ToAndFro(std::span<const Measurement> flight, double duration_s)
      : flight_(flight),
        begin_(*last_stamp(flight.front())),
        length_(*last_stamp(flight.back()) - begin_ + std::chrono::milliseconds(1)),
        end_(begin_ + duration_from_seconds(duration_s)) {}

  const DatasetInfo& info() const override { return info_; }

  std::optional<Measurement> next() override {
    if (next_ == flight_.size()) next_ = 0, ++leg_;
    const bool back = leg_ % 2 == 1;
    Measurement m = flight_[back ? flight_.size() - 1 - next_ : next_];
    ++next_;
    const auto moved = [&](Timestamp t) {
      return back ? begin_ + (leg_ + 1) * length_ - (t - begin_) : t + leg_ * length_;
    };
    if (auto* batch = std::get_if<EventBatch>(&m)) {
      for (Event& event : batch->events) event.t = moved(event.t), event.positive ^= back;
      if (back) std::reverse(batch->events.begin(), batch->events.end());
    } else if (auto* frame = std::get_if<Frame>(&m)) {
      frame->t = moved(frame->t);
    } else {
      ImuSample& sample = std::get<ImuSample>(m);
      sample.t = moved(sample.t);
      if (back) sample.gyro_B = -sample.gyro_B;
    }
    if (last_stamp(m).value_or(begin_) > end_) return std::nullopt;
    return m;
  }

 private:
  std::span<const Measurement> flight_;
  Timestamp begin_;
  Duration length_;
  Timestamp end_;
  DatasetInfo info_;
  std::size_t next_ = 0;
  int leg_ = 0;
};

/// A DAVIS240C of half the pixels each way, and no biases.
Flight small_flight(double duration_s, const Disturbance& disturbance = {}) {
  SimulatorConfig config = simulator_preset("room");
  config.duration_s = duration_s;
  config.disturbance = disturbance;
  SimulatedCameraConfig& c = config.camera;
  c.width /= 2, c.height /= 2;
  for (double* value : {&c.fx, &c.fy, &c.cx, &c.cy}) *value /= 2;
  config.imu.gyro_bias = config.imu.accel_bias = 0.0;
  Simulator simulator(config);
  return read_flight(simulator, simulator.calibration());
}

double seconds_of_test() {
  const char* wanted = std::getenv("EDGED_MEMORY_TEST_S");
  return wanted == nullptr ? 60.0 : std::atof(wanted);
}

class Memory : public testing::Test {
 protected:
  Memory() { make_run_folder(folder_); }
  ~Memory() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path folder_ = fmt::format("{}/edged_memory_{}", testing::TempDir(), getpid());
};

TEST_F(Memory, StaysTheSameOverALongRun) {
  const double duration_s = seconds_of_test();  // EDGED_MEMORY_TEST_S=1800 for half an hour
  const Flight flight = small_flight(6.0, {.kind = DisturbanceKind::Standstill, .at_s = 5.5, .length_s = 0.5});
  ToAndFro recording(flight.measurements, duration_s);
  const Rig& rig = flight.calibration.rig;
  Odometry odometry(rig, flight.calibration.imu, Mode::Fused, {}, {kInOrder});
  RunWriter writer(folder_, "body", {});
  RunStatistics statistics;
  double after_a_third_mb = 0.0, next_report_s = 0.0;
  std::optional<Timestamp> begin;
  const auto observe = [&](const Step& step) {
    if (!begin) statistics.add_visual(*(begin = step.t), step.t);
    statistics.add_visual(step.t, step.t);
    statistics.add(step);
    writer.add(step);
    const double t = to_seconds(step.t - *begin);
    if (t >= duration_s / 3 && after_a_third_mb == 0.0) after_a_third_mb = resident_mb();
    if (t < next_report_s) return true;
    std::printf("%6.0f s %7.1f MB, %zu landmarks\n", t, resident_mb(), step.landmarks.size());
    next_report_s += duration_s / 30;
    return true;
  };
  drive(
      odometry, [&] { return recording.next(); }, observe);
  const double at_the_end_mb = resident_mb();
  std::printf("%.1f MB after a third, %.1f MB at the end, coverage %.3f, lost %zu times\n", after_a_third_mb,
              at_the_end_mb, statistics.coverage(), statistics.times_lost());
  EXPECT_GT(statistics.coverage(), 0.9) << "a run that does not track tells little";
  // For the final trajectory: half a megabyte a minute of poses and map matches, and 1.6 of all that left the window
  // with two cameras (a start of 102 states and 15,533 observations in 20 s).
  const double remembered_mb = 2.5 * duration_s / 60.0;
  EXPECT_LT(at_the_end_mb - after_a_third_mb, 6.0 + remembered_mb);
}

TEST(EventStorm, OfTwentyMillionASecondIsSurvivedLiveWithinTheBoundsOfTheQueue) {
  const Flight flight = small_flight(0.1);
  const RigCamera& dvs = *flight.calibration.rig.find(Modality::Events);
  const cv::Size size(dvs.model.width(), dvs.model.height());
  EventStorm storm(dvs.name, flight.calibration.rig.find(Modality::Frames)->name, size, 20e6, 1500);
  const double before_mb = resident_mb();
  double most_mb = 0.0;
  Odometry odometry(flight.calibration.rig, flight.calibration.imu, Mode::Fused, {}, {kInOrder, Inference::OwnThread});
  LiveSource source(storm, {.max_megabytes = 16}, [] { return false; });
  std::size_t events = 0, frames = 0, imu = 0, packets = 0;
  while (source.dropped().events == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const auto next_measurement = [&] {
    const std::optional<Measurement> m = source.next();
    if (!m) return m;
    if (const auto* batch = std::get_if<EventBatch>(&*m)) events += batch->events.size();
    frames += std::holds_alternative<Frame>(*m) ? 1 : 0;
    imu += std::holds_alternative<ImuSample>(*m) ? 1 : 0;
    return m;
  };
  drive(odometry, next_measurement, [&](const Step& step) {
    source.note_result(step.t);
    if (++packets % 10 == 0) most_mb = std::max(most_mb, resident_mb());
    return true;
  });
  std::printf("%zu packets, %zu of %zu events, %zu of %zu frames, %.0f MB more, latency 99 %% %.3f s\n", packets,
              events, storm.events(), frames, storm.frames(), most_mb - before_mb, source.latency().quantile_s(0.99));
  EXPECT_EQ(events + source.dropped().events, storm.events());
  EXPECT_EQ(frames + source.dropped().frames, storm.frames());
  EXPECT_EQ(imu, storm.imu_samples());
  EXPECT_GT(source.dropped().events, 0U);
  EXPECT_GT(packets, 10U);
  EXPECT_LE(source.peaks().bytes, std::size_t{16} << 20U);
  EXPECT_LT(most_mb - before_mb, 300.0);
}

}  // namespace
}  // namespace edged
