// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Loop closure: old places that are recognized by appearance while the odometry is good, where its drift is too large
// to match them by position.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "edged/map/keyframe_map.hpp"
#include "edged/map/map_filter.hpp"
#include "edged/options/map.hpp"
#include "edged/pipeline/mapping/map_search.hpp"
#include "edged/pipeline/vision/tracked_image.hpp"

namespace edged {

/// The map, and the odometry in it, at the time of some images.
struct MapSnapshot {
  Timestamp t;
  KeyframeMap& map;
  const MapFilter& filter;
  SE3 T_M_O;
  double path_m;    ///< length of the odometry's path
  Timestamp since;  ///< the poses of older keyframes relative to the body are unknown
};

/// The body's pose T_K_B relative to an old keyframe, by its index, whose place images show.
struct Loop {
  std::size_t keyframe = 0;
  SE3 T_K_B;
  double drift_m = 0.0;  ///< bound on the odometry's drift since then
};

/// Whether the odometry can have drifted so far: T_M_B by itself, and by an old place. Gravity keeps roll and pitch.
bool drift_explains(const SE3& by_odometry, const SE3& by_place, double drift_m);

class LoopCloser {
 public:
  explicit LoopCloser(const MapConfig& config) : config_(config) {}

  /// Whether too few old points are matched by position.
  bool loop_needed(const MapSearch& search, const KeyframeMap& map, Timestamp t) const;
  /// A loop on which images of several positions agree, the last of them these. At least one image.
  std::optional<Loop> find(const MapSnapshot& now, std::span<const PosedImage> images);
  /// Corrects all poses by the loop, if the filter believes it. Returns the corrected T_M_O.
  static std::optional<SE3> close(MapFilter& filter, const KeyframeMap& map, double path_m, const Loop& loop);
  /// Forgets the images so far.
  void reset() { views_.clear(); }

 private:
  /// An image that shows an old place by its appearance.
  struct LoopView {
    SE3 T_O_B, T_M_O;  ///< M by the old keyframes
    Loop loop;
  };
  std::optional<LoopView> view(const MapSnapshot& now, const PosedImage& posed,
                               std::span<const PosedImage> images) const;
  std::optional<LoopView> projected(LoopView view, const MapSnapshot& now, std::span<const PosedImage> images) const;

  MapConfig config_;
  std::optional<Timestamp> searched_;
  std::vector<LoopView> views_;  ///< that agree on a loop, which is not closed yet
};

}  // namespace edged
