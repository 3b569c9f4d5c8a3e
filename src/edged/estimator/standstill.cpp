// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/standstill.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "edged/core/statistics.hpp"

namespace edged {
namespace {

constexpr int kBlocks = 8;              // the window's readings are averaged in blocks: white noise goes, motion stays
constexpr std::size_t kMinCorners = 8;  // fewer common corners say nothing about image motion

}  // namespace

void StandstillConfig::visit(ConfigFields& fields) {
  fields.add("window_s", window_s, {"s", 0.1, 5.0, "rest must last this long to be believed"});
  fields.add("max_gyro", max_gyro, {"rad/s", 1e-4, 1.0, "largest spread of the angular rate at rest"});
  fields.add("max_accel", max_accel, {"m/s^2", 1e-3, 5.0, "largest spread of the acceleration at rest"});
  fields.add("max_gyro_mean", max_gyro_mean, {"rad/s", 1e-3, 1.0, "a mean rate above this is motion, not gyro bias"});
  fields.add("max_image_motion", max_image_motion,
             {"rad", 1e-5, 0.1, "largest median travel of the corners over the window at rest"});
}

void StandstillDetector::add(const std::vector<ImuSample>& imu, const std::vector<CameraObservations>& observations,
                             bool events_quiet) {
  if (imu.empty()) return;
  for (const ImuSample& sample : imu) {
    if (imu_.empty() || sample.t > imu_.back().t) imu_.push_back(sample);
  }
  View view{imu.back().t, {}, events_quiet};
  for (const CameraObservations& camera : observations) {
    for (const FeatureObservation& f : camera.features) view.points.emplace(f.id, f.point);
  }
  views_.push_back(std::move(view));

  const Timestamp begin = imu_.back().t - duration_from_seconds(config_.window_s);
  // One sample and one view at or before the window's begin are kept, so that the window is covered.
  while (imu_.size() > 1 && imu_[1].t <= begin) imu_.pop_front();
  while (views_.size() > 1 && views_[1].t <= begin) views_.pop_front();
  const double covered = to_seconds(imu_.back().t - imu_.front().t);
  if (covered < 0.98 * config_.window_s || imu_.size() < 2 * kBlocks) {
    still_ = false;
    reason_ = fmt::format("{:.2f} of {:.2f} s of IMU", covered, config_.window_s);
    return;
  }
  still_ = imu_still() && image_still();
}

bool StandstillDetector::imu_still() {
  const std::size_t n = imu_.size() / kBlocks;
  constexpr double kHuge = std::numeric_limits<double>::max();
  Eigen::Vector3d gyro_min = Eigen::Vector3d::Constant(kHuge), accel_min = gyro_min;
  Eigen::Vector3d gyro_max = -gyro_min, accel_max = -gyro_min;
  mean_gyro_.setZero();
  mean_accel_.setZero();
  for (std::size_t block = 0; block < kBlocks; ++block) {
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
    for (std::size_t i = block * n; i < (block + 1) * n; ++i) gyro += imu_[i].gyro_B, accel += imu_[i].accel_B;
    gyro /= static_cast<double>(n);
    accel /= static_cast<double>(n);
    mean_gyro_ += gyro / kBlocks;
    mean_accel_ += accel / kBlocks;
    gyro_min = gyro_min.cwiseMin(gyro).eval();
    gyro_max = gyro_max.cwiseMax(gyro).eval();
    accel_min = accel_min.cwiseMin(accel).eval();
    accel_max = accel_max.cwiseMax(accel).eval();
  }
  const double gyro_spread = (gyro_max - gyro_min).maxCoeff(), accel_spread = (accel_max - accel_min).maxCoeff();
  if (gyro_spread > config_.max_gyro || mean_gyro_.norm() > config_.max_gyro_mean) {
    reason_ = fmt::format("turning: gyro spread {:.3f} of {:.3f} rad/s, mean {:.3f} of {:.3f} rad/s", gyro_spread,
                          config_.max_gyro, mean_gyro_.norm(), config_.max_gyro_mean);
    return false;
  }
  if (accel_spread > config_.max_accel) {
    reason_ = fmt::format("accelerating: spread {:.3f} of {:.3f} m/s^2", accel_spread, config_.max_accel);
    return false;
  }
  return true;
}

bool StandstillDetector::image_still() {
  std::vector<double> travel;
  for (const auto& [id, point] : views_.back().points) {
    const auto before = views_.front().points.find(id);
    if (before != views_.front().points.end()) travel.push_back((point - before->second).norm());
  }
  if (travel.size() < kMinCorners) {
    const bool quiet = std::all_of(views_.begin(), views_.end(), [](const View& v) { return v.events_quiet; });
    reason_ = quiet ? "" : fmt::format("{} of {} corners to tell rest from steady motion", travel.size(), kMinCorners);
    return quiet;
  }
  const double middle = median(std::move(travel));
  if (middle <= config_.max_image_motion) {
    reason_.clear();
    return true;
  }
  reason_ = fmt::format("corners move {:.4f} of {:.4f} rad", middle, config_.max_image_motion);
  return false;
}

}  // namespace edged
