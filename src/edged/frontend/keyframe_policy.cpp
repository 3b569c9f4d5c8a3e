// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// When an instant becomes a keyframe.
#include "edged/frontend/keyframe_policy.hpp"

#include "edged/core/angles.hpp"
#include "edged/core/statistics.hpp"
#include "edged/frontend/tuning.hpp"

namespace edged {

void KeyframeConfig::visit(ConfigFields& fields) {
  fields.add("min_tracked_share", min_tracked_share,
             {"1", 0, 1, "A keyframe is made when a smaller share of the last one's tracks is alive."});
  fields.add("parallax_deg", parallax_deg,
             {"deg", 0.01, 45, "A keyframe is made when the median parallax since the last one is larger."});
  fields.add("rotation_deg", rotation_deg,
             {"deg", 0.1, 180, "A keyframe is made when the camera has rotated more since the last one."});
  fields.add("min_tracks", min_tracks, {"", 0, 1000, "With fewer live tracks a keyframe detects new features."});
  fields.add("max_interval_s", max_interval_s,
             {"s", 0.01, 100, "A keyframe is made after this time, unless the camera stands still."});
}

bool keyframe_due(const SinceKeyframe& since, const KeyframeConfig& config) {
  if (!since.any) return true;
  const double age_s = to_seconds(since.time);
  if (age_s < kFrontendTuning.min_interval_s) return false;
  if (since.tracks.alive() < config.min_tracked_share * since.tracks.at_keyframe) return true;
  if (since.tracks.alive() < config.min_tracks && age_s > kFrontendTuning.starved_interval_s) return true;
  const double parallax = median(since.tracks.parallax_rad);
  if (parallax > config.parallax_deg * kDegree || since.rotation_rad > config.rotation_deg * kDegree) return true;
  // At standstill, keyframes by time would replace those with a baseline in the window.
  return age_s > config.max_interval_s && parallax > kFrontendTuning.still_parallax_deg * kDegree;
}

}  // namespace edged
