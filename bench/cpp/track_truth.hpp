// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Where the corners that a tracker follows truly are: from the scene of a simulation, or from the true poses alone.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "edged/dataset.hpp"
#include "edged/rig.hpp"
#include "edged/sim/sensors/renderer.hpp"
#include "edged/sim/simulator.hpp"
#include "edged/state.hpp"

namespace edged {

/// A corner as it was seen in one image.
struct Observation {
  Timestamp t;            ///< time of the packet, on the IMU clock
  Eigen::Vector2d pixel;  ///< place in the image that the tracker was given
  Eigen::Vector2d point;  ///< place on the unit plane
  bool tracking;          ///< the odometry had an estimate
};

/// All observations of one corner, in time order.
struct Trail {
  FeatureId id = 0;
  std::vector<Observation> observations;
  std::optional<Eigen::Vector3d> p_W;  ///< where it truly is, in the world of the true poses
  bool at_edge = false;                ///< near the rim of what hides something behind it: p_W may be either's
};

/// The corners of one camera. image: model of the images given to its tracker.
struct CameraTrails {
  RigCamera camera;
  CameraModel image;
  std::vector<Trail> trails;
};

/// What a picture shows between its pixels: over a plane inverse depth is linear. At an edge of depth that of the
/// nearer side, which owns it.
struct ScenePoint {
  double inverse_depth;  ///< [1/m]; 0: nothing
  bool at_edge;
};
ScenePoint scene_point(const Rendering& picture, const CameraModel& image, const Eigen::Vector2d& pixel);

class TrackTruth {
 public:
  virtual ~TrackTruth() = default;

  /// The body at t on the IMU clock; nothing where the truth does not reach.
  virtual std::optional<SE3> T_W_B(Timestamp t) const = 0;

  /// Sets p_W, and at_edge, of the trails for which it can be known.
  virtual void locate(CameraTrails& seen) const = 0;

  std::optional<SE3> T_W_C(const RigCamera& camera, Timestamp t) const {
    const std::optional<SE3> body = T_W_B(t);
    return body ? std::optional(*body * camera.T_B_C) : std::nullopt;
  }
};

/// The exact motion and scene: a corner is the scene's point that its first observation shows. Throws InputError where
/// something in the scene moves.
std::unique_ptr<TrackTruth> simulated_truth(const SimulatorConfig& config);

/// The poses that came with a recording: a corner is where the rays of all its observations meet; observations that are
/// few, or hardly differ in direction, tell no place.
std::unique_ptr<TrackTruth> recorded_truth(const GroundTruth& truth, const Rig& rig);

}  // namespace edged
