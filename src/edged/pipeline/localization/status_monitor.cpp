// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/status_monitor.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/pipeline/tuning.hpp"

namespace edged {
void StatusConfig::visit(ConfigFields& fields) {
  fields.add("degraded_after_s", degraded_after_s,
             {"s", 0.05, 60, "The status is Degraded after this time without landmarks."});
  fields.add("lost_after_s", lost_after_s, {"s", 0.1, 600, "The status is Lost after this time without landmarks."});
  fields.add("min_landmarks", min_landmarks, {"", 3, 100, "A Good pose needs this many landmarks in view."});
  fields.add("degraded_strain", degraded_strain,
             {"sigma", 0.01, 1000,
              "The status is Degraded when the IMU residuals of the window exceed this: cameras and IMU disagree."});
  fields.add(
      "lost_strain", lost_strain,
      {"sigma", 0.01, 1000, "The status is Lost when they exceed this. The bound grows by half after each such loss."});
  fields.add("max_velocity_sigma", max_velocity_sigma,
             {"m/s", 0.01, 100,
              "The status is Degraded while the velocity is less certain than this and a tenth of the speed."});
  fields.add(
      "max_place_sigma", max_place_sigma,
      {"m", 0.01, 1000,
       "The status is Degraded while a gap or a loss leaves the position in the map less certain than this, until "
       "the body is relocalized."});
  fields.add("max_scale_sigma", max_scale_sigma,
             {"", 0.01, 10,
              "The status is Degraded while the way travelled is uncertain by more than this share: the motion is too "
              "gentle for the IMU."});
}

void StatusMonitor::set_lost(std::string reason) {
  reason_ = std::move(reason);
  contradicted_ = vision_lost_ = false;
}

/// How the cameras contradict the IMU, where it is too much to go on; empty else.
std::string StatusMonitor::contradiction(double imu_strain, double bias_change) {
  if (const double most = strain_limit_factor_ * config_.lost_strain; imu_strain > most) {
    strain_limit_factor_ *= kPipelineTuning.strain_limit_growth;
    return fmt::format(
        "the cameras contradict the IMU ({:.2f} of {:.2f} sigma; if always, the calibration is wrong or "
        "the IMU's noise set too low)",
        imu_strain, most);
  }
  if (bias_change <= kPipelineTuning.max_bias_change) return "";
  return fmt::format(
      "the cameras contradict the IMU, whose biases would have changed ({:.1f} of {:.1f} sigma; most features are on "
      "dynamic objects, or the calibration is wrong)",
      bias_change, kPipelineTuning.max_bias_change);
}

/// Where the velocity stays unknown, as after a gap whose tracks have ended, a new start finds it; empty else.
std::string StatusMonitor::unknown_motion(double velocity_sigma, Timestamp t) {
  if (velocity_sigma < kPipelineTuning.unknown_velocity || !velocity_known_) velocity_known_ = t;
  if (t - *velocity_known_ <= kPipelineTuning.velocity_unknown_after) return "";
  return fmt::format("velocity known to {:.1f} m/s only", velocity_sigma);
}

/// Why the estimate is not Good although it goes on; empty if it is.
std::string StatusMonitor::doubt(const EstimatorResult& result, const Uncertainty& uncertainty) const {
  if (result.provisional) return "the scale of the start is not certain yet";
  if (since_visual_update_s_ > config_.degraded_after_s)
    return fmt::format("no {} landmarks for {:.1f} s", config_.min_landmarks, since_visual_update_s_);
  if (const double most = strain_limit_factor_ * config_.degraded_strain; result.imu_strain > most)
    return fmt::format("cameras and IMU disagree ({:.2f} of {:.2f} sigma)", result.imu_strain, most);
  if (uncertainty.velocity_sigma > config_.max_velocity_sigma)
    return fmt::format("velocity known to {:.2f} m/s, {:.2f} required", uncertainty.velocity_sigma,
                       config_.max_velocity_sigma);
  if (uncertainty.place_sigma > config_.max_place_sigma)
    return fmt::format("position known to {:.2f} m since a gap or loss, {:.2f} required", uncertainty.place_sigma,
                       config_.max_place_sigma);
  if (const double sigma = uncertainty.scale_sigma.value_or(0.0); sigma > config_.max_scale_sigma)
    return fmt::format("motion too gentle for this IMU: scale known to {:.0f} %, {:.0f} % required",
                       100.0 * std::min(sigma, 9.99), 100.0 * config_.max_scale_sigma);
  return "";
}

TrackingStatus StatusMonitor::update(const EstimatorResult& result, const Uncertainty& uncertainty, bool started,
                                     Timestamp t) {
  if (!started) {
    last_supported_.reset();
    last_velocity_.reset();
    velocity_known_.reset();
    return ever_started_ ? TrackingStatus::Lost : TrackingStatus::Initializing;
  }
  ever_started_ = true;
  if (result.standstill || result.landmarks_seen >= config_.min_landmarks || !last_supported_) last_supported_ = t;
  if (result.velocity_observed) last_velocity_ = t;
  since_visual_update_s_ = to_seconds(t - *last_supported_);
  const double drifting_s =
      last_velocity_ ? std::min(since_visual_update_s_, to_seconds(t - *last_velocity_)) : since_visual_update_s_;
  reason_ = result.plausible ? contradiction(result.imu_strain, uncertainty.bias_change) : "the solution has diverged";
  contradicted_ = !reason_.empty();
  if (reason_.empty()) reason_ = unknown_motion(uncertainty.velocity_sigma, t);
  vision_lost_ = reason_.empty() && drifting_s > config_.lost_after_s;
  if (vision_lost_)
    reason_ = fmt::format("no {} landmarks for {:.1f} s", config_.min_landmarks, since_visual_update_s_);
  if (!reason_.empty()) return TrackingStatus::Lost;
  reason_ = doubt(result, uncertainty);
  return reason_.empty() ? TrackingStatus::Good : TrackingStatus::Degraded;
}

TrackingStatus StatusMonitor::update_in_map(TrackingStatus of_odometry, const std::string& unlocalized) {
  if (is_tracking(of_odometry)) {
    if (unlocalized.empty()) {
      ever_localized_ = true;
      return of_odometry;
    }
    set_lost(unlocalized);
  }
  return ever_localized_ ? TrackingStatus::Lost : TrackingStatus::Initializing;
}

}  // namespace edged
