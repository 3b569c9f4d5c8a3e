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
#include "edged/core/odom_state.hpp"
#include "edged/estimator/factors/blocks.hpp"
#include "edged/estimator/factors/landmark_factor.hpp"
#include "edged/estimator/factors/linear_prior.hpp"
#include "edged/estimator/region_depth.hpp"
#include "edged/estimator/walking_scalar.hpp"
#include "edged/imu/preintegration.hpp"
#include "edged/keyframe_record.hpp"
#include "edged/options/estimator.hpp"
#include "edged/rig.hpp"

namespace edged {

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

  SE3 T_O_B() const { return pose_of(pose.data()); }
  OdomState nav() const;
  BodyRate rate() const;
};

MotionBlock motion_block(const OdomState& state);
WindowState window_state(const OdomState& nav, const Eigen::Vector3d& gyro_B, Preintegration imu, bool keyframe);

/// Names an image: that of a camera at a state.
struct ObservationKey {
  StateId state = 0;
  std::size_t camera = 0;  ///< index into Window::cameras()
  auto operator<=>(const ObservationKey&) const = default;
};

/// What cameras have tracked under one id and, once triangulated, the landmark behind it.
struct Feature {
  std::map<ObservationKey, FeatureObservation> observations;  ///< in the window
  /// By camera that has seen it: the newest state that did, even if that has been dropped since.
  std::map<std::size_t, StateId> last_seen;
  std::optional<ObservationKey> anchor;  ///< set when it is a landmark: an observation from a keyframe
  double inverse_depth = 0.0;            ///< [1/m] along z of the anchor camera

  /// By any camera.
  bool seen_at(StateId state) const;
};

/// Where a landmark is anchored from now on.
struct NewAnchor {
  ObservationKey key;
  double inverse_depth;
};

/// A camera of the rig, and what the window knows of it.
struct WindowCamera {
  RigCamera given;
  CalibrationBlock calibration{};  ///< what `given` is off by: Window::calibrated() has both
  double noise_scale = 1.0;        ///< multiplies the sigma of its observations as they come in
  StateId last_image = 0;          ///< the newest state with an image of it
};

/// All may look, and only its own functions change it: each leaves it whole. Times and ids of its states grow; features
/// are seen by states and anchored in keyframes that it holds, and factors are of blocks that it holds. What would
/// break that is a bug (EDGED_CHECK). O is here the frame of this start (S of pipeline/world_frame): what is measured
/// in the world must be moved there first.
class Window {
 public:
  /// The rig's time offsets are those left over: packets are stamped on the clock of the IMU already. Calibrations are
  /// held as given until free_calibration().
  Window(const Rig& rig, double cauchy_scale, const DepthFactorConfig& depth = {});

  const std::map<StateId, WindowState>& states() const { return states_; }
  StateId oldest_id() const { return states_.begin()->first; }
  StateId newest_id() const { return states_.rbegin()->first; }
  const WindowState& newest() const { return states_.rbegin()->second; }
  const std::map<FeatureId, Feature>& features() const { return features_; }
  const std::vector<WindowCamera>& cameras() const { return cameras_; }
  /// What marginalisation has left; empty at first.
  const std::shared_ptr<const LinearPriorFactor>& prior() const { return prior_; }
  /// Hand-set: gauge, biases, zero velocity, calibrations.
  const std::vector<std::shared_ptr<LinearPriorFactor>>& soft_priors() const { return soft_priors_; }
  /// Of measurements, in the order of their states. Landmarks and depths of the scene are apart (cost.hpp).
  const std::vector<std::shared_ptr<Factor>>& factors() const { return factors_; }
  const TrackNoise& track_noise() const { return track_noise_; }
  const DepthFactorConfig& depth_config() const { return depth_config_; }
  ceres::LossFunction* visual_loss() const { return visual_loss_.get(); }

  /// Index into cameras(); the rig must have one of that name.
  std::size_t camera_index(const std::string& name) const;
  /// The camera by what has been seen: its rotation against the body, and the time offset that is left over.
  RigCamera calibrated(std::size_t camera) const;
  SE3 T_O_C(const ObservationKey& image) const;
  /// True while the newest image of a camera that sees it still showed the feature. Not every state has an image of
  /// every camera.
  bool alive(const Feature& feature) const;
  bool alive(const Feature& feature, std::size_t camera) const;
  /// The landmark's position in the world; the feature must have an anchor.
  Eigen::Vector3d position(const Feature& feature) const;

