// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The sliding window: states, features and the prior of marginalization.
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
#include "edged/estimator/window/region_depth.hpp"
#include "edged/estimator/window/walking_scalar.hpp"
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
  Eigen::Vector3d gyro_B = Eigen::Vector3d::Zero();        ///< gyro sample at t [rad/s]
  std::optional<RegionDepth> depth;                        ///< of a keyframe: the depth from a depth source
  std::map<std::size_t, std::vector<KeyframePoint>> kept;  ///< by camera: its records of marginalized landmarks

  SE3 T_O_B() const { return pose_of(pose.data()); }
  OdomState nav() const;
  BodyRate rate() const;
};

MotionBlock motion_block(const OdomState& state);
WindowState window_state(const OdomState& nav, const Eigen::Vector3d& gyro_B, Preintegration imu, bool keyframe);

/// Identifies an image: that of a camera at a state.
struct ObservationKey {
  StateId state = 0;
  std::size_t camera = 0;  ///< index into Window::cameras()
  auto operator<=>(const ObservationKey&) const = default;
};

/// An observation at its point by the given intrinsics, and by others.
struct WindowObservation : FeatureObservation {
  ImagePoint image;
  bool predicted = false;  ///< image has its derivative where the landmark is predicted
};

/// The observations under one id and, once triangulated, their landmark.
struct Feature {
  std::map<ObservationKey, WindowObservation> observations;  ///< in the window
  /// By observing camera: the newest state that observed it, even if that has been dropped since.
  std::map<std::size_t, StateId> last_seen;
  std::optional<ObservationKey> anchor;  ///< set when it is a landmark: an observation from a keyframe
  double inverse_depth = 0.0;            ///< [1/m] along z of the anchor camera

  /// By any camera.
  bool seen_at(StateId state) const;
};

/// The new anchor of a landmark.
struct NewAnchor {
  ObservationKey key;
  double inverse_depth;
};

/// A camera of the rig, with its estimated calibration and noise.
struct WindowCamera {
  RigCamera given;
  CalibrationBlock calibration{};  ///< correction of `given`: Window::calibrated() has both
  IntrinsicsCorrection linearised_at = IntrinsicsCorrection::Zero();  ///< where the points of its observations are
  CameraModel model = {};                                             ///< with these corrections
  double noise_scale = 1.0;                                           ///< multiplies the sigma of its new observations
  StateId last_image = 0;                                             ///< the newest state with an image of it
};

/// Read access for all; only its own functions change it, and each keeps its invariants: times and ids of states grow;
/// features are observed in states of the window and anchored in its keyframes; factors are of blocks in the window. A
/// violation is a bug (EDGED_CHECK). O is here the frame of this start (S of pipeline/world_frame): measurements in the
/// world frame must be transformed to it first.
class Window {
 public:
  /// Time offsets of the rig are residual ones: packets are already stamped on the IMU clock. Calibrations are fixed
  /// until free_calibration().
  Window(const Rig& rig, double cauchy_scale, const DepthFactorConfig& depth = {});

  const std::map<StateId, WindowState>& states() const { return states_; }
  StateId oldest_id() const { return states_.begin()->first; }
  StateId newest_id() const { return states_.rbegin()->first; }
  const WindowState& newest() const { return states_.rbegin()->second; }
  const std::map<FeatureId, Feature>& features() const { return features_; }
  const std::vector<WindowCamera>& cameras() const { return cameras_; }
  /// The prior of marginalization; empty at first.
  const std::shared_ptr<const LinearPriorFactor>& prior() const { return prior_; }
  /// Initial priors: gauge, biases, zero velocity, calibrations.
  const std::vector<std::shared_ptr<LinearPriorFactor>>& soft_priors() const { return soft_priors_; }
  /// Of measurements, in the order of their states. Landmarks and scene depths are not among them (cost.hpp).
  const std::vector<std::shared_ptr<Factor>>& factors() const { return factors_; }
  const TrackNoise& track_noise() const { return track_noise_; }
  const DepthFactorConfig& depth_config() const { return depth_config_; }
  ceres::LossFunction* visual_loss() const { return visual_loss_.get(); }

  /// Index into cameras(); the rig must have one of that name.
  std::size_t camera_index(const std::string& name) const;
  /// The camera with its estimated pose relative to the body and its residual time offset. Its model is the given one,
  /// that of the points of its observations.
  RigCamera calibrated(std::size_t camera) const;
  SE3 T_B_C(std::size_t camera) const;
  /// Estimated corrections of its intrinsics, and the model with these.
  IntrinsicsCorrection intrinsics(std::size_t camera) const;
  CameraModel model(std::size_t camera) const;
  /// The point of an observation by the estimated intrinsics, on the unit plane.
  Eigen::Vector2d point(const ObservationKey& image, const WindowObservation& observation) const;
  SE3 T_O_C(const ObservationKey& image) const;
  /// True while the newest image of a camera that observes the feature still shows it. Not every state has an image of
  /// every camera.
  bool alive(const Feature& feature) const;
  bool alive(const Feature& feature, std::size_t camera) const;
  /// The landmark's position in O; the feature must have an anchor.
  Eigen::Vector3d position(const Feature& feature) const;

