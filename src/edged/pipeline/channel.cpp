// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/channel.hpp"

namespace edged {

void Channel::show(const cv::Mat& image, const cv::Mat& corners) {
  image_ = image;
  corners_ = corners;
}

Eigen::Matrix3d Channel::since_keyframe(const SE3& T_W_B) const {
  const Eigen::Quaterniond R_Bkf_B = T_W_Bkeyframe.rotation().conjugate() * T_W_B.rotation();
  const Eigen::Matrix3d R_B_C = camera.T_B_C.R();
  return R_B_C.transpose() * R_Bkf_B.toRotationMatrix() * R_B_C;
}

void Channel::track(Timestamp t, const SE3& T_W_B, double scene_depth,
                    const std::function<std::optional<double>(FeatureId)>& depth) {
  std::optional<TrackPrediction> prediction;
  if (any_image_) {
    const SE3 T_cur_prev = T_W_C(T_W_B).inverse() * T_W_C(T_W_Blast);
    prediction = TrackPrediction{T_cur_prev, scene_depth, depth, alignment_px_};
  }
  align(tracker.track(image_, t, prediction));
  any_image_ = true;
}

void Channel::align(const TrackSummary& summary) {
  if (alignment_.gain <= 0.0) return;
  // Without a usable prediction the old correction fades.
  const bool measured = summary.tracked > 0 && !summary.prediction_failed;
  const Eigen::Vector2d newest =
      measured ? Eigen::Vector2d(summary.median_innovation_px + alignment_px_) : Eigen::Vector2d::Zero();
  alignment_px_ += alignment_.gain * (newest - alignment_px_);
  const double length = alignment_px_.norm();
  if (length > alignment_.max_px) alignment_px_ *= alignment_.max_px / length;
}

void Channel::reject(const SE3& T_W_B, bool trust_gyro) {
  const auto rotation = trust_gyro ? std::optional(since_keyframe(T_W_B)) : std::nullopt;
  tracker.reject_outliers(FeatureTracker::Reference::Keyframe, rotation);
}

void Channel::mark_keyframe(const SE3& T_W_B, FeatureId& next_feature) {
  tracker.detect(corners_, next_feature);
  tracker.mark_keyframe();
  T_W_Bkeyframe = T_W_B;
}

void Channel::settle(const SE3& T_W_B, bool keyframe) {
  T_W_Blast = T_W_B;
  if (keyframe) T_W_Bkeyframe = T_W_B;
}

void Channel::move(const SE3& T_new_old) {
  T_W_Blast = T_new_old * T_W_Blast;
  T_W_Bkeyframe = T_new_old * T_W_Bkeyframe;
}

}  // namespace edged
