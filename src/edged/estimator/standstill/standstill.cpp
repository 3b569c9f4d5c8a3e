// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/standstill/standstill.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "edged/core/statistics.hpp"
#include "edged/estimator/tuning.hpp"
#include "edged/imu/noise_estimator.hpp"

namespace edged {
namespace {

/// True if samples are missing since then.
bool has_gap(const std::deque<ImuSample>& samples, Timestamp since) {
  since = std::max(since, samples.front().t);
  Timestamp measured = since;
  for (const ImuSample& sample : samples) {
    if (sample.t - std::max(since, measured) > kStandstillTuning.max_gap) return true;
    if (!sample.interpolated) measured = sample.t;
  }
  return false;
}

}  // namespace

void StandstillConfig::visit(ConfigFields& fields) {
  fields.add("window_s", window_s, {"s", 0.1, 5.0, "A standstill needs a calm IMU and still images for this time."});
  fields.add("max_gyro", max_gyro, {"rad/s", 1e-4, 1.0, "Largest spread of the angular rate of a calm IMU."});
  fields.add("max_accel", max_accel, {"m/s^2", 1e-3, 5.0, "Largest spread of the acceleration of a calm IMU."});
}

void StandstillDetector::add(const std::vector<ImuSample>& imu, const std::vector<CameraObservations>& observations,
                             bool events_quiet, const Eigen::Vector3d& bias_gyro, const MotionSource& motion) {
  if (imu.empty()) return;
  buffer(imu, observations, events_quiet);
  const Spread spread = spread_over(config_.window_s);
  still_ = quiet_ = image_static_ = false;
  bias_gyro_ = bias_gyro;
  const bool gap = has_gap(imu_, imu_.back().t - duration_from_seconds(kStandstillTuning.quiet_window_s));
  if (gap || !imu_calm(spread)) {
    judge_shaking(spread, gap, motion);
  } else {
    judge_calm(motion);
  }
  measure_rest();
}

/// Still images suffice after a while, by which a body that starts to move has moved them.
void StandstillDetector::judge_shaking(const Spread& spread, bool gap, const MotionSource& motion) {
  const std::string why = gap ? "IMU samples are missing" : reason_;
  const bool stands = gap ? image_still() : only_shakes(spread);
  reason_ = why;
  if (!stands) return shakes_since_.reset();
  if (!shakes_since_) shakes_since_ = imu_.back().t;
  image_static_ = imu_.back().t - *shakes_since_ >= kStandstillTuning.min_shaking;
  if (!image_static_ || gap) return;
  const std::optional<KnownMotion> known = motion();
  still_ = !known || !hidden_from_image(*known);
  reason_ = still_ ? "" : why;
}

void StandstillDetector::judge_calm(const MotionSource& motion) {
  if (!vibrates()) shakes_since_.reset();
  if (image_turns()) {
    reason_ = fmt::format("turning steadily: {:.3f} rad/s", rate());
    return;
  }
  quiet_ = imu_quiet(kStandstillTuning.quiet_window_s * (image_.glides() ? kStandstillTuning.glide_stretch : 1.0));
  const bool still = image_still();
  if (!still && !quiet_) return;
  const std::optional<KnownMotion> known = motion();
  still_ = still ? !known || !hidden_from_image(*known) : !explains_image(known);
  if (still_) {
    reason_.clear();
  } else {
    quiet_ = false;
  }
}

bool StandstillDetector::vibrates() const { return mean_gyro_sigma(1.0) > 0.0 || mean_accel_sigma(1.0) > 0.0; }

/// Once a rest has lasted for a while all that the IMU shows is noise.
void StandstillDetector::measure_rest() {
  if (!still_) {
    rests_since_.reset(), measured_at_.reset(), noise_at_rest_.reset();
    return;
  }
  const Timestamp now = imu_.back().t;
  const Duration window = duration_from_seconds(config_.window_s);
  if (!rests_since_) rests_since_ = std::min(now, shakes_since_.value_or(now)) - window;
  if (now - *rests_since_ < kStandstillTuning.min_shaking + window) return;
  if (vibrates()) take_means(spread_over(to_seconds(now - *rests_since_)));
  if (measured_at_ && now - *measured_at_ < kStandstillTuning.noise_interval) return;
  measured_at_ = now;
  const auto first = std::ranges::find_if(imu_, [&](const ImuSample& sample) { return sample.t >= *rests_since_; });
  noise_at_rest_ = edged::noise_at_rest(std::vector<ImuSample>(first, imu_.end()), calibrated_);
  noise_.gyro_noise = std::max(noise_.gyro_noise, noise_at_rest_->gyro_noise);
  noise_.accel_noise = std::max(noise_.accel_noise, noise_at_rest_->accel_noise);
}

void StandstillDetector::take_means(const Spread& spread) {
  mean_gyro_ = spread.mean_gyro;
  mean_accel_ = spread.mean_accel;
  mean_duration_s_ = spread.covered_s;
}

/// Density beyond the calibrated one.
double StandstillDetector::vibration(double ImuNoise::*density) const {
  return std::sqrt(std::max(0.0, square(noise_.*density) - square(calibrated_.*density)));
}

/// Keeps one sample at or before the window's begin, so that the window is covered.
void StandstillDetector::buffer(const std::vector<ImuSample>& imu, const std::vector<CameraObservations>& observations,
                                bool events_quiet) {
  for (const ImuSample& sample : imu) {
    if (imu_.empty() || sample.t > imu_.back().t) imu_.push_back(sample);
  }
  const Timestamp now = imu_.back().t;
  image_.add(now, observations, events_quiet);
  const double longest_s =
      std::max(config_.window_s, kStandstillTuning.glide_stretch * kStandstillTuning.quiet_window_s);
  while (imu_.size() > 1 && imu_[1].t <= now - duration_from_seconds(longest_s)) imu_.pop_front();
}

StandstillDetector::Spread StandstillDetector::spread_over(double window_s) const {
  const Timestamp begin = imu_.back().t - duration_from_seconds(window_s);
  auto first =
      std::upper_bound(imu_.begin(), imu_.end(), begin, [](Timestamp t, const ImuSample& s) { return t < s.t; });
  if (first != imu_.begin()) --first;
  Spread out;
  out.covered_s = to_seconds(imu_.back().t - first->t);
  const std::size_t n = static_cast<std::size_t>(imu_.end() - first) / kStandstillTuning.blocks;
  if (n < 2) return {};
  constexpr double kHuge = std::numeric_limits<double>::max();
  Eigen::Vector3d gyro_min = Eigen::Vector3d::Constant(kHuge), accel_min = gyro_min;
  Eigen::Vector3d gyro_max = -gyro_min, accel_max = -gyro_min;
  for (std::size_t block = 0; block < kStandstillTuning.blocks; ++block) {
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < n; ++i, ++first) gyro += first->gyro_B, accel += first->accel_B;
    gyro /= static_cast<double>(n);
    accel /= static_cast<double>(n);
    out.mean_gyro += gyro / kStandstillTuning.blocks;
    out.mean_accel += accel / kStandstillTuning.blocks;
    gyro_min = gyro_min.cwiseMin(gyro).eval();
    gyro_max = gyro_max.cwiseMax(gyro).eval();
    accel_min = accel_min.cwiseMin(accel).eval();
    accel_max = accel_max.cwiseMax(accel).eval();
  }
  out.gyro = (gyro_max - gyro_min).maxCoeff();
  out.accel = (accel_max - accel_min).maxCoeff();
  return out;
}

