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

void Templates::take(const cv::Mat& image, std::span<const Track> tracks) {
  std::map<FeatureId, Look> looks;
  for (const Track& track : tracks) {
    const auto known = looks_.find(track.id);
    if (known != looks_.end() && known->second.fits) {
      looks.insert(looks_.extract(known));
    } else if (const std::optional<Patch> patch = cut_patch(image, track.pixel)) {
      looks.emplace(track.id, Look{*patch, SE3(), PatchOutline(camera_, track.pixel, track.point)});
    }
  }
  looks_ = std::move(looks);
}

std::optional<Eigen::Vector2d> Templates::align(FeatureId id, const cv::Mat& image, const Eigen::Vector2d& pixel,
                                                const Eigen::Vector3d& p_C) const {
  const auto known = looks_.find(id);
  if (known == looks_.end()) return std::nullopt;
  const Look& look = known->second;
  const double depth = (look.T_cur_look.inverse() * p_C).z();
  if (!(depth > kMinDepth_m)) return std::nullopt;
  const std::optional<PatchPlace> place = look.outline.seen_by(camera_, look.T_cur_look, depth);
  const std::optional<PatchMatch> match =
      place ? match_patch(look.patch, image, pixel, place->A, 0.0, config_) : std::nullopt;
  const bool near = match && (match->pixel - pixel).norm() < kFarthest_px;
  return near ? std::optional(match->pixel) : std::nullopt;
}

void Templates::note(FeatureId id, bool fits) {
  const auto known = looks_.find(id);
  if (known != looks_.end()) known->second.fits = fits;
}

}  // namespace edged
