// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/templates.hpp"

#include <Eigen/LU>
#include <utility>

namespace edged {
namespace {

constexpr double kNeighbour_px = 4.0;
constexpr double kFarthest_px = 1.0;  // from the result of the optical flow: farther away it is another corner
constexpr double kLeastArea = 0.4,
                 kMostArea =
                     2.5;  // contrast of the patch in the image over that of the reference patch: less is not enough
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
      const Eigen::Vector2d right(kNeighbour_px, 0.0), below(0.0, kNeighbour_px);
      looks.emplace(track.id, Look{*patch, SE3(), track.point, camera_.pixel_to_point(track.pixel + right),
                                   camera_.pixel_to_point(track.pixel + below)});
    }
  }
  looks_ = std::move(looks);
}

std::optional<Eigen::Vector2d> Templates::align(FeatureId id, const cv::Mat& image, const Eigen::Vector2d& pixel,
                                                const Eigen::Vector3d& p_C) const {
  const auto known = looks_.find(id);
  if (known == looks_.end()) return std::nullopt;
  const Look& look = known->second;
  const std::optional<Eigen::Matrix2d> A = warp(look, p_C);
  const std::optional<PatchMatch> match = A ? match_patch(look.patch, image, pixel, *A, 0.0, config_) : std::nullopt;
  const bool near = match && (match->pixel - pixel).norm() < kFarthest_px;
  return near ? std::optional(match->pixel) : std::nullopt;
}

void Templates::note(FeatureId id, bool fits) {
  const auto known = looks_.find(id);
  if (known != looks_.end()) known->second.fits = fits;
}

/// Pixels of the newest image by pixels of the patch; nothing if the scales differ too much.
std::optional<Eigen::Matrix2d> Templates::warp(const Look& look, const Eigen::Vector3d& p_C) const {
  const double depth = (look.T_cur_look.inverse() * p_C).z();
  if (!(depth > kMinDepth_m)) return std::nullopt;
  const auto seen = [&](const Eigen::Vector2d& point) {
    return camera_.project(look.T_cur_look * (depth * point.homogeneous()));
  };
  const std::optional<Eigen::Vector2d> corner = seen(look.corner), right = seen(look.right), below = seen(look.below);
  if (!corner || !right || !below) return std::nullopt;
  Eigen::Matrix2d A;
  A << (*right - *corner) / kNeighbour_px, (*below - *corner) / kNeighbour_px;
  const double area = A.determinant();
  return area > kLeastArea && area < kMostArea ? std::optional(A) : std::nullopt;
}

}  // namespace edged
