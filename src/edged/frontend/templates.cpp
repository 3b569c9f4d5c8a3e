// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/templates.hpp"

#include <utility>

namespace edged {
namespace {

constexpr double kFarthest_px = 1.0;  // from the result of the optical flow: farther away it is another corner
constexpr double kMinDepth_m = 0.05;

}  // namespace

void Templates::move(const SE3& T_cur_prev) {
  for (auto& [id, look] : looks_) look.T_cur_look = T_cur_prev * look.T_cur_look;
}

void Templates::take(const PatchView& view, std::span<const Track> tracks) {
  std::map<FeatureId, Look> looks;
  for (const Track& track : tracks) {
    const auto known = looks_.find(track.id);
    if (known != looks_.end() && known->second.fits) {
      looks.insert(looks_.extract(known));
    } else if (const std::optional<Patch> patch = cut_patch(view.image, {track.pixel})) {
      looks.emplace(track.id, Look{*patch, SE3(), PatchOutline(camera_, track.pixel, track.point),
                                   GradientPatch(view.increments, track.pixel)});
    }
  }
  looks_ = std::move(looks);
}

/// The patch as the camera sees it now, with the corner where it is.
std::optional<PatchPlace> Templates::place_of(const Look& look, const CornerMotion& corner) const {
  const double depth = (look.T_cur_look.inverse() * corner.p_C).z();
  if (!(depth > kMinDepth_m)) return std::nullopt;
  std::optional<PatchPlace> place = look.outline.seen_by(camera_, look.T_cur_look, depth);
  if (place) place->pixel = corner.pixel;
  return place;
}

std::optional<Eigen::Vector2d> Templates::align(FeatureId id, const PatchView& view, const CornerMotion& corner) const {
  const auto known = looks_.find(id);
  if (known == looks_.end()) return std::nullopt;
  const Look& look = known->second;
  const std::optional<PatchPlace> place = place_of(look, corner);
  if (!place) return std::nullopt;
  if (!view.increments.image.empty()) {
    if (const auto aligned = look.gradient.align(view.increments, *place, corner.moved, config_)) return aligned;
  }
  const std::optional<PatchMatch> match = match_patch(look.patch, view.image, corner.pixel, place->A, 0.0, config_);
  const bool near = match && (match->pixel - corner.pixel).norm() < kFarthest_px;
  return near ? std::optional(match->pixel) : std::nullopt;
}

void Templates::learn(FeatureId id, const PatchView& view, const CornerMotion& corner, bool confirmed) {
  const auto known = looks_.find(id);
  if (known == looks_.end() || view.increments.image.empty()) return;
  const std::optional<PatchPlace> place = place_of(known->second, corner);
  if (place) known->second.gradient.learn(view.increments, *place, corner.moved, confirmed);
}

void Templates::note(FeatureId id, bool fits) {
  const auto known = looks_.find(id);
  if (known != looks_.end()) known->second.fits = fits;
}

}  // namespace edged
