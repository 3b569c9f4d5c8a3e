// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The sliding window: states, features and the prior that stands for what has left.
#pragma once

#include <ceres/loss_function.h>

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/core/observation.hpp"
#include "edged/estimator/estimator_config.hpp"
#include "edged/estimator/factors/blocks.hpp"
#include "edged/estimator/factors/landmark_factor.hpp"
#include "edged/estimator/factors/linear_prior.hpp"
#include "edged/estimator/keyframe_record.hpp"
#include "edged/estimator/region_depth.hpp"
#include "edged/imu/preintegration.hpp"
#include "edged/rig.hpp"
#include "edged/state.hpp"

namespace edged {

using StateId = std::uint64_t;

/// One instant of the window: a keyframe, or one of the newest states.
struct WindowState {
  Timestamp t;
  PoseBlock pose{};
  MotionBlock motion{};
  bool keyframe = false;
  bool rested = false;  ///< the body did not move since the state before this one
  Preintegration imu;   ///< from the state before this one; of the window's first state unused
  Eigen::Vector3d gyro_B = Eigen::Vector3d::Zero();        ///< the reading at t [rad/s]
  std::optional<RegionDepth> depth;                        ///< of a keyframe: what a depth source says
  std::map<std::size_t, std::vector<KeyframePoint>> kept;  ///< by camera: what it saw of landmarks that have left

  SE3 T_W_B() const { return pose_of(pose.data()); }
  NavState nav() const;
  BodyRate rate() const;
};

MotionBlock motion_block(const NavState& state);
WindowState window_state(const NavState& nav, const Eigen::Vector3d& gyro_B, Preintegration imu, bool keyframe);

/// A tracked corner and, once triangulated, the landmark behind it.
struct Feature {
  std::size_t camera = 0;                      ///< index into Window::cameras
  std::map<StateId, FeatureObservation> seen;  ///< in the window
  StateId last_seen = 0;                       ///< the newest observation, even if its state has been dropped since
  std::optional<StateId> anchor;               ///< set when it is a landmark
  double inverse_depth = 0.0;                  ///< [1/m] along z of the anchor camera
};

/// W is here the frame of this start (S of pipeline/world_frame): what is measured in the world must be moved there
/// first.
class Window {
 public:
  /// The rig's time offsets are those left over: packets are stamped on the clock of the IMU already. Calibrations are
  /// held as given until free_calibration().
  Window(const Rig& rig, double cauchy_scale, const DepthFactorConfig& depth = {});

  std::map<StateId, WindowState> states;  ///< ids grow with time
  std::map<FeatureId, Feature> features;
  LinearPrior prior;
  std::vector<LinearPrior> soft_priors;       ///< hand-set: gauge, biases, zero velocity
  std::vector<RigCamera> cameras;             ///< as given; calibrated() is what has been found
  std::vector<CalibrationBlock> calibration;  ///< one a camera
  ImuIntrinsicsBlock imu_intrinsics{};
  std::vector<double> noise_scale;        ///< one a camera: multiplies the sigma of its observations as they come in
  TrackNoise track_noise{0.0, 0.0, 1.0};  ///< independent observations until set
  DepthFactorConfig depth_config;
  /// The present piece of ln s (Eq. 5), and the next while one is left behind.
  std::map<std::uint64_t, double> ln_scale;

  /// Index into `cameras`; the rig must have one of that name.
  std::size_t camera_index(const std::string& name) const;

  /// Appends a state; ids are given in order of time.
  StateId add_state(WindowState state);
  void add_observations(StateId id, const std::vector<CameraObservations>& observations);

  /// True while the newest image of its camera still showed the feature. Not every state has an image of every camera.
  bool alive(const Feature& feature) const { return feature.last_seen == last_image_[feature.camera]; }

  const WindowState& newest() const { return states.rbegin()->second; }
  SE3 T_W_C(StateId state, std::size_t camera) const;
  /// From now on calibrations are estimated along, each near what it is. Not before scale is known: in slow motion a
  /// turned camera looks like another scale.
  void free_calibration(const CalibrationConfig& config);
  /// The camera by what has been seen: its rotation against the body, and the time offset that is left over.
  RigCamera calibrated(std::size_t camera) const;
  /// The landmark's position in the world; the feature must have an anchor.
  Eigen::Vector3d position(const Feature& feature) const;

  /// The present values of a block, null when it is no longer in the window.
  const double* block(BlockKey key) const;
  /// First-estimate linearisation point of a block: its place in the prior, else its present value. Calibrations are
  /// linearised anew: they can be observed, and are far off at first.
  const double* linearisation_point(BlockKey key) const;

  /// Moves a block by a step in its tangent space.
  void move(BlockKey key, std::span<const double> step);
  /// The values of all blocks, for restore() to bring them back while the window holds the same ones.
  std::vector<double> estimates() const;
  void restore(const std::vector<double>& estimates);

  /// Forgets the soft priors whose block has left: marginalisation has taken them into the prior.
  void drop_orphaned_priors();

  ceres::LossFunction* visual_loss() const { return visual_loss_.get(); }
  ceres::LossFunction* depth_loss() const { return depth_loss_.get(); }

 private:
  /// Calls visit with the values of each block, all in one order.
  template <typename Self, typename Visit>
  static void for_each_block(Self& self, const Visit& visit);

  StateId next_state_ = 0;
  std::vector<StateId> last_image_;  ///< newest state with an image, one a camera
  std::unique_ptr<ceres::LossFunction> visual_loss_, depth_loss_;
};

}  // namespace edged
