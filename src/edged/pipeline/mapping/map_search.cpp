// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/mapping/map_search.hpp"

#include <algorithm>
#include <cstdint>

#include "edged/map/tuning.hpp"

namespace edged {
namespace {

/// The points that should be in view of that image, and their matches; nothing if too few of them match, as when the
/// lens is covered.
std::vector<Candidate> search_in(const TrackedImage& image, KeyframeMap& map, MapFilter& filter,
                                 const MapConfig& config, const SE3& T_M_C, const SE3& T_B_C, TimeInterval created) {
  const CameraModel& camera = image.model;
  std::vector<Candidate> candidates =
      map.visible({image.camera, created, filter.keyframes()}, T_M_C, camera, config.max_observations);
  std::vector<std::uint32_t> in_view;
  in_view.reserve(candidates.size());
  for (const Candidate& candidate : candidates) in_view.push_back(candidate.observation.keyframe);
  filter.activate(in_view);
  for (Candidate& candidate : candidates) {
    MapObservation& observation = candidate.observation;
    observation.seen = camera.pixel_to_point(candidate.pixel);
    const double stretch = camera.stretch(observation.seen);
    observation.sigma = config.filter.pixel_sigma / camera.mean_focal() * stretch;
    const double expected_px =
        kMapTuning.gate_sigmas * camera.mean_focal() / stretch * filter.expected_error(observation, T_B_C);
    const double radius = std::clamp(expected_px, kMapTuning.min_search_px, config.search_px);
    const auto match =
        match_patch(candidate.point->patch, image.image, candidate.pixel, candidate.A, radius, config.patch);
    candidate.matched = match.has_value();
    if (!match) continue;
    candidate.pixel = match->pixel;
    observation.seen = camera.pixel_to_point(match->pixel);
  }
  if (static_cast<double>(std::ranges::count_if(candidates, &Candidate::matched)) <
      config.filter.min_found_share * static_cast<double>(candidates.size()))
    candidates.clear();
  return candidates;
}

}  // namespace

std::vector<MapObservation> MapSearch::observations() const {
  std::vector<MapObservation> observations;
  for (const Candidate& candidate : candidates) {
    if (candidate.matched) observations.push_back(candidate.observation);
  }
  return observations;
}

std::ptrdiff_t MapSearch::matched_before(const KeyframeMap& map, Timestamp t) const {
  return std::ranges::count_if(candidates, [&](const Candidate& candidate) {
    return candidate.matched && map.keyframes()[candidate.observation.keyframe].t < t;
  });
}

MapSearch search_map(KeyframeMap& map, MapFilter& filter, const MapConfig& config, const SE3& T_M_O,
                     std::span<const PosedImage> images, TimeInterval created) {
  MapSearch search;
  for (const auto& [image, T_O_C] : images) {
    const auto camera = static_cast<std::uint32_t>(search.T_B_C.size());
    search.T_B_C.push_back(filter.T_M_B().inverse() * T_M_O * T_O_C);
    for (Candidate& candidate : search_in(image, map, filter, config, T_M_O * T_O_C, search.T_B_C.back(), created)) {
      candidate.observation.camera = camera;
      search.candidates.push_back(candidate);
    }
  }
  return search;
}

ImageFeatures features_of(const PosedImage& posed) {
  const auto& [image, T_O_C] = posed;
  ImageFeatures features;
  std::vector<Eigen::Vector2d> pixels;
  for (const Track& track : image.tracks) {
    pixels.push_back(track.pixel);
    features.points.push_back(image.model.pixel_to_point(track.pixel));
  }
  features.descriptors =
      describe(image.image, pixels, features.points, T_O_C.R().transpose() * Eigen::Vector3d::UnitZ());
  return features;
}

Recognition recognize_place(const KeyframeMap& map, const MapQuery& query, const ImageFeatures& features,
                            const PosedImage& posed) {
  return map.recognize(query, features.descriptors, features.points, posed.T_O_C.rotation(),
                       posed.image.model.mean_focal());
}

MapFilter filter_at(const MapFilter& filter, const SE3& T_M_O, const SE3& T_O_B, Timestamp t) {
  MapFilter there = filter;
  there.restart(T_M_O, T_O_B, t, kMapTuning.same_place_m, kMapTuning.same_place_rad, filter.tilt_sigma());
  return there;
}

}  // namespace edged
