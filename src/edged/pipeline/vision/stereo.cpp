// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/vision/stereo.hpp"

#include <algorithm>
#include <vector>

#include "edged/camera/field_of_view.hpp"
#include "edged/frontend/stereo_matcher.hpp"
#include "edged/pipeline/tuning.hpp"

namespace edged {
namespace {

const cv::Mat& image_for(const CameraImage& partner, const CameraImage& view) {
  const Modality modality = view.tracker->camera.modality;
  const bool translated = modality == Modality::Frames && partner.tracker->camera.modality == Modality::Events;
  return translated ? view.as_events : view.track;
}

StereoMatcher matcher_of(const CameraImage& from, const CameraImage& to, const ImuPropagator& body,
                         const StereoConfig& config) {
  const SE3 T_O_from = from.tracker->T_O_C(from.tracker->T_O_B_now(body));
  const SE3 T_O_to = to.tracker->T_O_C(to.tracker->T_O_B_now(body));
  return {{from.tracker->features->camera(), image_for(to, from)},
          {to.tracker->features->camera(), image_for(from, to)},
          T_O_to.inverse() * T_O_from,
          config};
}

}  // namespace

bool can_match(const CameraTracker& one, const CameraTracker& other, const StereoConfig& config) {
  if (!config.enabled) return false;
  if (one.camera.modality == other.camera.modality) return true;
  return one.only_one_of_its_kind && other.only_one_of_its_kind && have_baseline(one.camera, other.camera);
}

void match_across_cameras(const CameraImage& from, const CameraImage& to, const ImuPropagator& body,
                          const DepthOf& depth, int most, const StereoConfig& config) {
  if (!can_match(*from.tracker, *to.tracker, config)) return;
  const StereoMatcher matcher = matcher_of(from, to, body, config);
  FeatureTracker& there = *to.tracker->features;
  for (const Track& track : from.tracker->features->tracks()) {
    if (static_cast<int>(there.tracks().size()) >= most) return;
    if (there.find(track.id) != nullptr) continue;
    if (const auto pixel = matcher.match(track.pixel, depth(*from.tracker, track.id))) there.add(track.id, *pixel);
  }
}

void inflate_correlated(std::span<CameraObservations> observations, std::span<const CameraImage> views,
                        const StereoConfig& config) {
  for (std::size_t i = 0; i < views.size(); ++i) {
    const CameraTracker& tracker = *views[i].tracker;
    if (tracker.camera.modality != Modality::Events) continue;
    for (FeatureObservation& observation : observations[i].features) {
      if (std::ranges::any_of(views, [&](const CameraImage& other) {
            return other.tracker->camera.modality == Modality::Frames && can_match(tracker, *other.tracker, config) &&
                   other.tracker->features->find(observation.id) != nullptr;
          }))
        observation.sigma *= kPipelineTuning.correlated_sigma_factor;
    }
  }
}

void drop_mismatches(const CameraImage& from, const CameraImage& to, const ImuPropagator& body,
                     const StereoConfig& config) {
  if (!can_match(*from.tracker, *to.tracker, config)) return;
  const StereoMatcher matcher = matcher_of(from, to, body, config);
  std::vector<FeatureId> wrong;
  for (const Track& track : from.tracker->features->tracks()) {
    const Track* there = to.tracker->features->find(track.id);
    if (there == nullptr) continue;
    if (matcher.epipolar_px(track.point, there->point) >
        kPipelineTuning.followed_epipolar_factor * config.max_epipolar_px)
      wrong.push_back(track.id);
  }
  to.tracker->features->remove(wrong);
}

}  // namespace edged
