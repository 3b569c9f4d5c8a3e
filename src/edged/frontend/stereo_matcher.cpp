// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/stereo_matcher.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "edged/frontend/tuning.hpp"

namespace edged {
namespace {

constexpr double kMaxCandidates = 400.0, kFarthest_m = 1e3;  // bounds the time; beyond it all depths give one pixel

}  // namespace

void StereoConfig::visit(ConfigFields& fields) {
  fields.add(
      "enabled", enabled,
      {.effect = "Match features between cameras whose views overlap: they share landmarks. Not between events and "
                 "frames of one lens."});
  fields.add("max_epipolar_px", max_epipolar_px, {"px", 0.1, 50, "A match may be this far from the epipolar line."});
}

std::vector<PatchPlace> StereoMatcher::candidates(const PatchOutline& outline, std::optional<double> depth) const {
  const double nearest = depth ? *depth / kFrontendTuning.stereo_depth_factor : kFrontendTuning.stereo_nearest_m;
  const double farthest = depth ? *depth * kFrontendTuning.stereo_depth_factor : kFarthest_m;
  // Places are almost equally spaced in inverse depth. Near places may be out of view: the number is by the epipole.
  const double disparity_px =
      to_.camera.mean_focal() * T_to_from_.translation().norm() * (1.0 / nearest - 1.0 / farthest);
  const int steps =
      static_cast<int>(std::ceil(std::clamp(disparity_px / kFrontendTuning.stereo_step_px, 1.0, kMaxCandidates)));
  std::vector<PatchPlace> places;
  for (int i = 0; i <= steps; ++i) {
    const double inverse_depth = 1.0 / farthest + (1.0 / nearest - 1.0 / farthest) * i / steps;
    const std::optional<PatchPlace> place = outline.seen_by(to_.camera, T_to_from_, 1.0 / inverse_depth);
    if (place && to_.camera.contains(place->pixel)) places.push_back(*place);
  }
  return places;
}

/// The candidate that matches best; nothing where another place matches about as well.
std::optional<PatchPlace> StereoMatcher::search(const Patch& patch, const PatchOutline& outline,
                                                std::optional<double> depth) const {
  const std::vector<PatchPlace> places = candidates(outline, depth);
  const std::vector<double> fits = correlations(patch, to_.pixels, places);
  if (fits.empty()) return std::nullopt;
  const auto best = std::ranges::max_element(fits);
  if (*best < kFrontendTuning.min_candidate_correlation) return std::nullopt;
  double second = -1.0;
  for (auto fit = fits.begin(); fit != fits.end(); ++fit)
    if (std::abs(fit - best) > kFrontendTuning.same_candidate) second = std::max(second, *fit);
  if (std::max(1.0 - *best, kFrontendTuning.step_loss) > kFrontendTuning.max_ambiguity * (1.0 - second))
    return std::nullopt;
  return places[static_cast<std::size_t>(best - fits.begin())];
}

/// Whether the match, followed back, ends where it began.
bool StereoMatcher::returns(const Eigen::Vector2d& found, const PatchPlace& place,
                            const Eigen::Vector2d& feature) const {
  const std::optional<Patch> patch = cut_patch(to_.pixels, {found});
  if (!patch) return false;
  const auto back = match_patch(*patch, from_.pixels, feature, place.A.inverse(), 0.0, PatchConfig());
  return back && (back->pixel - feature).norm() < kFrontendTuning.max_return_px;
}

std::optional<Eigen::Vector2d> StereoMatcher::match(const Eigen::Vector2d& feature, std::optional<double> depth) const {
  const std::optional<Patch> patch = cut_patch(from_.pixels, {feature});
  if (!patch) return std::nullopt;
  const PatchOutline outline(from_.camera, feature);
  const std::optional<PatchPlace> place = search(*patch, outline, depth);
  if (!place) return std::nullopt;
  const auto match = match_patch(*patch, to_.pixels, place->pixel, place->A, config_.max_epipolar_px, PatchConfig());
  if (!match || !to_.camera.contains(match->pixel)) return std::nullopt;
  if (epipolar_px(outline.feature(), to_.camera.pixel_to_point(match->pixel)) > config_.max_epipolar_px)
    return std::nullopt;
  return returns(match->pixel, *place, feature) ? std::optional(match->pixel) : std::nullopt;
}

double StereoMatcher::epipolar_px(const Eigen::Vector2d& point_from, const Eigen::Vector2d& point_to) const {
  const Eigen::Vector3d ray = T_to_from_.R() * point_from.homogeneous();
  const Eigen::Vector3d line = T_to_from_.translation().cross(ray);
  const double slope = line.head<2>().norm();
  if (!(slope > 0.0)) return 0.0;  // at the epipole
  return to_.camera.mean_focal() * std::abs(line.dot(point_to.homogeneous())) / (slope * to_.camera.stretch(point_to));
}

}  // namespace edged
