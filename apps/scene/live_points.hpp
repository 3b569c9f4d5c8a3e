// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The dense points and occupied voxels of a run that goes on, for its viewers: a bounded number, spread evenly; each
// point is sent once, voxels all together when they have changed.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "common/even_sample.hpp"
#include "edged/dense/depth_map.hpp"

namespace edged {

/// For any thread. Points lie where their keyframe was when it was measured; only dense.ply has their final places.
class LivePoints {
 public:
  static constexpr std::size_t kMost = 1'000'000, kMostAtOnce = 10'000, kMostVoxels = 20'000;

  bool watched = false;                         ///< by a live page; set before the run begins, as are those below
  bool has_points = false, has_voxels = false;  ///< will come

  /// What one viewer has received.
  struct Place {
    std::size_t points = 0, halvings = 0, voxels = 0;
  };

  /// The odometry frame in the map at a keyframe; before the depth map of that keyframe.
  void note_keyframe(Timestamp t, const SE3& T_M_O);
  /// Without effect if the keyframe is not known.
  void add(const DepthMap& map);

  /// The next points for a viewer as packed_json, with "halved": how often it is to drop every second point that it has
  /// (the second, the fourth ...), before it adds these; "from": number of points that it has then; "all": number of
  /// points so far. Null if there is nothing new.
  nlohmann::ordered_json news(Place& place) const;

  /// Replaces those before. centres: in the map [m]; edge_m: of a voxel.
  void set_voxels(const std::vector<Eigen::Vector3f>& centres, double edge_m);
  /// The voxels as the report has them, or null if this viewer has them.
  nlohmann::ordered_json new_voxels(Place& place) const;

 private:
  struct Point {
    Eigen::Vector3f p_M;
    std::uint8_t grey;
  };
  struct Keyframe {
    Timestamp t;
    SE3 T_M_O;
  };

  mutable std::mutex mutex_;  ///< guards all below
  std::deque<Keyframe> keyframes_;
  EvenSample<Point> points_{kMost};
  std::size_t all_ = 0;
  std::vector<Eigen::Vector3f> voxels_;
  double voxel_m_ = 0.0;
  std::size_t all_voxels_ = 0, voxels_number_ = 0;  ///< the second: how often they have been set
};

}  // namespace edged
