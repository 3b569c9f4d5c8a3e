// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Options of the map.
#pragma once

#include "edged/config.hpp"
#include "edged/options/frontend.hpp"

namespace edged {

/// Which keyframes the map keeps, and which of their map points are searched for.
struct KeyframeMapConfig {
  double max_covered =
      0.5;              ///< share of a keyframe's view that the map covers already: above it, the keyframe is dropped
  int min_points = 15;  ///< a keyframe with fewer well-observed points is dropped
  int max_points = 60;  ///< kept of a keyframe
  double min_known_s = 4.0;  ///< since the start of the estimator: earlier keyframes have an inaccurate scale
  double min_age_s = 2.0;    ///< younger keyframes share their points with the window
  int max_keyframes = 1000;  ///< kept
  void visit(ConfigFields& fields);
};

/// The filter over the poses of body and keyframes.
struct MapFilterConfig {
  double pixel_sigma = 2.0;  ///< sigma of a map match [px]; its errors repeat from image to image
  int min_observations = 8;
  double min_found_share = 0.4;
  double max_misfit = 0.75;  ///< median residual of the map matches after the update [sigma]
  void visit(ConfigFields& fields);
};

struct MapConfig {
  bool enabled = true;
  bool localize_only = false;    ///< poses only in a loaded map, which never changes
  double min_interval_s = 0.24;  ///< between images that are matched against the map
  int max_observations = 80;     ///< map points that are searched for in an image
  double search_px = 6.0;        ///< largest search radius; a point is searched within three sigmas of its prediction
  PatchConfig patch;
  KeyframeMapConfig keyframes;
  MapFilterConfig filter;
  void visit(ConfigFields& fields);
};

}  // namespace edged
