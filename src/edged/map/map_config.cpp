// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/options/map.hpp"

namespace edged {

void KeyframeMapConfig::visit(ConfigFields& fields) {
  fields.add("min_interval_s", min_interval_s, {"s", 0, 100, "between keyframes that the map keeps"});
  fields.add("max_covered", max_covered,
             {"", 0, 1, "a keyframe is let go when the map already shows a greater share of its view"});
  fields.add("min_points", min_points, {"", 4, 1000, "a keyframe with fewer well-placed points is let go"});
  fields.add("max_points", max_points, {"", 4, 1000, "points kept of a keyframe"});
  fields.add("max_depth_error", max_depth_error,
             {"", 0.001, 1, "sigma of a point's inverse depth, as a share of it, up to which it is kept"});
  fields.add(
      "min_known_s", min_known_s,
      {"s", 0, 100, "since the estimator's start, before which its keyframes are let go: scale is not well known"});
  fields.add("min_age_s", min_age_s,
             {"s", 0, 100, "younger keyframes are not looked for: the window has their points"});
  fields.add("max_view_angle_deg", max_view_angle_deg,
             {"deg", 1, 90, "points whose rays now and then differ by more are not looked for"});
  fields.add("max_scale", max_scale, {"", 1, 10, "nor are those that are so many times nearer or farther than then"});
  fields.add("max_keyframes", max_keyframes,
             {"", 2, 1000, "kept; beyond that the one that was not found for longest goes"});
  fields.add("candidates", candidates, {"", 1, 1000, "keyframes whose points are looked for in an image, the nearest"});
}

void MapFilterConfig::visit(ConfigFields& fields) {
  fields.add("drift_m", drift_m, {"m", 0, 10, "of the odometry's position in 1 s, each axis"});
  fields.add("drift_yaw_deg", drift_yaw_deg, {"deg", 0, 90, "of the odometry's heading in 1 s"});
  fields.add("drift_tilt_deg", drift_tilt_deg, {"deg", 0, 90, "of the odometry's tilt in 1 s"});
  fields.add("pixel_sigma", pixel_sigma, {"px", 0.01, 100, "of where a patch is found"});
  fields.add("min_observations", min_observations, {"", 3, 1000, "fewer points found do not count"});
  fields.add("min_found_share", min_found_share, {"", 0, 1, "nor does a smaller share of those looked for"});
  fields.add("max_misfit", max_misfit,
             {"sigma", 0.01, 100, "nor points that, once they are fitted, are off by more in the median"});
}

void MapConfig::visit(ConfigFields& fields) {
  fields.add("enabled", enabled, {.effect = "look for what was seen before, and hold the pose to it"});
  fields.add("min_interval_s", min_interval_s, {"s", 0, 10, "between images in which the map is looked for"});
  fields.add("max_observations", max_observations, {"", 8, 1000, "points looked for in an image; more cost time"});
  fields.add("search_px", search_px,
             {"px", 1, 50, "points are looked for within 3 sigma of where they are expected, at most so far"});
  fields.group("patch", patch);
  fields.group("keyframes", keyframes);
  fields.group("filter", filter);
}

}  // namespace edged