  /// Appends a state later than all, the factors of its IMU and rest, and what the cameras see there.
  StateId add_state(WindowState state, const std::vector<CameraObservations>& observations = {});
  /// What a depth source says at the newest state.
  void set_depth(const RegionDepth& depth);
  void make_keyframe(StateId id) { state(id).keyframe = true; }
  /// A measurement of blocks that the window holds.
  void add(std::shared_ptr<Factor> factor);
  /// A state between two others that is no keyframe leaves; `joined` is what the IMU felt from the one to the other.
  /// Its factors say what becomes of them.
  void drop_state(StateId id, Preintegration joined);
  /// A keyframe keeps what it saw of a landmark that leaves.
  void keep_point(const ObservationKey& image, const KeyframePoint& point);
  /// The oldest state leaves, and with it the landmarks anchored there, but for those with a new anchor: they go on by
  /// what is seen from that state on. `prior` stands for all that has left.
  void drop_oldest(LinearPrior prior, const std::map<FeatureId, NewAnchor>& inherited = {});

  /// A feature seen by that camera in a keyframe is a landmark from now on.
  void make_landmark(FeatureId id, const NewAnchor& anchor);
  /// Takes out an observation, not the anchor's.
  void forget_observation(FeatureId id, const ObservationKey& image);
  void forget_feature(FeatureId id) { features_.erase(id); }
  /// Tracks that ended before they became landmarks.
  void forget_ended_tracks();

  /// Multiplies the sigmas of what the camera sees from now on.
  void set_noise_scale(std::size_t camera, double scale) { cameras_.at(camera).noise_scale = scale; }
  /// Multiplies the sigmas of all that the camera has seen, and of what it will see.
  void rescale_noise(std::size_t camera, double factor);
  /// Without it errors along a track are independent.
  void set_track_noise(const TrackNoise& noise) { track_noise_ = noise; }
  /// From now on calibrations are estimated along, each near what it is. Not before scale is known: in slow motion a
  /// turned camera looks like another scale.
  void free_calibration(const CalibrationConfig& config);
  /// Gauge, biases, zero velocity: until a block of it leaves, when marginalisation has taken it into the prior.
  void add_soft_prior(LinearPrior prior);

  /// From now on there is a scalar of that kind. ln s (Eq. 5) is there from the first with depth factors.
  void begin_walk(BlockKind kind, double value, const Walk& walk);
  /// The present piece of such a scalar, if there is one; of all that there are.
  std::optional<BlockKey> walking(BlockKind kind) const;
  std::vector<BlockKey> walking() const;
  /// WalkingScalar::begin_piece. The piece before leaves with the oldest state, what stays is of the new one.
  LinearPrior begin_piece(BlockKind kind, double dt_s) { return walking_.at(kind).begin_piece(dt_s); }
  /// It goes, with its factors; `prior` stands for what marginalisation has left without it.
  void end_walk(BlockKind kind, LinearPrior prior);

  /// The present values of a block, null when it is not in the window.
  const double* block(BlockKey key) const;
  /// First-estimate linearisation point of a block: its place in the prior, else its present value. Calibrations are
  /// linearised anew: they can be observed, and are far off at first.
  const double* linearisation_point(BlockKey key) const;
  /// Moves a block by a step in its tangent space.
  void move(BlockKey key, std::span<const double> step);
  /// The values of all blocks, for restore() to bring them back while the window holds the same ones.
  std::vector<double> estimates() const;
  void restore(const std::vector<double>& estimates);

 private:
  WindowState& state(StateId id);
  Feature& feature(FeatureId id);
  void observe(const CameraObservations& view);
  void check(const Factor& factor) const;
  void set_prior(LinearPrior prior);
  void forget_orphaned_factors();
  /// Calls visit with the values of each block, all in one order.
  template <typename Self, typename Visit>
  static void for_each_block(Self& self, const Visit& visit);

  std::map<StateId, WindowState> states_;
  std::map<FeatureId, Feature> features_;
  std::vector<WindowCamera> cameras_;
  ImuIntrinsicsBlock imu_intrinsics_{};
  std::map<BlockKind, WalkingScalar> walking_;
  std::shared_ptr<const LinearPriorFactor> prior_;
  std::vector<std::shared_ptr<LinearPriorFactor>> soft_priors_;
  std::vector<std::shared_ptr<Factor>> factors_;
  TrackNoise track_noise_{0.0, 0.0, 1.0};
  DepthFactorConfig depth_config_;
  StateId next_state_ = 0;
  std::unique_ptr<ceres::LossFunction> visual_loss_;
};

}  // namespace edged
