// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/stereo_matcher.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace edged {
namespace {

constexpr double kStep_px = 1.5;  // between candidates: the correlation of a corner falls within two pixels
constexpr double kMostCandidates = 400.0;
constexpr double kFarthest_m = 1e3;        // beyond it all depths give one pixel
constexpr double kDepthSlack = 1.3;        // factor on a known depth, both ways
constexpr double kLeastAtCandidate = 0.5;  // correlation, up to half a step beside the match
constexpr int kSamePlace = 3;              // [candidates] from the best one: farther away it is another place
constexpr double kDistinct = 0.7;          // the best must lack less than this share of what the second best lacks
constexpr double kBetween = 0.1;           // what a perfect match may lack between two candidates
constexpr double kReturn_px = 0.5;

}  // namespace

void StereoConfig::visit(ConfigFields& fields) {
  fields.add(
      "enabled", enabled,
      {.effect = "Match features between cameras whose views overlap: they share landmarks. Not between events and "
                 "frames of one lens."});
  fields.add("max_epipolar_px", max_epipolar_px,
             {.unit = "px", .min = 0.1, .max = 50, .effect = "A match may be this far from the epipolar line."});
}

std::vector<PatchPlace> StereoMatcher::candidates(const PatchOutline& outline, std::optional<double> depth) const {
  const double nearest = depth ? *depth / kDepthSlack : config_.nearest_m;
  const double farthest = depth ? *depth * kDepthSlack : kFarthest_m;
  // Places are almost equally spaced in inverse depth. Near places may be out of view: the number is by the epipole.
  const double disparity_px =
      to_.camera.mean_focal() * T_to_from_.translation().norm() * (1.0 / nearest - 1.0 / farthest);
  const int steps = static_cast<int>(std::ceil(std::clamp(disparity_px / kStep_px, 1.0, kMostCandidates)));
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
  if (*best < kLeastAtCandidate) return std::nullopt;
  double second = -1.0;
  for (auto fit = fits.begin(); fit != fits.end(); ++fit)
    if (std::abs(fit - best) > kSamePlace) second = std::max(second, *fit);
  if (std::max(1.0 - *best, kBetween) > kDistinct * (1.0 - second)) return std::nullopt;
  return places[static_cast<std::size_t>(best - fits.begin())];
}

/// Whether the match, followed back, ends where it began.
bool StereoMatcher::returns(const Eigen::Vector2d& found, const PatchPlace& place,
                            const Eigen::Vector2d& corner) const {
  const std::optional<Patch> patch = cut_patch(to_.pixels, {found});
  if (!patch) return false;
  const auto back = match_patch(*patch, from_.pixels, corner, place.A.inverse(), 0.0, config_.patch);
  return back && (back->pixel - corner).norm() < kReturn_px;
}

std::optional<Eigen::Vector2d> StereoMatcher::match(const Eigen::Vector2d& corner, std::optional<double> depth) const {
  const std::optional<Patch> patch = cut_patch(from_.pixels, {corner});
  if (!patch) return std::nullopt;
  const PatchOutline outline(from_.camera, corner);
  const std::optional<PatchPlace> place = search(*patch, outline, depth);
  if (!place) return std::nullopt;
  const auto match = match_patch(*patch, to_.pixels, place->pixel, place->A, config_.max_epipolar_px, config_.patch);
  if (!match || !to_.camera.contains(match->pixel)) return std::nullopt;
  if (epipolar_px(outline.corner(), to_.camera.pixel_to_point(match->pixel)) > config_.max_epipolar_px)
    return std::nullopt;
  return returns(match->pixel, *place, corner) ? std::optional(match->pixel) : std::nullopt;
}

double StereoMatcher::epipolar_px(const Eigen::Vector2d& point_from, const Eigen::Vector2d& point_to) const {
  const Eigen::Vector3d ray = T_to_from_.R() * point_from.homogeneous();
  const Eigen::Vector3d line = T_to_from_.translation().cross(ray);
  const double slope = line.head<2>().norm();
  if (!(slope > 0.0)) return 0.0;  // at the epipole
  return to_.camera.mean_focal() * std::abs(line.dot(point_to.homogeneous())) / (slope * to_.camera.stretch(point_to));
}

}  // namespace edged
