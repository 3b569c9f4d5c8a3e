// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/survey/imu_survey.hpp"

#include <algorithm>
#include <cmath>

namespace edged {
namespace {

constexpr Duration kStretch = std::chrono::milliseconds(500);
constexpr std::size_t kFewest = 20;          // samples of a stretch
constexpr double kRestGyro = 0.03;           // deviation at rest, at most [rad/s]
constexpr double kRestAccel = 0.3;           // [m/s^2]

/// Standard deviation of one axis, of three that are summed.
double deviation(double squares, const Eigen::Vector3d& sum, std::size_t count) {
  const auto n = static_cast<double>(count);
  return std::sqrt(std::max(0.0, squares / n - (sum / n).squaredNorm()) / 3);
}

}  // namespace

double ImuSurveyor::Stretch::gyro_deviation() const { return deviation(gyro_squares, gyro, count); }
double ImuSurveyor::Stretch::accel_deviation() const { return deviation(accel_squares, accel, count); }

void ImuSurveyor::add(const ImuSample& sample) {
  if (!sample.gyro_B.allFinite() || !sample.accel_B.allFinite()) return;
  if (current_.count > 0 && sample.t - current_.begin >= kStretch) {
    end_stretch();
  }
  if (current_.count == 0) {
    current_.begin = sample.t;
  } else {
    current_.gyro_differences += (sample.gyro_B - last_->gyro_B).squaredNorm();
    current_.accel_differences += (sample.accel_B - last_->accel_B).squaredNorm();
    current_.time += sample.t - last_->t;
  }
  ++current_.count;
  current_.gyro += sample.gyro_B;
  current_.accel += sample.accel_B;
  current_.gyro_squares += sample.gyro_B.squaredNorm();
  current_.accel_squares += sample.accel_B.squaredNorm();
  last_ = sample;
  ++count_;
  accel_sum_ += sample.accel_B.norm();
  gyro_sum_ += sample.gyro_B.norm();
  max_gyro_ = std::max(max_gyro_, sample.gyro_B.norm());
}

void ImuSurveyor::end_stretch() {
  const bool enough = current_.count >= kFewest;
  if (enough && (!calmest_ || current_.gyro_deviation() < calmest_->gyro_deviation())) calmest_ = current_;
  current_ = Stretch();
}

ImuSurvey ImuSurveyor::result() const {
  ImuSurvey survey;
  ImuSurveyor ended = *this;
  if (!calmest_) ended.end_stretch();  // all of it is shorter than a stretch
  if (count_ == 0) return survey;
  survey.mean_accel = accel_sum_ / static_cast<double>(count_);
  survey.mean_gyro = gyro_sum_ / static_cast<double>(count_);
  survey.max_gyro = max_gyro_;
  if (!ended.calmest_) return survey;
  const Stretch& calm = *ended.calmest_;
  const auto n = static_cast<double>(calm.count), steps = n - 1;
  // Differences of white noise have twice its variance; the density is the deviation times the root of the step.
  const double step_s = to_seconds(calm.time) / steps;
  const auto density = [&](double differences) { return std::sqrt(differences / (3 * steps) / 2 * step_s); };
  survey.calm = {calm.begin,
                 calm.gyro_deviation() < kRestGyro && calm.accel_deviation() < kRestAccel,
                 density(calm.gyro_differences),
                 density(calm.accel_differences),
                 calm.gyro / n,
                 calm.accel / n};
  return survey;
}

}  // namespace edged
