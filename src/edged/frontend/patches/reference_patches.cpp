// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/patches/reference_patches.hpp"

#include <utility>

#include "edged/frontend/tuning.hpp"

namespace edged {
void ReferencePatches::move(const SE3& T_cur_prev) {
  for (auto& [id, reference] : references_) reference.T_cur_ref = T_cur_prev * reference.T_cur_ref;
}

void ReferencePatches::extract(const PatchView& view, std::span<const Track> tracks) {
  std::map<FeatureId, Reference> references;
  for (const Track& track : tracks) {
    const auto known = references_.find(track.id);
    if (known != references_.end() && known->second.fits) {
      references.insert(references_.extract(known));
    } else if (const std::optional<Patch> patch = cut_patch(view.image, {track.pixel})) {
      references.emplace(track.id, Reference{*patch, SE3(), PatchOutline(camera_, track.pixel, track.point),
                                             GradientPatch(view.increments, track.pixel)});
    }
  }
  references_ = std::move(references);
}

/// The patch as the camera sees it now, with the feature where it is.
std::optional<PatchPlace> ReferencePatches::place_of(const Reference& reference, const FeatureMotion& feature) const {
  const double depth = (reference.T_cur_ref.inverse() * feature.p_C).z();
  if (!(depth > kFrontendTuning.min_depth_m)) return std::nullopt;
  std::optional<PatchPlace> place = reference.outline.seen_by(camera_, reference.T_cur_ref, depth);
  if (place) place->pixel = feature.pixel;
  return place;
}

std::optional<Eigen::Vector2d> ReferencePatches::align(FeatureId id, const PatchView& view,
                                                       const FeatureMotion& feature) const {
  const auto known = references_.find(id);
  if (known == references_.end()) return std::nullopt;
  const Reference& reference = known->second;
  const std::optional<PatchPlace> place = place_of(reference, feature);
  if (!place) return std::nullopt;
  if (!view.increments.image.empty()) {
    if (const auto aligned = reference.gradient.align(view.increments, *place, feature.moved, config_)) return aligned;
  }
  const std::optional<PatchMatch> match =
      match_patch(reference.patch, view.image, feature.pixel, place->A, 0.0, config_);
  const bool near = match && (match->pixel - feature.pixel).norm() < kFrontendTuning.max_feature_shift_px;
  return near ? std::optional(match->pixel) : std::nullopt;
}

void ReferencePatches::update_gradient(FeatureId id, const PatchView& view, const FeatureMotion& feature,
                                       bool confirmed) {
  const auto known = references_.find(id);
  if (known == references_.end() || view.increments.image.empty()) return;
  const std::optional<PatchPlace> place = place_of(known->second, feature);
  if (place) known->second.gradient.learn(view.increments, *place, feature.moved, confirmed);
}

void ReferencePatches::set_fits(FeatureId id, bool fits) {
  const auto known = references_.find(id);
  if (known != references_.end()) known->second.fits = fits;
}

}  // namespace edged
