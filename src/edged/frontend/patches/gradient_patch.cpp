// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/patches/gradient_patch.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "edged/frontend/tuning.hpp"

namespace edged {
namespace {

constexpr float kNone = 128.0F;  // grey level of no increment

/// How far the events of an edge are behind it along its motion.
Eigen::Vector2d behind(const Eigen::Vector2d& moved) {
  return kFrontendTuning.event_lag_px / std::max(moved.norm(), 0.3) * moved;
}

}  // namespace

GradientPatch::GradientPatch(const BrightnessIncrements& seen, const Eigen::Vector2d& feature)
    : first_(seen.image.empty() ? std::nullopt : cut_patch(seen.image, {feature})) {}

std::optional<Eigen::Vector2d> GradientPatch::align(const BrightnessIncrements& seen, const PatchPlace& place,
                                                    const Eigen::Vector2d& moved, const PatchConfig& config) const {
  const Eigen::Vector2d of_patch = seen.share * (place.A.inverse() * moved);
  if (!spans(of_patch)) return std::nullopt;
  PatchConfig strict = config;
  strict.min_similarity = PatchConfig().min_similarity;
  const Eigen::Vector2d ahead = behind(moved) - place.A * behind_;
  const std::optional<PatchMatch> match =
      match_patch(expected(of_patch), seen.image, place.pixel - ahead, place.A, 0.0, strict);
  if (!match) return std::nullopt;
  const Eigen::Vector2d feature = match->pixel + ahead;
  return (feature - place.pixel).norm() < kFrontendTuning.max_feature_shift_px ? std::optional(feature) : std::nullopt;
}

void GradientPatch::learn(const BrightnessIncrements& seen, const PatchPlace& place, const Eigen::Vector2d& moved,
                          bool confirmed) {
  const Eigen::Vector2d of_patch = seen.share * (place.A.inverse() * moved);
  if (first_) {
    behind_ = place.A.inverse() * behind(moved);
    add(*first_, of_patch);
    first_.reset();
  }
  if (!confirmed && spans(of_patch)) return;
  const Eigen::Vector2d ahead = behind(moved) - place.A * behind_;
  if (const auto increments = cut_patch(seen.image, {place.pixel - ahead, place.A})) add(*increments, of_patch);
}

void GradientPatch::add(const Patch& increments, const Eigen::Vector2d& moved) {
  squares_ += moved * moved.transpose();
  const Eigen::Vector2f m = moved.cast<float>();
  for (int i = 0; i < kPixels; ++i) products_.col(i) += m * (static_cast<float>(increments.pixels[i]) - kNone);
}

Eigen::Vector2d GradientPatch::weights(const Eigen::Vector2d& moved) const {
  return (squares_ + kFrontendTuning.gradient_noise_px2 * Eigen::Matrix2d::Identity()).inverse() * moved;
}

bool GradientPatch::spans(const Eigen::Vector2d& moved) const {
  return weights(moved).dot(squares_ * moved) > kFrontendTuning.min_explained_share * moved.squaredNorm();
}

// To first order an increment is the gradient of the log brightness times the negative motion (Gehrig et al., EKLT:
// Asynchronous Photometric Feature Tracking using Events and Frames, 2020, Eq. 2), over the threshold.
Patch GradientPatch::expected(const Eigen::Vector2d& moved) const {
  const Eigen::Matrix<float, 1, kPixels> increments = weights(moved).cast<float>().transpose() * products_;
  const float gain = 127.0F / std::max(1.0F, increments.cwiseAbs().maxCoeff());
  Patch patch;
  for (int i = 0; i < kPixels; ++i)
    patch.pixels[i] = static_cast<std::uint8_t>(std::lround(kNone + gain * increments[i]));
  return patch;
}

}  // namespace edged
