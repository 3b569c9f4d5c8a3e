// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/vision/camera_tracker.hpp"

#include <cmath>

#include "edged/pipeline/tuning.hpp"

namespace edged {

void HealthConfig::visit(ConfigFields& fields) {
  fields.add("time_constant_s", time_constant_s,
             {"s", 0.01, 100, "Time constant of the running mean of the track survival rate."});
  fields.add("min_survival_rate", min_survival_rate,
             {"", 0, 1, "A camera's observations are ignored below this track survival rate."});
  fields.add(
      "min_event_features", min_event_features,
      {"", 0, 1000, "Number of features kept in event frames while the frames have all of theirs (fused mode)."});
}

Eigen::Matrix3d CameraTracker::since_keyframe(const SE3& T_O_B) const {
  const Eigen::Quaterniond R_Bkf_B = T_O_Bkeyframe.rotation().conjugate() * T_O_B.rotation();
  const Eigen::Matrix3d R_B_C = camera.T_B_C.R();
  return R_B_C.transpose() * R_Bkf_B.toRotationMatrix() * R_B_C;
}

void CameraTracker::track(const cv::Mat& image, Timestamp t, const SE3& T_O_B, TrackPrediction prediction,
                          const std::optional<LampCycle>& lamp) {
  prediction.T_cur_prev = T_O_C(T_O_B).inverse() * T_O_C(T_O_Blast);
  prediction.offset_px = alignment_px_;
  const TrackSummary summary = features->track(image, t, any_image_ ? std::optional(prediction) : std::nullopt);
  if (any_image_ && lamp) {
    shift_.update(lamp->phase(t), t - last_image_, features->tracks(), prediction);
  } else {
    shift_.reset();
  }
  align(summary);
  update_survival_rate(summary, t);
  any_image_ = true;
}

void CameraTracker::align(const TrackSummary& summary) {
  if (alignment_.gain <= 0.0) return;
  // Without a usable prediction the old correction decays.
  const bool measured = summary.tracked > 0 && !summary.prediction_failed;
  const Eigen::Vector2d newest =
      measured ? Eigen::Vector2d(summary.median_innovation_px + alignment_px_) : Eigen::Vector2d::Zero();
  alignment_px_ += alignment_.gain * (newest - alignment_px_);
  const double length = alignment_px_.norm();
  if (length > kPipelineTuning.max_alignment_px) alignment_px_ *= kPipelineTuning.max_alignment_px / length;
}

void CameraTracker::update_survival_rate(const TrackSummary& summary, Timestamp t) {
  if (any_image_ && summary.before > 0) {
    const double share = static_cast<double>(summary.tracked) / summary.before;
    const double gain = 1.0 - std::exp(-to_seconds(t - last_image_) / health_.time_constant_s);
    survival_rate_ += gain * (share - survival_rate_);
  }
  last_image_ = t;
}

CameraObservations CameraTracker::observations() const {
  CameraObservations observations = features->observations();
  shift_.correct(observations, features->tracks());
  if (survival_rate_ < health_.min_survival_rate) observations.features.clear();
  for (FeatureObservation& observation : observations.features) observation.sigma /= survival_rate_;
  return observations;
}

void CameraTracker::reject(const SE3& T_O_B, bool trust_gyro) const {
  const auto rotation = trust_gyro ? std::optional(since_keyframe(T_O_B)) : std::nullopt;
  features->reject_outliers(FeatureTracker::Reference::Keyframe, rotation);
}

void CameraTracker::mark_keyframe(const SE3& T_O_B) {
  features->mark_keyframe();
  T_O_Bkeyframe = T_O_B;
}

void CameraTracker::set_pose(const SE3& T_O_B, bool keyframe) {
  T_O_Blast = T_O_B;
  if (keyframe) T_O_Bkeyframe = T_O_B;
}

void CameraTracker::move(const SE3& T_new_old) {
  T_O_Blast = T_new_old * T_O_Blast;
  T_O_Bkeyframe = T_new_old * T_O_Bkeyframe;
}

const CameraTracker* leading_tracker(std::span<const CameraImage> views) {
  const CameraTracker* leading = nullptr;
  for (const CameraImage& view : views) {
    if (leading == nullptr || view.tracker->effective_tracks() >= leading->effective_tracks()) leading = view.tracker;
  }
  return leading;
}

}  // namespace edged