double StandstillDetector::max_gyro_spread() const {
  return config_.max_gyro +
         kStandstillTuning.block_spread * mean_gyro_sigma(config_.window_s / kStandstillTuning.blocks);
}

double StandstillDetector::max_accel_spread() const {
  return config_.max_accel +
         kStandstillTuning.block_spread * mean_accel_sigma(config_.window_s / kStandstillTuning.blocks);
}

bool StandstillDetector::imu_calm(const Spread& spread) {
  take_means(spread);
  const double max_mean =
      kStandstillTuning.max_gyro_mean + kStandstillTuning.moving_sigma * mean_gyro_sigma(config_.window_s);
  if (spread.covered_s < kStandstillTuning.min_cover * config_.window_s) {
    reason_ = fmt::format("{:.2f} of {:.2f} s of IMU", spread.covered_s, config_.window_s);
    return false;
  }
  if (spread.gyro > max_gyro_spread() || mean_gyro_.norm() > max_mean) {
    reason_ = fmt::format("turning: gyro spread {:.3f} of {:.3f} rad/s, mean {:.3f} of {:.3f} rad/s", spread.gyro,
                          max_gyro_spread(), mean_gyro_.norm(), max_mean);
    return false;
  }
  if (spread.accel > max_accel_spread()) {
    reason_ = fmt::format("accelerating: spread {:.3f} of {:.3f} m/s^2", spread.accel, max_accel_spread());
    return false;
  }
  return true;
}

