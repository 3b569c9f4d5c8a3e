// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/standstill/standstill.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "edged/core/statistics.hpp"

namespace edged {
namespace {

constexpr std::size_t kBlocks = 8;  // the samples are averaged in blocks, which removes white noise and keeps motion
constexpr std::size_t kMinCorners = 8;  // fewer common features do not determine the image motion
constexpr double kGlideStretch = 3.0;   // of the quiet window, where the whole image moves
constexpr double kGlideShare = 0.7;     // of the features, those that move as their median does
// A mean rate is a turn, not a bias, if features move by this share of it or more. A turn about the optical axis hardly
// moves those in the middle. Rates that move them by less than kLeastTurn times max_image_motion are ignored.
constexpr double kTurnShare = 0.2, kLeastTurn = 4.0;
constexpr double kShaking = 6.0;  // times the spreads of a calm IMU: engines, a table that is knocked
constexpr Duration kLeastShaking =
    std::chrono::milliseconds(500);  // a body that starts to move has moved the image then

Eigen::Vector2d median_of(const std::vector<Eigen::Vector2d>& vectors) {
  std::vector<double> x, y;
  for (const Eigen::Vector2d& v : vectors) x.push_back(v.x()), y.push_back(v.y());
  return {median(std::move(x)), median(std::move(y))};
}

/// True if samples are missing since then. Interpolated samples resemble those of a body at rest.
bool has_gap(const std::deque<ImuSample>& samples, Timestamp since) {
  constexpr Duration kLongest = std::chrono::milliseconds(100);
  since = std::max(since, samples.front().t);
  Timestamp measured = since;
  for (const ImuSample& sample : samples) {
    if (sample.t - std::max(since, measured) > kLongest) return true;
    if (!sample.made_up) measured = sample.t;
  }
  return false;
}

std::vector<double> lengths_of(const std::vector<Eigen::Vector2d>& vectors) {
  std::vector<double> lengths;
  for (const Eigen::Vector2d& v : vectors) lengths.push_back(v.norm());
  return lengths;
}

}  // namespace

void StandstillConfig::visit(ConfigFields& fields) {
  fields.add("window_s", window_s, {"s", 0.1, 5.0, "A standstill needs a calm IMU and still images for this time."});
  fields.add("max_gyro", max_gyro, {"rad/s", 1e-4, 1.0, "Largest spread of the angular rate of a calm IMU."});
  fields.add("max_accel", max_accel, {"m/s^2", 1e-3, 5.0, "Largest spread of the acceleration of a calm IMU."});
  fields.add("max_image_motion", max_image_motion,
             {"rad", 1e-5, 0.1, "Largest median motion of the features over the window at a standstill."});
  fields.add(
      "quiet_gyro", quiet_gyro,
      {"rad/s", 1e-4, 1.0, "Largest spread of the angular rate of an IMU that detects a standstill without images."});
  fields.add(
      "quiet_accel", quiet_accel,
      {"m/s^2", 1e-3, 5.0, "Largest spread of the acceleration of an IMU that detects a standstill without images."});
}

void StandstillDetector::add(const std::vector<ImuSample>& imu, const std::vector<CameraObservations>& observations,
                             bool events_quiet, const Eigen::Vector3d& bias_gyro) {
  if (imu.empty()) return;
  for (const ImuSample& sample : imu) {
    if (imu_.empty() || sample.t > imu_.back().t) imu_.push_back(sample);
  }
  View view{imu_.back().t, {}, events_quiet};
  for (const CameraObservations& camera : observations) {
    for (const FeatureObservation& f : camera.features) view.points.emplace(f.id, f.point);
  }
  views_.push_back(std::move(view));

  // One sample and one view at or before the window's begin are kept, so that the window is covered.
  const Timestamp now = imu_.back().t;
  const double longest_s = std::max(config_.window_s, kGlideStretch * config_.quiet_window_s);
  while (imu_.size() > 1 && imu_[1].t <= now - duration_from_seconds(longest_s)) imu_.pop_front();
  while (views_.size() > 1 && views_[1].t <= now - duration_from_seconds(config_.window_s)) views_.pop_front();
  const Spread spread = spread_over(config_.window_s);
  still_ = quiet_ = image_static_ = false;
  const bool gap = has_gap(imu_, now - duration_from_seconds(config_.quiet_window_s));
  if (gap || !imu_calm(spread)) {
    const bool stands = gap ? image_still() : only_shakes(spread);
    if (gap) reason_ = "IMU samples are missing";
    if (!stands) return shakes_since_.reset();
    if (!shakes_since_) shakes_since_ = now;
    image_static_ = now - *shakes_since_ >= kLeastShaking;
    return;
  }
  shakes_since_.reset();
  if (image_turns(mean_gyro_ - bias_gyro)) {
    reason_ = fmt::format("turning steadily: {:.3f} rad/s", (mean_gyro_ - bias_gyro).norm());
    return;
  }
  quiet_ = imu_quiet(config_.quiet_window_s * (image_glides() ? kGlideStretch : 1.0));
  still_ = image_still() || quiet_;
  if (still_) reason_.clear();
}

StandstillDetector::Spread StandstillDetector::spread_over(double window_s) const {
  const Timestamp begin = imu_.back().t - duration_from_seconds(window_s);
  auto first =
      std::upper_bound(imu_.begin(), imu_.end(), begin, [](Timestamp t, const ImuSample& s) { return t < s.t; });
  if (first != imu_.begin()) --first;
  Spread out;
  out.covered_s = to_seconds(imu_.back().t - first->t);
  const std::size_t n = static_cast<std::size_t>(imu_.end() - first) / kBlocks;
  if (n < 2) return {};
  constexpr double kHuge = std::numeric_limits<double>::max();
  Eigen::Vector3d gyro_min = Eigen::Vector3d::Constant(kHuge), accel_min = gyro_min;
  Eigen::Vector3d gyro_max = -gyro_min, accel_max = -gyro_min;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < n; ++i, ++first) gyro += first->gyro_B, accel += first->accel_B;
    gyro /= static_cast<double>(n);
    accel /= static_cast<double>(n);
    out.mean_gyro += gyro / kBlocks;
    out.mean_accel += accel / kBlocks;
    gyro_min = gyro_min.cwiseMin(gyro).eval();
    gyro_max = gyro_max.cwiseMax(gyro).eval();
    accel_min = accel_min.cwiseMin(accel).eval();
    accel_max = accel_max.cwiseMax(accel).eval();
  }
  out.gyro = (gyro_max - gyro_min).maxCoeff();
  out.accel = (accel_max - accel_min).maxCoeff();
  return out;
}

