// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The poses of body and keyframes in the map M: one Kalman filter over the body and the active keyframes,
// which were in view last; the others are inactive (InactiveKeyframes), and follow these. The odometry predicts the
// pose of the body; map matches correct it and all correlated poses. Nothing feeds back into the odometry: no
// measurement is used twice there, and a wrong map does not affect it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "edged/map/inactive_keyframes.hpp"
#include "edged/map/map_errors.hpp"
#include "edged/map/tuning.hpp"
#include "edged/options/map.hpp"
#include "edged/se3.hpp"
#include "edged/time.hpp"

namespace edged {

/// T_M_O is OdomToMap's: the filter takes it and returns its correction.
class MapFilter {
 public:
  /// fixed_keyframes: their poses never change; their covariance counts in each update all the same (a Schmidt filter).
  explicit MapFilter(const MapFilterConfig& config, bool fixed_keyframes = false,
                     int max_active = kMapTuning.active_keyframes)
      : config_(config), fixed_keyframes_(fixed_keyframes), max_active_(max_active) {}

  /// A new frame O of the odometry: its pose in M is uncertain, with these sigmas [m], [rad] of position, yaw and tilt.
  void restart(const SE3& T_M_O, const SE3& T_O_B, Timestamp t, double position_sigma, double yaw_sigma,
               double tilt_sigma = 0.0);
  /// The odometry is that uncertain of its tilt [rad]. What it has learned of that since the last call has turned it.
  void set_tilt_sigma(double sigma);
  /// Prediction to T_O_B, with the drift of the odometry since the last one. Before it, the active keyframes beyond
  /// max_active that were activated longest ago are deactivated.
  void predict(const SE3& T_M_O, const SE3& T_O_B, Timestamp t, const Drift& drift);
  /// Adds a keyframe of the odometry, at T_O_K: the last one in keyframes().
  void add_keyframe(const SE3& T_M_O, const SE3& T_O_K, Timestamp t);
  /// Replaces all keyframes by those of another run; covariance: of the active ones, six rows each.
  void load(std::vector<SE3> T_M_K, const Eigen::MatrixXd& covariance, std::span<const ConditionalPose> inactive = {});
  /// These are in view: active until max_active others were activated after them.
  void activate(std::span<const std::uint32_t> keyframes);
  /// The order of the other keyframes stays.
  void remove_keyframe(std::size_t keyframe);
  /// Updates all poses with the observations, of active keyframes; expected: how many points were searched
  /// for; T_B_C: one per image. Returns the corrected T_M_O; nothing if they do not agree, without any change.
  std::optional<SE3> update(std::span<const MapObservation> observations, std::size_t expected,
                            const std::vector<SE3>& T_B_C);

  /// More drift than the odometry knows of: a random walk in M of the position, with these variances at the keyframes,
  /// by index, and at the body, each the sum of those before it [m^2], and of the heading, with that share of them
  /// [rad^2/m^2].
  void inflate(std::span<const double> keyframes, double body, double heading_share = 0.0);

  /// Squared Mahalanobis distance of the body's pose T_K_B relative to an active keyframe from the predicted one;
  /// covariance: of the error of T_K_B.
  double squared_distance(std::size_t keyframe, const SE3& T_K_B, const Matrix6d& covariance) const;
  /// Closes a loop: updates all poses with the body's pose relative to an active keyframe. Returns the corrected T_M_O.
  SE3 close(std::size_t keyframe, const SE3& T_K_B, const Matrix6d& covariance);

  const SE3& T_M_B() const { return T_M_B_; }
  double tilt_sigma() const { return tilt_sigma_; }
  const std::vector<SE3>& keyframes() const { return T_M_K_; }
  /// Covariance of the body relative to the map's first keyframe.
  Matrix6d covariance() const { return P_.topLeftCorner<6, 6>(); }
  /// Joint covariance of the active keyframes, six rows each.
  Eigen::MatrixXd keyframe_covariance() const;
  std::vector<ConditionalPose> inactive() const { return inactive_.poses(); }
  /// One sigma of the predicted position of an observation on the unit plane.
  double expected_error(const MapObservation& observation, const SE3& T_B_C) const;

 private:
  std::optional<LinearizedObservation> linearise(const MapObservation& observation, const SE3& T_B_C) const;
  Eigen::Matrix2d expected_covariance(const LinearizedObservation& row, std::size_t keyframe) const;
  /// Normal equations of the body and of the keyframes in `place`, which maps them to their first columns.
  struct Information {
    std::map<std::size_t, Eigen::Index> place;
    Eigen::MatrixXd H;
    Eigen::VectorXd g;
  };
  Information gather(std::span<const MapObservation> observations, std::span<const LinearizedObservation> rows) const;
  void add_gravity(Information& sum) const;
  /// The update of P_ and of the errors by an information.
  struct Update {
    std::vector<Eigen::Index> moved;  ///< rows of P_ that change
    Eigen::MatrixXd P_m, A;           ///< P -= P_m A P_m^T there
    Eigen::VectorXd error;
  };
  Update solved(const Information& sum) const;
  /// Residual of the body's pose relative to a keyframe, and its Jacobian by the errors of body and keyframe.
  struct LinearizedPose {
    Vector6d r;
    Eigen::Matrix<double, 6, 12> J;
  };
  LinearizedPose linearise(std::size_t keyframe, const SE3& T_K_B) const;
  double median_residual(std::span<const MapObservation> observations, std::span<const LinearizedObservation> rows,
                         const Eigen::VectorXd& error) const;
  SE3 correct(const Eigen::VectorXd& error);
  std::vector<std::size_t> active() const;
  void deactivate_beyond_limit();
  void deactivate(std::span<const std::size_t> keyframes);
  ConditionalPose conditional(std::size_t keyframe, Eigen::Index row) const;
  void fill_rows(const ConditionalPose& pose);
  void select_rows();
  void update_covariance(const Update& update);

  MapFilterConfig config_;
  bool fixed_keyframes_;
  int max_active_;
  double tilt_sigma_ = kMapTuning.tilt_deg * kDegree, updated_tilt_sigma_ = tilt_sigma_;  ///< now, at the last update
  Drift drift_;                                                                           ///< at the last prediction
  SE3 T_O_B_, T_M_B_;
  Timestamp t_, updated_;
  static constexpr Eigen::Index kInactive = -1;
  std::vector<SE3> T_M_K_;
  std::vector<Timestamp> activated_;                 ///< when it was in view last
  std::vector<Eigen::Index> row_;                    ///< first row in P_; kInactive: none
  Eigen::MatrixXd P_ = Eigen::MatrixXd::Zero(6, 6);  ///< body first, then the active keyframes
  InactiveKeyframes inactive_;
};

}  // namespace edged
