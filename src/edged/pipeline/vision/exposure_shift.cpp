// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/vision/exposure_shift.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "edged/core/statistics.hpp"
#include "edged/pipeline/tuning.hpp"

namespace edged {
namespace {

constexpr double kVariance_s2 = kPipelineTuning.exposure_prior_s * kPipelineTuning.exposure_prior_s;

/// How far the image is ahead of its prediction, as a time, and the speed of the features [1/s].
struct Lead {
  double seconds = 0.0, speed = 0.0;
};

/// By the faster half of the features with a landmark; nothing if there are few.
std::optional<Lead> lead_of(const std::vector<Track>& tracks, const TrackPrediction& prediction, double dt_s) {
  struct Feature {
    double speed, lead_s;
  };
  std::vector<Feature> features;
  for (const Track& track : tracks) {
    const std::optional<double> depth = track.age > 0 ? prediction.depth(track.id) : std::nullopt;
    if (!depth) continue;
    const Eigen::Vector3d p_C = prediction.T_cur_prev * (*depth * track.previous_point.homogeneous());
    if (p_C.z() <= 0.0) continue;
    const Eigen::Vector2d expected = p_C.hnormalized(), velocity = (expected - track.previous_point) / dt_s;
    const double squared = std::max(velocity.squaredNorm(), 1e-12);
    features.push_back({std::sqrt(squared), velocity.dot(track.point - expected) / squared});
  }
  if (features.size() < kPipelineTuning.exposure_min_features) return std::nullopt;
  std::vector<double> speeds, leads;
  for (const Feature& feature : features) speeds.push_back(feature.speed);
  const double speed = median(std::move(speeds));
  for (const Feature& feature : features)
    if (feature.speed >= speed) leads.push_back(feature.lead_s);
  return Lead{median(std::move(leads)), speed};
}

}  // namespace

void ExposureShift::update(double phase, Duration since_last, const std::vector<Track>& tracks,
                           const TrackPrediction& prediction) {
  const Eigen::Vector2d wave(std::cos(phase), std::sin(phase));
  since_last_s_ = std::max(to_seconds(since_last), 1e-3);
  if (!any_) information_ = Eigen::Matrix2d::Identity() / kVariance_s2;
  // The features of the image before were shifted, too.
  if (const auto lead = any_ ? lead_of(tracks, prediction, since_last_s_) : std::nullopt) {
    const Eigen::Vector2d change = wave - wave_;
    const double weight =
        lead->speed * lead->speed / (kPipelineTuning.exposure_motion_sigma * kPipelineTuning.exposure_motion_sigma);
    const double kept = std::exp(-since_last_s_ / kPipelineTuning.exposure_memory_s);
    const Eigen::Matrix2d prior = (1.0 - kept) * Eigen::Matrix2d::Identity() / kVariance_s2;
    information_ = kept * information_ + prior + weight * change * change.transpose();
    weighted_ = kept * weighted_ + weight * lead->seconds * change;
  }
  any_ = true;
  wave_ = wave;
  shift_s_ = wave.dot(information_.inverse() * weighted_);
  T_prev_cur_ = prediction.T_cur_prev.inverse();
  scene_depth_ = prediction.scene_depth;
}

void ExposureShift::correct(CameraObservations& observations, const std::vector<Track>& tracks) const {
  if (shift_s_ == 0.0) return;
  for (std::size_t i = 0; i < observations.features.size(); ++i) {
    Eigen::Vector2d& point = observations.features[i].point;
    // A new feature moves as the scene does at its mean depth.
    const Eigen::Vector2d before = tracks[i].age > 0
                                       ? tracks[i].previous_point
                                       : (T_prev_cur_ * (scene_depth_ * point.homogeneous())).hnormalized().eval();
    point -= shift_s_ / since_last_s_ * (point - before);
  }
}

}  // namespace edged