bool StandstillDetector::imu_calm(const Spread& spread) {
  mean_gyro_ = spread.mean_gyro;
  mean_accel_ = spread.mean_accel;
  if (spread.covered_s < 0.98 * config_.window_s) {
    reason_ = fmt::format("{:.2f} of {:.2f} s of IMU", spread.covered_s, config_.window_s);
    return false;
  }
  if (spread.gyro > config_.max_gyro || mean_gyro_.norm() > config_.max_gyro_mean) {
    reason_ = fmt::format("turning: gyro spread {:.3f} of {:.3f} rad/s, mean {:.3f} of {:.3f} rad/s", spread.gyro,
                          config_.max_gyro, mean_gyro_.norm(), config_.max_gyro_mean);
    return false;
  }
  if (spread.accel > config_.max_accel) {
    reason_ = fmt::format("accelerating: spread {:.3f} of {:.3f} m/s^2", spread.accel, config_.max_accel);
    return false;
  }
  return true;
}

bool StandstillDetector::imu_quiet(double window_s) {
  const Spread spread = spread_over(window_s);
  if (spread.covered_s < 0.98 * window_s || spread.gyro > config_.quiet_gyro || spread.accel > config_.quiet_accel) {
    return false;
  }
  mean_gyro_ = spread.mean_gyro;
  mean_accel_ = spread.mean_accel;
  return true;
}

/// Displacement on the unit plane of the features common to the window's first and last views.
std::vector<Eigen::Vector2d> StandstillDetector::travels() const {
  std::vector<Eigen::Vector2d> travels;
  for (const auto& [id, point] : views_.back().points) {
    const auto before = views_.front().points.find(id);
    if (before != views_.front().points.end()) travels.push_back(point - before->second);
  }
  return travels;
}

/// Whether nearly all features move alike: so they do in uniform motion, which an IMU cannot measure; on dynamic
/// objects seldom.
bool StandstillDetector::image_glides() const {
  const std::vector<Eigen::Vector2d> all = travels();
  if (all.size() < kMinCorners) return false;
  const Eigen::Vector2d middle = median_of(all);
  if (middle.norm() <= config_.max_image_motion) return false;
  const auto alike = std::count_if(all.begin(), all.end(), [&](const Eigen::Vector2d& travel) {
    return (travel - middle).norm() < 0.5 * middle.norm();
  });
  return static_cast<double>(alike) > kGlideShare * static_cast<double>(all.size());
}

/// True if the image moves as in a rotation of this rate, which the IMU alone cannot distinguish from a bias.
bool StandstillDetector::image_turns(const Eigen::Vector3d& rate) const {
  const double turned = rate.norm() * config_.window_s;
  if (turned < kLeastTurn * config_.max_image_motion) return false;
  std::vector<double> lengths = lengths_of(travels());
  return lengths.size() >= kMinCorners && median(std::move(lengths)) > kTurnShare * turned;
}

bool StandstillDetector::only_shakes(const Spread& spread) const {
  std::vector<double> lengths = lengths_of(travels());
  return spread.covered_s >= 0.98 * config_.window_s && spread.gyro < kShaking * config_.max_gyro &&
         spread.mean_gyro.norm() < config_.max_gyro_mean && spread.accel < kShaking * config_.max_accel &&
         lengths.size() >= kMinCorners && median(std::move(lengths)) <= config_.max_image_motion;
}

bool StandstillDetector::image_still() {
  std::vector<double> lengths = lengths_of(travels());
  if (lengths.size() < kMinCorners) {
    const bool quiet = std::all_of(views_.begin(), views_.end(), [](const View& v) { return v.events_quiet; });
    reason_ = fmt::format("{} of {} features to distinguish rest from uniform motion", lengths.size(), kMinCorners);
    return quiet;
  }
  const double middle = median(std::move(lengths));
  reason_ = fmt::format("features move {:.4f} of {:.4f} rad", middle, config_.max_image_motion);
  return middle <= config_.max_image_motion;
}

}  // namespace edged
