// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/imu_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace edged {
namespace {

constexpr Duration kPart = std::chrono::milliseconds(50);
constexpr std::size_t kParts = 10;        // of a stretch
constexpr std::size_t kFewestOfPart = 2;  // of a part
// Limits of the deviations between parts at rest. The noisiest IMUs of phones reach 0.002 rad/s and 0.03 m/s^2. In a
// hand at rest they are at least three times as large.
constexpr double kRestGyro = 0.006, kRestAccel = 0.06;
// Largest mean rates that a run takes for a gyro bias [rad/s]. Above them it is a steady rotation. While the image
// moves, the limit is far lower.
constexpr double kMostBias = 0.15, kMostBiasInMotion = 0.04;
constexpr double kSameRest = 3.0;  // largest difference of the means of parts of one rest, in units of the limits

/// Standard deviation per axis, from the sum of three axes.
double deviation(double squares, const Eigen::Vector3d& sum, std::size_t count) {
  const auto n = static_cast<double>(count);
  return std::sqrt(std::max(0.0, squares / n - (sum / n).squaredNorm()) / 3);
}

}  // namespace

void FrozenDetector::add(Timestamp t, const Eigen::Vector3d& value) {
  if (!begun_) {
    begun_ = true;
    first_ = all_since_ = t;
    axis_since_.fill(t);
    result_.value = value;
    result_.since = t;
  } else {
    for (std::size_t axis = 0; axis < axis_since_.size(); ++axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      if (value[i] != last_[i]) axis_since_[axis] = t;
      result_.axes[axis] = std::max(result_.axes[axis], t - axis_since_[axis]);
    }
    if (value != last_) all_since_ = t;
    if (t - all_since_ > result_.longest) {
      result_.longest = t - all_since_;
      result_.since = all_since_;
      result_.value = value;
    }
  }
  last_ = value;
  result_.covered = t - first_;
}

void ImuCollector::Sums::add(const Eigen::Vector3d& w, const Eigen::Vector3d& a) {
  ++count;
  gyro += w, accel += a;
  gyro_squares += w.squaredNorm(), accel_squares += a.squaredNorm();
}

void ImuCollector::Sums::add(const Sums& other) {
  count += other.count;
  gyro += other.gyro, accel += other.accel;
  gyro_squares += other.gyro_squares, accel_squares += other.accel_squares;
}

void ImuCollector::add(const ImuSample& sample) {
  if (!sample.gyro_B.allFinite() || !sample.accel_B.allFinite()) return;
  if (part_.count > 0 && sample.t >= part_begin_ + kPart) {
    end_part();
    part_begin_ += kPart;
    if (sample.t >= part_begin_ + kPart) current_.reset(), rest_.reset(), part_begin_ = sample.t;  // after a gap
  }
  if (count_ == 0) part_begin_ = sample.t;
  part_.add(sample.gyro_B, sample.accel_B);
  gyro_frozen_.add(sample.t, sample.gyro_B);
  accel_frozen_.add(sample.t, sample.accel_B);
  ++count_;
  accel_sum_ += sample.accel_B.norm();
  gyro_sum_ += sample.gyro_B.norm();
  max_gyro_ = std::max(max_gyro_, sample.gyro_B.norm());
}

void ImuCollector::end_part() {
  const Sums part = std::exchange(part_, Sums());
  if (part.count < kFewestOfPart) {
    current_.reset(), rest_.reset();
    return;
  }
  const Eigen::Vector3d gyro = part.gyro / static_cast<double>(part.count),
                        accel = part.accel / static_cast<double>(part.count);
  if (current_)
    current_->differences.add(gyro - last_gyro_, accel - last_accel_);
  else
    current_ = Stretch{part_begin_, part_begin_, {}, {}, false};
  current_->means.add(gyro, accel);
  last_gyro_ = gyro, last_accel_ = accel;
  current_->end = part_begin_ + kPart;
  if (current_->means.count == kParts) end_stretch();
}

bool ImuCollector::at_rest(const Stretch& stretch) {
  const Sums& s = stretch.means;
  return deviation(s.gyro_squares, s.gyro, s.count) < kRestGyro &&
         deviation(s.accel_squares, s.accel, s.count) < kRestAccel &&
         s.gyro.norm() / static_cast<double>(s.count) < (stretch.image_moves ? kMostBiasInMotion : kMostBias);
}

void ImuCollector::end_stretch() {
  Stretch ended = *std::exchange(current_, std::nullopt);
  ended.image_moves = std::exchange(image_moves_, false);
  const auto spread = [](const Stretch& s) { return deviation(s.means.gyro_squares, s.means.gyro, s.means.count); };
  if (!calmest_ || spread(ended) < spread(*calmest_)) calmest_ = ended;
  if (!at_rest(ended)) {
    rest_.reset();
    return;
  }
  const auto apart = [&](const Eigen::Vector3d& a, std::size_t n, const Eigen::Vector3d& b) {
    return (a / static_cast<double>(n) - b / static_cast<double>(ended.means.count)).norm();
  };
  if (rest_ && apart(rest_->means.gyro, rest_->means.count, ended.means.gyro) < kSameRest * kRestGyro &&
      apart(rest_->means.accel, rest_->means.count, ended.means.accel) < kSameRest * kRestAccel) {
    rest_->end = ended.end;
    rest_->means.add(ended.means);
    rest_->differences.add(ended.differences);
  } else {
    rest_ = ended;
  }
  if (!longest_rest_ || rest_->means.count > longest_rest_->means.count) longest_rest_ = rest_;
}

ImuStatistics ImuCollector::result() const {
  ImuStatistics statistics;
  if (count_ == 0) return statistics;
  statistics.mean_accel = accel_sum_ / static_cast<double>(count_);
  statistics.mean_gyro = gyro_sum_ / static_cast<double>(count_);
  statistics.max_gyro = max_gyro_;
  statistics.gyro_frozen = gyro_frozen_.result();
  statistics.accel_frozen = accel_frozen_.result();
  if (calmest_) {
    const auto n = static_cast<double>(calmest_->means.count);
    statistics.calm = {calmest_->begin, calmest_->means.gyro / n, calmest_->means.accel / n};
  }
  if (longest_rest_) {
    const Sums &means = longest_rest_->means, &steps = longest_rest_->differences;
    const auto n = static_cast<double>(means.count);
    // Differences of white noise have twice its variance. The density is the deviation times the square root of the
    // time.
    const auto density = [&](double squares) {
      return std::sqrt(squares / (3 * static_cast<double>(steps.count)) / 2 * to_seconds(kPart));
    };
    statistics.rest = {longest_rest_->begin,
                       longest_rest_->end - longest_rest_->begin,
                       density(steps.gyro_squares),
                       density(steps.accel_squares),
                       means.gyro / n,
                       means.accel / n};
  }
  return statistics;
}

}  // namespace edged
