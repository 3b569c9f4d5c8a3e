// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The sliding window: states, features and the prior of marginalization.
#pragma once

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
#include "edged/estimator/window/random_walk_parameter.hpp"
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
  bool stationary = false;  ///< the body did not move since the state before this one
  Preintegration imu;       ///< from the state before this one; unused in the window's first state
  Eigen::Vector3d gyro_B = Eigen::Vector3d::Zero();                       ///< gyro sample at t [rad/s]
  std::optional<RegionDepth> depth;                                       ///< from a depth source, at a keyframe
  std::map<std::size_t, std::vector<KeyframePoint>> marginalized_points;  ///< records of landmarks, by camera

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

/// An observation: its point by the given intrinsics, and as a function of the estimated ones.
struct WindowObservation : FeatureObservation {
  ImagePoint image;
  bool predicted = false;  ///< image has its derivative where the landmark is predicted
};

/// The observations under one id and, once triangulated, their landmark.
struct Feature {
  std::map<ObservationKey, WindowObservation> observations;  ///< in the window
  /// The newest state that observed it, even if dropped since; by observing camera.
  std::map<std::size_t, StateId> last_seen;
  std::optional<ObservationKey> anchor;  ///< set when it is a landmark: an observation from a keyframe
  double inverse_depth = 0.0;            ///< [1/m] along z of the anchor camera

  /// Whether any camera observed it at that state.
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
  CalibrationBlock calibration{};                                     ///< estimated correction of `given`
  IntrinsicsCorrection linearised_at = IntrinsicsCorrection::Zero();  ///< where the points of its observations are
  CameraModel linearised_model = {};                                  ///< the given one with the corrections there
  double noise_scale = 1.0;                                           ///< multiplies the sigma of its new observations
  StateId last_image = 0;                                             ///< the newest state with an image of it

  /// Estimated corrections of its intrinsics, and the model with these.
  IntrinsicsCorrection intrinsics() const { return IntrinsicsCorrection(calibration.data() + kIntrinsicsAt); }
  CameraModel model() const { return corrected_model(given.model, intrinsics()).value_or(given.model); }
  SE3 T_B_C() const { return camera_pose(SE3(), {}, given.T_B_C, calibration.data()); }
  /// The camera with its estimated pose relative to the body and its residual time offset. Its model is the given one,
  /// that of the points of its observations.
  RigCamera calibrated() const;
};

struct StartRecord;

/// Read access for all; only its own functions change it, and each keeps its invariants: times and ids of states grow;
/// features are observed in states of the window and anchored in its keyframes; factors are of blocks in the window. A
/// violation is a bug (EDGED_CHECK). O is the frame of this start: measurements in the map frame must be transformed to
/// it first.
class Window {
 public:
  /// Time offsets of the rig are residual ones: packets are already stamped on the IMU clock. Calibrations are fixed
  /// until free_calibration(). Without track noise the errors along a track are independent.
  explicit Window(const Rig& rig, const TrackNoise& noise = {0.0, 0.0}, const DepthFactorConfig& depth = {});
  /// All states of a start that is closed, as they left the window, without a prior of marginalization. For solving
  /// only: no state can be added, dropped or marginalized.
  explicit Window(const StartRecord& record);
  // Factors refer to the states.
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
  Window(Window&&) = default;
  Window& operator=(Window&&) = default;

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
  /// Factors of measurements, in the order of their states. Landmarks and scene depths are not among them (cost.hpp).
  const std::vector<std::shared_ptr<Factor>>& factors() const { return factors_; }
  const TrackNoise& track_noise() const { return track_noise_; }
  const DepthFactorConfig& depth_config() const { return depth_config_; }

  /// Index into cameras(); the rig must have one of that name.
  std::size_t camera_index(const std::string& name) const;
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
  void add_marginalized_point(const ObservationKey& image, const KeyframePoint& point);
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
  void remove_observation(FeatureId id, const ObservationKey& image);
  void remove_feature(FeatureId id) { features_.erase(id); }
  /// Removes tracks that ended before they became landmarks.
  void remove_ended_tracks();

  /// Sets the factor on the sigmas of the camera's future observations.
  void set_noise_scale(std::size_t camera, double scale) { cameras_.at(camera).noise_scale = scale; }
  /// Factor on the white noise of all past and future IMU intervals.
  double imu_noise_scale() const { return imu_noise_scale_; }
  void set_imu_noise_scale(double scale);
  /// Multiplies the sigmas of all past and future observations of the camera.
  void rescale_noise(std::size_t camera, double factor);
  /// Starts to estimate calibrations, with priors at their present values. Not before scale is known: in slow motion a
  /// rotation of the camera resembles a scale error.
  void free_calibration(const CalibrationConfig& config);
  /// Sets corrections known beforehand. Call it before free_calibration().
  void set_intrinsics(std::size_t camera, const IntrinsicsCorrection& intrinsics);
  /// Adds an initial prior (gauge, biases, zero velocity). It goes into the prior of marginalization with its blocks.
  void add_soft_prior(LinearPrior prior);

  /// Adds a random-walk parameter of that kind. With depth factors ln s (Eq. 5) exists from the start.
  void add_parameter(BlockKind kind, double value, const RandomWalk& walk);
  /// The present block of the parameter of that kind, if there is one; those of all parameters.
  std::optional<BlockKey> parameter(BlockKind kind) const;
  std::vector<BlockKey> parameters() const;
  /// RandomWalkParameter::propagate. The old block leaves with the oldest state; remaining factors refer to the new
  /// one.
  LinearPrior propagate_parameter(BlockKind kind, double dt_s) { return parameters_.at(kind).propagate(dt_s); }
  /// Removes the parameter with its factors; `prior` is the prior of marginalization without it.
  void remove_parameter(BlockKind kind, LinearPrior prior);

  /// The present values of a block, null when it is not in the window.
  const double* block(BlockKey key) const;
  /// Moves a block by a step in its tangent space.
  void move(BlockKey key, std::span<const double> step);
  /// The values of all blocks. restore() sets them again while the window holds the same blocks.
  std::vector<double> estimates() const;
  void restore(const std::vector<double>& estimates);

 private:
  void observe_again(const StartRecord& record, std::size_t part, std::map<FeatureId, std::size_t>& begins);
  void anchor_at(Feature& feature, const Eigen::Vector3d& p_O) const;
  WindowState& state(StateId id);
  Feature& feature(FeatureId id);
  void observe(const CameraObservations& view);
  void linearise(const WindowCamera& camera, WindowObservation& observation) const;
  void check(const Factor& factor) const;
  void set_prior(LinearPrior prior);
  void add_calibration_priors(std::size_t camera, const CalibrationConfig& config);
  void remove_orphaned_factors();
  /// Calls visit with the values of each block, all in one order.
  template <typename Self, typename Visit>
  static void for_each_block(Self& self, const Visit& visit);

  std::map<StateId, WindowState> states_;
  std::map<FeatureId, Feature> features_;
  std::vector<WindowCamera> cameras_;
  ImuIntrinsicsBlock imu_intrinsics_{};
  std::map<BlockKind, RandomWalkParameter> parameters_;
  std::shared_ptr<const LinearPriorFactor> prior_;
  std::vector<std::shared_ptr<LinearPriorFactor>> soft_priors_;
  std::vector<std::shared_ptr<Factor>> factors_;
  TrackNoise track_noise_;
  DepthFactorConfig depth_config_;
  double imu_noise_scale_ = 1.0;
  StateId next_state_ = 0;
  std::uint64_t next_parameter_ = 0;  ///< number of a new parameter's first block: none is used twice
};

}  // namespace edged
