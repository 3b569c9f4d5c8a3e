// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/imu/imu_gate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "edged/imu/preintegration.hpp"
#include "edged/imu/tuning.hpp"

namespace edged {
namespace {

constexpr unsigned kGyroAxes = 0b111, kAccelAxes = 0b111000;

}  // namespace

const ByImuFault<ImuFaultInfo>& imu_fault_infos() {
  static constexpr const char* kDriver = "look for the cause in the driver or the cable: each of them leaves a gap";
  static constexpr ByImuFault<ImuFaultInfo> kInfos{{{
      {"imu_not_finite", "not finite", kDriver},
      {"imu_late", "late", "sort the samples by their stamps, and record each once"},
      {"imu_beyond_range", "beyond what a sensor measures", kDriver},
      {"imu_spikes", "far from both neighbours", kDriver},
      {"imu_repeated", "that repeat a reading", "the driver repeats its last sample, or the sensor stopped: a gap"},
      {"imu_clipped", "at the end of the range", "set the sensor to a larger range: what is beyond is unknown"},
      {"imu_shared_stamps", "dropped, with equal stamps", "let the driver stamp each sample"},
      {"imu_spread", "with equal stamps, spread evenly",
       "let the driver stamp each sample, not each transfer of several"},
  }}};
  return kInfos;
}

ImuGate::ImuGate(const ImuFaultCounts& so_far) {
  for (std::size_t i = 0; i < kImuFaults; ++i) faults_[i].count = so_far[i];
}

ImuFaultCounts ImuGate::counts() const {
  ImuFaultCounts counts{};
  for (std::size_t i = 0; i < kImuFaults; ++i) counts[i] = faults_[i].count;
  return counts;
}

ImuGate::Reading ImuGate::reading_of(const ImuSample& sample) {
  return (Reading() << sample.gyro_B, sample.accel_B).finished();
}

std::span<const ImuSample> ImuGate::push(const ImuSample& sample) {
  passed_.clear();
  if (const std::optional<ImuFault> fault = fault_of(sample)) {
    count(*fault, sample.t);
  } else if (newest_ && sample.t == newest_->t) {
    share_stamp(sample);
  } else {
    end_burst();
    newest_ = sample;
    bursts_ ? burst_.push_back(sample) : judge(sample);
  }
  return passed_;
}

std::span<const ImuSample> ImuGate::finish() {
  passed_.clear();
  end_burst();
  if (jump_) pass(*std::exchange(jump_, std::nullopt));
  for (const ImuSample& sample : std::exchange(held_, {})) pass(sample);
  return passed_;
}

std::optional<ImuFault> ImuGate::fault_of(const ImuSample& sample) const {
  const Reading reading = reading_of(sample);
  if (!reading.allFinite()) return ImuFault::NotFinite;
  // The unit may be another one: what the sensor has shown so far counts, too.
  const auto beyond = [&](const Eigen::Vector3d& value, double range, const Eigen::Vector3d& largest) {
    const double most = value.cwiseAbs().maxCoeff();
    return most > kImuGateTuning.any_unit ||
           (last_ && most > range && most > kImuGateTuning.beyond_largest * largest.maxCoeff());
  };
  if (beyond(sample.gyro_B, kImuGateTuning.gyro_range, largest_.head<3>()) ||
      beyond(sample.accel_B, kImuGateTuning.accel_range, largest_.tail<3>()))
    return ImuFault::BeyondRange;
  const bool late = newest_ && (sample.t < newest_->t || (sample.t == newest_->t && reading == reading_of(*newest_)));
  return late ? std::optional(ImuFault::Late) : std::nullopt;
}

/// The first of the first burst has passed, with the stamp of them all.
void ImuGate::share_stamp(const ImuSample& sample) {
  bursts_ = true;
  newest_ = sample;
  if (burst_.empty() || burst_.size() == kImuGateTuning.most_of_burst) return count(ImuFault::SharedStamp, sample.t);
  burst_.push_back(sample);
}

/// A burst is read from the sensor at its stamp: that of its last sample.
void ImuGate::end_burst() {
  if (!newest_) return;
  const Timestamp end = newest_->t, before = std::exchange(burst_before_, end);
  if (burst_.empty()) return;
  const auto size = static_cast<Duration::rep>(burst_.size());
  const Duration spacing = (end - before) / size;
  // After a gap they are as far apart as before.
  spacing_ = spacing_ > Duration(0) ? std::min(spacing, spacing_ * 3 / 2) : spacing;
  std::vector<ImuSample> burst = std::exchange(burst_, {});
  for (Duration::rep after = size; ImuSample & sample : burst) {
    if (size > 1) count(ImuFault::Spread, sample.t);
    sample.t = end - spacing_ * --after;
    judge(sample);
  }
}

void ImuGate::judge(const ImuSample& sample) {
  if (jump_) {
    const ImuSample before = *std::exchange(jump_, std::nullopt);
    returns(before, sample) ? count(ImuFault::Spike, before.t) : pass(before);
  }
  count_repeats(sample);
  const Repetition repeated = repetition();
  if (repeated.surprise > kImuGateTuning.suspected) {
    held_.push_back(sample);
    if (repeated.surprise < kImuGateTuning.refused) return;
    const ImuFault fault = fault_of(repeated);
    for (ImuSample& held : std::exchange(held_, {})) {
      count(fault, repeated.since, held.t - repeated.since, repeated.axes);
      if (fault != ImuFault::Clipped) continue;
      held.gyro_clipped = (repeated.axes & kGyroAxes) != 0;
      held.accel_clipped = (repeated.axes & kAccelAxes) != 0;
      passed_.push_back(*(last_ = held));
    }
    return;
  }
  for (const ImuSample& held : std::exchange(held_, {})) pass(held);
  if (leaves(sample)) {
    jump_ = sample;
  } else {
    pass(sample);
  }
}

void ImuGate::count_repeats(const ImuSample& sample) {
  const Reading reading = reading_of(sample), change = (reading - seen_).cwiseAbs();
  for (Eigen::Index axis = 0; axis < change.size(); ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    if (change[axis] == 0.0) {
      ++repeats_[i];
      continue;
    }
    repeats_[i] = 0;
    repeats_since_[i] = sample.t;
    quantum_[axis] = std::min(quantum_[axis], change[axis]);
    step_[axis] = std::max(change[axis], step_[axis] / 2);
  }
  seen_ = reading;
}

/// Of one axis, of a sensor, or of both: whichever chance explains least.
ImuGate::Repetition ImuGate::repetition() const {
  Repetition least_likely;
  const auto look = [&](std::size_t first, std::size_t axes) {
    double weight = 0.0;
    std::size_t last = first;  // to begin to repeat
    for (std::size_t i = first; i < first + axes; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      // A sensor whose readings changed by single steps of its resolution before may rest.
      if (step_[axis] > kImuGateTuning.rest_steps * quantum_[axis]) weight += weight_[axis];
      if (repeats_[i] < repeats_[last]) last = i;
    }
    const double surprise = static_cast<double>(repeats_[last]) * weight;
    if (surprise > least_likely.surprise) least_likely = {surprise, ((1U << axes) - 1U) << first, repeats_since_[last]};
  };
  for (std::size_t axis = 0; axis < repeats_.size(); ++axis) look(axis, 1);
  look(0, 3), look(3, 3), look(0, 6);
  return least_likely;
}

/// Axes that stay at their largest readings are clipped.
ImuFault ImuGate::fault_of(const Repetition& repeated) const {
  for (Eigen::Index i = 0; i < largest_.size(); ++i)
    if ((repeated.axes >> i & 1U) != 0 && std::abs(seen_[i]) < largest_[i]) return ImuFault::Repeated;
  return ImuFault::Clipped;
}

bool ImuGate::leaves(const ImuSample& sample) const {
  if (!learnt_ || sample.t - last_->t > kMaxSampleInterval) return false;
  const double jump = (sample.gyro_B - last_->gyro_B).cwiseAbs().maxCoeff();
  return jump > std::max(kImuTuning.usual_gyro_jump, kImuGateTuning.times_usual_jump * usual_jump_);
}

bool ImuGate::returns(const ImuSample& jump, const ImuSample& sample) const {
  Eigen::Index axis = 0;
  const double left = (jump.gyro_B - last_->gyro_B).cwiseAbs().maxCoeff(&axis);
  return std::abs(sample.gyro_B[axis] - last_->gyro_B[axis]) < kImuGateTuning.returned * left;
}

void ImuGate::pass(const ImuSample& sample) {
  const Reading reading = reading_of(sample);
  if (last_ && sample.t - last_->t <= kMaxSampleInterval) {
    const Reading before = reading_of(*last_);
    equal_ += (reading.array() == before.array()).cast<double>().matrix();
    constexpr auto kWindow = static_cast<double>(kImuGateTuning.window);
    usual_jump_ += ((reading - before).head<3>().cwiseAbs().maxCoeff() - usual_jump_) / kWindow;
    if (++neighbours_ == kImuGateTuning.window) {
      const Reading weight = -(equal_ / kWindow).cwiseMax(kImuGateTuning.least_share).array().log();
      weight_ = learnt_ ? weight_.cwiseMin(weight) : weight;
      learnt_ = true;
      neighbours_ = 0;
      equal_.setZero();
    }
  }
  largest_ = largest_.cwiseMax(reading.cwiseAbs());
  last_ = sample;
  passed_.push_back(sample);
}

void ImuGate::count(ImuFault fault, Timestamp from, Duration length, unsigned axes) {
  ImuFaultRecord& record = faults_[fault];
  if (record.count++ == 0 || length > record.longest) record = {record.count, from, length, axes};
}

}  // namespace edged
