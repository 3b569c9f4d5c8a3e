// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Steps 2 and 3 of the alignment: first velocity, gravity and accelerometer bias from tracks whose rotations are known.
#pragma once

#include <optional>
#include <vector>

#include "edged/camera/two_view.hpp"
#include "edged/core/observation.hpp"
#include "edged/core/odom_state.hpp"
#include "edged/imu/preintegration.hpp"
#include "edged/measurement.hpp"
#include "edged/options/estimator.hpp"
#include "edged/rig.hpp"

namespace edged {

struct StartEquations;

/// One view of the start-up buffer, with the IMU before it.
struct InitFrame {
  Timestamp t;
  std::vector<ImuSample> imu;  ///< from the frame before to t; unused in the first frame
  std::vector<CameraObservations> observations;
  std::optional<RegionDepth> depth = std::nullopt;  ///< not used by the alignment, but by the window made from it
  std::vector<ExternalSample> external = {};        ///< within `imu`, in the order of their stamps
};

/// One view of a feature.
struct StartObservation {
  std::size_t frame, camera;
  Eigen::Vector2d point;
  double sigma;
};

/// A feature over the views.
struct StartTrack {
  FeatureId id;
  std::vector<StartObservation> observations;
};

/// The unknowns once rotations are known: first velocity, gravity, both in the first body frame, and the accelerometer
/// bias less that of the prior.
using Start = Eigen::Matrix<double, 9, 1>;
using StartMatrix = Eigen::Matrix<double, 9, 9>;

/// Poses relative to the first body frame: p_j = alpha_j + B_j x, x being the start.
struct RelativeMotion {
  double t = 0.0;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d alpha = Eigen::Vector3d::Zero(),
                  beta = Eigen::Vector3d::Zero();  ///< position and velocity from the accelerometer
  Eigen::Matrix3d d_alpha = Eigen::Matrix3d::Zero(),
                  d_beta = Eigen::Matrix3d::Zero();  ///< their derivatives by its bias

  Eigen::Matrix<double, 3, 9> d_position() const {
    Eigen::Matrix<double, 3, 9> B;
    B << t * Eigen::Matrix3d::Identity(), 0.5 * t * t * Eigen::Matrix3d::Identity(), d_alpha;
    return B;
  }
  Eigen::Vector3d position(const Start& x) const { return alpha + d_position() * x; }
  Eigen::Vector3d velocity(const Start& x) const {
    return beta + x.head<3>() + t * x.segment<3>(3) + d_beta * x.tail<3>();
  }
};

/// What is known of the biases of the IMU before a start, with sigmas of an axis [rad/s, m/s^2].
struct BiasPrior {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
  double gyro_sigma = 0.0, accel_sigma = 0.0;
};

/// What is known beside the views.
struct StartPriors {
  BiasPrior biases;
  bool gyro_known = false;                   ///< its bias need not be found in the views
  const VelocityConfig* velocity = nullptr;  ///< null: samples of velocity are not used
};

/// A velocity sample as rows of equations A x = b over its sigmas; zero for an axis that is not measured.
struct StartVelocity {
  Eigen::Matrix<double, 3, 9> A;
  Eigen::Vector3d b;
};

struct RefinedStart {
  Start x;
  StartMatrix covariance;
};

/// Tracks of a start-up buffer, and initializations from some of them. Tracks are given by their index in tracks().
class InitializationSolver {
 public:
  using Chosen = std::vector<std::size_t>;

  InitializationSolver(const std::vector<InitFrame>& frames, const Rig& rig, const Eigen::Vector3d& gyro_bias,
                       const ImuNoise& noise, const StartPriors& priors);

  /// Features observed in three views or more.
  const std::vector<StartTrack>& tracks() const { return tracks_; }
  /// The motion at each frame, by the IMU.
  const std::vector<RelativeMotion>& motion() const { return motion_; }
  /// The accelerometer bias of an initialization [m/s^2].
  Eigen::Vector3d accel_bias(const Start& x) const { return biases_.accel + x.tail<3>(); }

  /// The linear solution, |g| imposed and the accelerometer bias that of the prior; free_length: |g| without that.
  /// Nothing if it is not determined.
  std::optional<Start> linear(const Chosen& chosen, double* free_length) const;

  /// Noise makes the linear solution too small and points too near: this minimises the reprojection error itself, with
  /// |g| fixed and the prior on the accelerometer bias.
  std::optional<RefinedStart> refine(const Chosen& chosen, Start x, int iterations) const;

  /// The initialization from which the IMU propagates to a given state at the time of the last view.
  Start start_of(const OdomState& last) const;

  /// Root mean square of the reprojection errors of each track under an initialization, with its point optimized
  /// [sigma]; infinite if that fails.
  std::vector<double> misfits(const Start& x) const;

  /// Standard deviation of the longest baseline over its length.
  double relative_sigma(const RefinedStart& start) const;

  /// Standard deviation of ln scale by the baselines between cameras.
  double baseline_sigma(const Chosen& chosen) const;

  /// Direction of a track in the middle of its life, in the first body frame.
  Eigen::Vector3d direction(std::size_t track) const;

 private:
  std::vector<SE3> camera_poses(const Start& x) const;
  std::size_t pose_index(const StartObservation& seen) const { return seen.frame * rig_->cameras.size() + seen.camera; }
  std::vector<Ray> rays_from(std::size_t track, const std::vector<SE3>& cameras) const;
  void add_algebraic(const StartTrack& track, StartEquations& equations) const;
  void add_reprojection(std::size_t track, const std::vector<SE3>& cameras, StartEquations& equations) const;
  void add_velocities(const Start& x, StartEquations& equations) const;

  const Rig* rig_;
  BiasPrior biases_;
  std::vector<RelativeMotion> motion_;
  std::vector<StartTrack> tracks_;
  std::vector<std::vector<Ray>> rays_;  ///< rays of the tracks; their centres depend on the start
  std::vector<double> parallaxes_;      ///< largest angles of the tracks [rad]
  std::vector<StartVelocity> velocities_;
};

}  // namespace edged
