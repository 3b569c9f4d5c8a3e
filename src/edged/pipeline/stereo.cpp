// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/stereo.hpp"

#include <algorithm>
#include <vector>

#include "edged/frontend/stereo_matcher.hpp"

namespace edged {
namespace {

/// A match that is followed may be so much farther from the epipolar line than a new one.
constexpr double kFollowedSlack = 1.5;

bool comparable(const ChannelView& one, const ChannelView& other, const StereoConfig& config) {
  return config.enabled && one.channel->camera.modality == other.channel->camera.modality;
}

StereoMatcher matcher_of(const ChannelView& from, const ChannelView& to, const BodyMotion& body,
                         const StereoConfig& config) {
  const SE3 T_O_from = from.channel->T_O_C(from.channel->T_O_B_now(body));
  const SE3 T_O_to = to.channel->T_O_C(to.channel->T_O_B_now(body));
  return {{from.channel->tracker.camera(), from.track},
          {to.channel->tracker.camera(), to.track},
          T_O_to.inverse() * T_O_from,
          config};
}

}  // namespace

void share_features(const ChannelView& from, const ChannelView& to, const BodyMotion& body, const DepthOf& depth,
                    int most, const StereoConfig& config) {
  if (!comparable(from, to, config)) return;
  const StereoMatcher matcher = matcher_of(from, to, body, config);
  FeatureTracker& there = to.channel->tracker;
  for (const Track& track : from.channel->tracker.tracks()) {
    if (static_cast<int>(there.tracks().size()) >= most) return;
    if (there.find(track.id) != nullptr) continue;
    if (const auto pixel = matcher.match(track.pixel, depth(*from.channel, track.id))) there.adopt(track.id, *pixel);
  }
}

void drop_mismatches(const ChannelView& from, const ChannelView& to, const BodyMotion& body,
                     const StereoConfig& config) {
  if (!comparable(from, to, config)) return;
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
