// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The options of the map.
#pragma once

#include "edged/config.hpp"
#include "edged/options/frontend.hpp"

namespace edged {

/// Which keyframes are kept, and which of their points are looked for.
struct KeyframeMapConfig {
  double min_interval_s = 0.3;       ///< between keyframes that are kept
  double max_covered = 0.5;          ///< share of a keyframe's view that the map already shows: beyond, it is let go
  int min_points = 15;               ///< a keyframe with fewer well-placed points is let go
  int max_points = 60;               ///< kept of a keyframe
  double max_depth_error = 0.1;      ///< sigma of a point's inverse depth, as a share of it
  double min_known_s = 4.0;          ///< since the estimator's start: before, its keyframes have a poor scale
  double min_age_s = 2.0;            ///< younger keyframes share their points with the window
  double max_view_angle_deg = 35.0;  ///< between the rays of a point now and then
  double max_scale = 1.5;            ///< a point is at most so much nearer or farther than then
  int max_keyframes = 100;           ///< kept; time and memory of the filter grow with the square
  int candidates = 30;               ///< keyframes that are looked at for an image, the nearest
  void visit(ConfigFields& fields);
};

/// Of the filter of poses.
struct MapFilterConfig {
  double drift_m = 0.002;  ///< of the odometry, in 1 s, each axis
  double drift_yaw_deg = 0.2;
  double drift_tilt_deg = 0.4;
  double pixel_sigma = 2.0;  ///< of a found patch [px]; its errors are much the same each time
  int min_observations = 8;
  double min_found_share = 0.4;
  double max_misfit = 0.75;  ///< of the observations once they are fitted, by their median [sigma]
  void visit(ConfigFields& fields);
};

struct MapConfig {
  bool enabled = true;
  double min_interval_s = 0.24;  ///< between images in which the map is looked for
  int max_observations = 80;     ///< points looked for in an image
  double search_px = 6.0;        ///< a point is looked for within three sigmas of where it is expected, at most so far
  PatchConfig patch;
  KeyframeMapConfig keyframes;
  MapFilterConfig filter;
  void visit(ConfigFields& fields);
};

}  // namespace edged
