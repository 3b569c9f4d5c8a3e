// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/imu/noise_estimator.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "edged/core/statistics.hpp"
#include "edged/imu/tuning.hpp"

namespace edged {
namespace {

using Reading = Eigen::Vector3d ImuSample::*;

/// Means of so many consecutive readings: one block after the other, or a sliding one.
std::vector<Eigen::Vector3d> means_of(const std::vector<Eigen::Vector3d>& readings, std::size_t block,
                                      std::size_t step) {
  std::vector<Eigen::Vector3d> means;
  for (std::size_t begin = 0; begin + block <= readings.size(); begin += step) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = begin; i < begin + block; ++i) sum += readings[i];
    means.push_back(sum / static_cast<double>(block));
  }
  return means;
}

/// Standard deviation of an axis, by the squared norms of differences. Knocks leave the median as it is.
double deviation(std::vector<double> squared_norms) {
  constexpr double kMedianOfChiSquare = 2.366;  // of three axes
  return std::sqrt(median(std::move(squared_norms)) / kMedianOfChiSquare);
}

/// Standard deviation of their third differences; 0 with too few.
double third_difference(const std::vector<Eigen::Vector3d>& means) {
  if (means.size() < kImuNoiseTuning.min_blocks) return 0.0;
  std::vector<double> squares;
  for (std::size_t i = 3; i < means.size(); ++i)
    squares.push_back((means[i] - 3.0 * means[i - 1] + 3.0 * means[i - 2] - means[i - 3]).squaredNorm());
  return deviation(std::move(squares));
}

/// The density in use, at least the calibrated one. For white noise the variance of the third difference is 20 times
/// that of a mean; 12.5 times where overlapping triangles, with 2/3 of the variance, take the place of blocks.
double density(const std::deque<ImuSample>& samples, Reading reading, double spacing_s, double calibrated) {
  std::vector<Eigen::Vector3d> readings;
  for (const ImuSample& sample : samples) readings.push_back(sample.*reading);
  const auto length = [&](double s) {
    return std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(s / spacing_s)));
  };
  double faster = 0.0;
  for (const std::size_t block :
       {std::size_t{1}, length(kImuNoiseTuning.short_block_s), length(kImuNoiseTuning.middle_block_s)}) {
    const double block_s = static_cast<double>(block) * spacing_s;
    faster = std::max(faster, third_difference(means_of(readings, block, block)) * std::sqrt(block_s / 20.0));
  }
  const std::size_t block = length(kImuNoiseTuning.long_block_s);
  const double slow = third_difference(means_of(means_of(readings, block, 1), block, block));
  const double found = std::min(faster, slow * std::sqrt(static_cast<double>(block) * spacing_s / (12.5 * 2.0 / 3.0)));
  return found > kImuNoiseTuning.significant * calibrated ? found : calibrated;
}

/// The largest density that Allan deviations show, if it is significant. For white noise the variance of the difference
/// of two means is twice that of a mean.
double density_at_rest(std::span<const ImuSample> imu, Reading reading, double calibrated) {
  std::vector<Eigen::Vector3d> readings;
  for (const ImuSample& sample : imu) readings.push_back(sample.*reading);
  const double spacing_s = to_seconds(imu.back().t - imu.front().t) / static_cast<double>(imu.size() - 1);
  double found = 0.0;
  for (const double block_s : kImuNoiseTuning.rest_blocks_s) {
    const auto block = static_cast<std::size_t>(std::max(1.0, std::round(block_s / spacing_s)));
    if (kImuNoiseTuning.min_rest_blocks * block > readings.size()) break;
    const std::vector<Eigen::Vector3d> means = means_of(readings, block, 1);
    std::vector<double> squares;
    for (std::size_t i = block; i < means.size(); ++i) squares.push_back((means[i] - means[i - block]).squaredNorm());
    found = std::max(found, deviation(std::move(squares)) * std::sqrt(0.5 * static_cast<double>(block) * spacing_s));
  }
  return found > kImuNoiseTuning.significant_at_rest * calibrated ? found : calibrated;
}

}  // namespace

ImuNoise noise_at_rest(std::span<const ImuSample> imu, const ImuNoise& calibrated) {
  ImuNoise noise = calibrated;
  if (imu.size() < 2) return noise;
  noise.gyro_noise = density_at_rest(imu, &ImuSample::gyro_B, calibrated.gyro_noise);
  noise.accel_noise = density_at_rest(imu, &ImuSample::accel_B, calibrated.accel_noise);
  return noise;
}

const ImuNoise& ImuNoiseEstimator::add(const std::vector<ImuSample>& imu) {
  for (std::size_t i = 1; i + 1 < imu.size(); ++i) {
    const ImuSample& sample = imu[i];
    if (sample.interpolated || (!samples_.empty() && sample.t - samples_.back().t > kImuNoiseTuning.max_spacing))
      samples_.clear();
    if (!sample.interpolated) samples_.push_back(sample);
  }
  if (samples_.size() < 2) return noise_ = least_;
  while (samples_.back().t - samples_.front().t > kImuNoiseTuning.window) samples_.pop_front();
  const double spacing_s =
      to_seconds(samples_.back().t - samples_.front().t) / static_cast<double>(samples_.size() - 1);
  const double gyro = density(samples_, &ImuSample::gyro_B, spacing_s, calibrated_.gyro_noise);
  const double accel = density(samples_, &ImuSample::accel_B, spacing_s, calibrated_.accel_noise);
  const double grown = growth(accel);
  noise_.gyro_noise = std::max(least_.gyro_noise, grown * gyro);
  noise_.accel_noise = std::max(least_.accel_noise, grown * accel);
  return noise_;
}

void ImuNoiseEstimator::add_correction(Timestamp t, const Eigen::Vector3d& dv, double dt_s) {
  corrections_.push_back({t, dv.squaredNorm() / dt_s});
  while (t - corrections_.front().t > kImuNoiseTuning.window) corrections_.pop_front();
}

/// How many times the noise that the readings show the corrections tell. A vibration has one spectrum in both sensors.
double ImuNoiseEstimator::growth(double accel_noise) const {
  if (accel_noise == calibrated_.accel_noise || corrections_.size() < kImuNoiseTuning.min_corrections) return 1.0;
  std::vector<double> squares;
  for (const Correction& correction : corrections_) squares.push_back(correction.per_s);
  const double grown = deviation(std::move(squares)) / accel_noise;
  return grown > kImuNoiseTuning.significant ? std::min(grown, kImuNoiseTuning.max_growth) : 1.0;
}

}  // namespace edged