  /// Appends a state later than all, its IMU and standstill factors, and its observations.
  StateId add_state(WindowState state, const std::vector<CameraObservations>& observations = {});
  /// The depth from a depth source at the newest state.
  void set_depth(const RegionDepth& depth);
  void make_keyframe(StateId id) { state(id).keyframe = true; }
  /// A measurement of blocks that the window holds.
  void add(std::shared_ptr<Factor> factor);
  /// Drops a state between two others that is no keyframe; `joined` is the IMU interval from the one to the other. Its
  /// factors define their own replacement.
  void drop_state(StateId id, Preintegration joined);
  /// A keyframe keeps a record of a landmark that is marginalized.
  void keep_point(const ObservationKey& image, const KeyframePoint& point);
  /// Removes the oldest state and the landmarks anchored there, except those with a new anchor, which keep the
  /// observations from that state on. `prior` has the information of all that was removed.
  void drop_oldest(LinearPrior prior, const std::map<FeatureId, NewAnchor>& inherited = {});

  /// The derivative of an observation's point by the intrinsics is taken where its landmark is predicted. Where it was
  /// observed, the derivative had the noise of the observation, and the smallest residuals were those of too long focal
  /// lengths, which shrink the noise.
  void predict(FeatureId id, const ObservationKey& image, const Eigen::Vector2d& point);
  /// Points are linearised anew in cameras whose intrinsics have moved away from where they are.
  void relinearise_intrinsics();
  /// Makes a feature observed by that camera in a keyframe a landmark.
  void make_landmark(FeatureId id, const NewAnchor& anchor);
  /// Removes an observation, not the anchor's.
  void forget_observation(FeatureId id, const ObservationKey& image);
  void forget_feature(FeatureId id) { features_.erase(id); }
  /// Removes tracks that ended before they became landmarks.
  void forget_ended_tracks();

  /// Multiplies the sigmas of the camera's future observations.
  void set_noise_scale(std::size_t camera, double scale) { cameras_.at(camera).noise_scale = scale; }
  /// Multiplies the sigmas of all past and future observations of the camera.
  void rescale_noise(std::size_t camera, double factor);
  /// Without it errors along a track are independent.
  void set_track_noise(const TrackNoise& noise) { track_noise_ = noise; }
  /// Starts to estimate calibrations, with priors at their present values. Not before scale is known: in slow motion a
  /// rotation of the camera resembles a scale error.
  void free_calibration(const CalibrationConfig& config);
  /// Corrections known beforehand. Before free_calibration().
  void set_intrinsics(std::size_t camera, const IntrinsicsCorrection& intrinsics);
  /// Gauge, biases, zero velocity: until one of its blocks is marginalized, when it is absorbed into the prior.
  void add_soft_prior(LinearPrior prior);

  /// Adds a scalar of that kind. With depth factors ln s (Eq. 5) exists from the start.
  void begin_walk(BlockKind kind, double value, const Walk& walk);
  /// The present piece of such a scalar, if there is one; those of all scalars.
  std::optional<BlockKey> walking(BlockKind kind) const;
  std::vector<BlockKey> walking() const;
  /// WalkingScalar::begin_piece. The old piece leaves with the oldest state; remaining factors refer to the new one.
  LinearPrior begin_piece(BlockKind kind, double dt_s) { return walking_.at(kind).begin_piece(dt_s); }
  /// Removes it with its factors; `prior` is the prior of marginalization without it.
  void end_walk(BlockKind kind, LinearPrior prior);

  /// The present values of a block, null when it is not in the window.
  const double* block(BlockKey key) const;
  /// First-estimate linearisation point of a block: its point in the prior, else its present value. Calibrations are
  /// relinearised: they are observable, and far off at first.
  const double* linearisation_point(BlockKey key) const;
  /// Moves a block by a step in its tangent space.
  void move(BlockKey key, std::span<const double> step);
  /// The values of all blocks. restore() sets them again while the window holds the same blocks.
  std::vector<double> estimates() const;
  void restore(const std::vector<double>& estimates);

 private:
  WindowState& state(StateId id);
  Feature& feature(FeatureId id);
  void observe(const CameraObservations& view);
  void linearise(const WindowCamera& camera, WindowObservation& observation) const;
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
