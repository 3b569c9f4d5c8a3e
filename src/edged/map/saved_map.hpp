// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A saved map: its keyframes, their poses with covariance, and their cameras.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "edged/map/inactive_keyframes.hpp"
#include "edged/map/keyframe_map.hpp"
#include "edged/rig.hpp"
#include "edged/se3.hpp"

namespace edged {

struct SavedMap {
  /// Patches are in its pixels: with another lens the same place has another appearance.
  struct Camera {
    std::string name;
    int width = 0, height = 0;  ///< [px]
    double focal = 0.0;         ///< mean of both [px]
  };
  std::vector<Camera> cameras;
  std::vector<MapKeyframe> keyframes;  ///< oldest first
  std::vector<SE3> T_M_K;              ///< pose of the body, one per keyframe
  Eigen::MatrixXd covariance;          ///< joint, of T_M_K without `inactive`, six rows each; errors as in MapFilter
  std::vector<ConditionalPose> inactive{};  ///< their parents: active, or later in this list
};

/// Throws InputError where the rig has none of the cameras of its keyframes, or one of them with another lens.
void check_fits(const SavedMap& map, const Rig& rig);

/// As bytes, little endian, with a version and a checksum. Of times only the order is kept: the last match of the
/// newest keyframe is at -1 s of the next run's clock.
std::string to_bytes(const SavedMap& map);
/// Throws InputError on anything that to_bytes cannot have written.
SavedMap saved_map_from_bytes(std::string_view bytes);

}  // namespace edged
