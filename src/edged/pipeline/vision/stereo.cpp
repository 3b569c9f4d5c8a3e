// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/vision/stereo.hpp"

#include <algorithm>
#include <vector>

#include "edged/camera/field_of_view.hpp"
#include "edged/frontend/stereo_matcher.hpp"

namespace edged {
namespace {

/// A match that is followed may be so much farther from the epipolar line than a new one.
constexpr double kFollowedSlack = 1.5;

/// Factor on the sigma of a feature in an event camera that a frame camera follows, too.
constexpr double kDiscount = 3.0;

const cv::Mat& image_for(const ChannelView& partner, const ChannelView& view) {
  const Modality modality = view.channel->camera.modality;
  const bool translated = modality == Modality::Frames && partner.channel->camera.modality == Modality::Events;
  return translated ? view.as_events : view.track;
}

StereoMatcher matcher_of(const ChannelView& from, const ChannelView& to, const BodyMotion& body,
                         const StereoConfig& config) {
  const SE3 T_O_from = from.channel->T_O_C(from.channel->T_O_B_now(body));
  const SE3 T_O_to = to.channel->T_O_C(to.channel->T_O_B_now(body));
  return {{from.channel->tracker.camera(), image_for(to, from)},
          {to.channel->tracker.camera(), image_for(from, to)},
          T_O_to.inverse() * T_O_from,
          config};
}

}  // namespace

bool can_share(const Channel& one, const Channel& other, const StereoConfig& config) {
  if (!config.enabled) return false;
  if (one.camera.modality == other.camera.modality) return true;
  return one.only_one_of_its_kind && other.only_one_of_its_kind && have_baseline(one.camera, other.camera);
}

void share_features(const ChannelView& from, const ChannelView& to, const BodyMotion& body, const DepthOf& depth,
                    int most, const StereoConfig& config) {
  if (!can_share(*from.channel, *to.channel, config)) return;
  const StereoMatcher matcher = matcher_of(from, to, body, config);
  FeatureTracker& there = to.channel->tracker;
  for (const Track& track : from.channel->tracker.tracks()) {
    if (static_cast<int>(there.tracks().size()) >= most) return;
    if (there.find(track.id) != nullptr) continue;
    if (const auto pixel = matcher.match(track.pixel, depth(*from.channel, track.id))) there.adopt(track.id, *pixel);
  }
}

void discount_shared(std::span<CameraObservations> observations, std::span<const ChannelView> views,
                     const StereoConfig& config) {
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Channel& channel = *views[i].channel;
    if (channel.camera.modality != Modality::Events) continue;
    for (FeatureObservation& observation : observations[i].features) {
      if (std::ranges::any_of(views, [&](const ChannelView& other) {
            return other.channel->camera.modality == Modality::Frames && can_share(channel, *other.channel, config) &&
                   other.channel->tracker.find(observation.id) != nullptr;
          }))
        observation.sigma *= kDiscount;
    }
  }
}

void drop_mismatches(const ChannelView& from, const ChannelView& to, const BodyMotion& body,
                     const StereoConfig& config) {
  if (!can_share(*from.channel, *to.channel, config)) return;
  const StereoMatcher matcher = matcher_of(from, to, body, config);
  std::vector<FeatureId> wrong;
  for (const Track& track : from.channel->tracker.tracks()) {
    const Track* there = to.channel->tracker.find(track.id);
    if (there == nullptr) continue;
    if (matcher.epipolar_px(track.point, there->point) > kFollowedSlack * config.max_epipolar_px)
      wrong.push_back(track.id);
  }
  to.channel->tracker.remove(wrong);
}

}  // namespace edged
