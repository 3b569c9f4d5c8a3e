// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// When an instant becomes a keyframe.
#include "edged/frontend/keyframe_policy.hpp"

#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"

namespace edged {

void KeyframeConfig::visit(ConfigFields& fields) {
  fields.add("min_tracked_share", min_tracked_share,
             {.unit = "1",
              .min = 0,
              .max = 1,
              .effect = "A keyframe is made when a smaller share of the last one's tracks is alive."});
  fields.add("parallax_deg", parallax_deg,
             {.unit = "deg",
              .min = 0.01,
              .max = 45,
              .effect = "A keyframe is made when the median parallax since the last one is larger."});
  fields.add("rotation_deg", rotation_deg,
             {.unit = "deg",
              .min = 0.1,
              .max = 180,
              .effect = "A keyframe is made when the camera has rotated more since the last one."});
  fields.add("min_tracks", min_tracks,
             {.min = 0, .max = 1000, .effect = "With fewer live tracks a keyframe detects new features."});
  fields.add("max_interval_s", max_interval_s,
             {.unit = "s",
              .min = 0.01,
              .max = 100,
              .effect = "A keyframe is made after this time, unless the camera stands still."});
}

KeyframeReason keyframe_reason(const SinceKeyframe& since, const KeyframeConfig& config) {
  if (!since.any) return KeyframeReason::First;
  const double age_s = to_seconds(since.time);
  if (age_s < config.min_interval_s) return KeyframeReason::None;
  if (since.tracks.alive() < config.min_tracked_share * since.tracks.at_keyframe) return KeyframeReason::FewTracks;
  if (since.tracks.alive() < config.min_tracks && age_s > config.starved_interval_s) return KeyframeReason::FewTracks;
  const double parallax = median(since.tracks.parallax_rad);
  if (parallax > config.parallax_deg * kDegree) return KeyframeReason::Parallax;
  if (since.rotation_rad > config.rotation_deg * kDegree) return KeyframeReason::Rotation;
  // At standstill, keyframes by time would replace those with a baseline in the window.
  if (age_s > config.max_interval_s && parallax > config.still_parallax_deg * kDegree) return KeyframeReason::Time;
  return KeyframeReason::None;
}

std::string to_string(KeyframeReason reason) {
  switch (reason) {
    case KeyframeReason::None:
      return "none";
    case KeyframeReason::First:
      return "first";
    case KeyframeReason::FewTracks:
      return "few tracks";
    case KeyframeReason::Parallax:
      return "parallax";
    case KeyframeReason::Rotation:
      return "rotation";
    case KeyframeReason::Time:
      return "time";
  }
  EDGED_CHECK(false, "reason {}", static_cast<int>(reason));
}

}  // namespace edged