bool StandstillDetector::imu_quiet(double window_s) {
  const Spread spread = spread_over(window_s);
  if (spread.covered_s < kStandstillTuning.min_cover * window_s || spread.gyro > kStandstillTuning.quiet_gyro ||
      spread.accel > kStandstillTuning.quiet_accel) {
    return false;
  }
  take_means(spread);
  return true;
}

/// True if the image moves as in a rotation of the mean rate, which the IMU alone cannot distinguish from a bias.
bool StandstillDetector::image_turns() {
  const double turned = rate() * config_.window_s;
  if (turned < kStandstillTuning.min_turn * kStandstillTuning.max_image_motion) return false;
  const std::optional<double> travel = image_.median_travel();
  return travel && *travel > kStandstillTuning.turn_share * turned;
}

/// Whether the estimate moves or the gyro turns by more than the uncertainty.
bool StandstillDetector::moves(const KnownMotion& motion) {
  const double most_speed = kStandstillTuning.moving_sigma * motion.speed_sigma,
               most_rate = kStandstillTuning.moving_sigma * motion.rate_sigma;
  if (motion.speed <= most_speed && rate() <= most_rate) return false;
  reason_ = fmt::format("moving at {:.3f} of {:.3f} m/s, turning at {:.4f} of {:.4f} rad/s", motion.speed, most_speed,
                        rate(), most_rate);
  return true;
}

/// Whether the body moves so slowly or so far from the scene that still images do not contradict it.
bool StandstillDetector::hidden_from_image(const KnownMotion& motion) {
  const double depth_m = motion.depth_m.value_or(kStandstillTuning.usual_depth_m);
  const double travel = config_.window_s * (motion.speed / depth_m + rate());
  return moves(motion) && travel < kStandstillTuning.contradicted * kStandstillTuning.max_image_motion;
}

/// Whether the images move no faster than a motion that the estimate allows; before the start, as a whole, and no
/// faster than in a motion that an IMU does not feel. Nothing to see explains nothing.
bool StandstillDetector::explains_image(const std::optional<KnownMotion>& motion) {
  if (motion && moves(*motion)) return true;
  const std::optional<double> travel = image_.median_travel();
  if (!travel || (!motion && !image_.glides())) return false;
  double speed = kStandstillTuning.unfelt_speed, rate = 0.0;
  if (motion) {
    speed = motion->speed + kStandstillTuning.moving_sigma * motion->speed_sigma;
    rate = kStandstillTuning.moving_sigma * motion->rate_sigma;
  }
  const double depth_m = motion && motion->depth_m ? *motion->depth_m : kStandstillTuning.usual_depth_m;
  const double allowed = config_.window_s * (speed / depth_m + rate) + kStandstillTuning.max_image_motion;
  reason_ = fmt::format("features move {:.4f} rad, {:.4f} by motion that the IMU does not measure", *travel, allowed);
  return *travel < allowed;
}

/// Whether the images stand still whatever the IMU shows, as long as its mean rate is a bias, or by chance.
bool StandstillDetector::only_shakes(const Spread& spread) {
  return spread.covered_s >= kStandstillTuning.min_cover * config_.window_s &&
         spread.mean_gyro.norm() < kStandstillTuning.max_gyro_mean + spread.gyro && image_.median_travel() &&
         image_still();
}

bool StandstillDetector::image_still() {
  const std::optional<double> travel = image_.median_travel();
  if (!travel) {
    reason_ = fmt::format("{} of {} features to distinguish rest from uniform motion", image_.features(),
                          kStandstillTuning.min_features);
    return image_.events_quiet();
  }
  const ImageMotion::Common common = image_.common_travel();
  const double most = std::max(kStandstillTuning.max_common_motion, kStandstillTuning.common_sigmas * common.sigma);
  const bool together = common.travel > most;
  reason_ = fmt::format("features move {:.4f} of {:.4f} rad, together {:.4f} of {:.4f}", *travel,
                        kStandstillTuning.max_image_motion, common.travel, most);
  if (quiet_) return *travel <= (together ? 1.0 : kStandstillTuning.apart) * kStandstillTuning.max_image_motion;
  return *travel <= kStandstillTuning.max_image_motion && !together;
}

}  // namespace edged
