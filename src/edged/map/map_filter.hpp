// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The poses of body and keyframes in the map M: one Kalman filter over the body and the keyframes that were in view
// last; the others rest (RestingPoses), and move with those that they are tied to. The odometry predicts the pose of
// the body; map matches correct it and all correlated poses. Nothing feeds back into the odometry: no measurement is
// used twice there, and a wrong map does not affect it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "edged/map/map_errors.hpp"
#include "edged/map/resting_poses.hpp"
#include "edged/options/map.hpp"
#include "edged/se3.hpp"
#include "edged/time.hpp"

namespace edged {

/// T_M_O is OdomToMap's: the filter takes it and returns its correction.
class MapFilter {
 public:
  /// fixed_keyframes: their poses never change; their covariance counts in each update all the same (a Schmidt filter).
  explicit MapFilter(const MapFilterConfig& config, bool fixed_keyframes = false)
      : config_(config), fixed_keyframes_(fixed_keyframes) {}

  /// A new frame O of the odometry: its pose in M is uncertain, with these sigmas [m], [rad] of position and yaw.
  void restart(const SE3& T_M_O, const SE3& T_O_B, Timestamp t, double position_sigma, double yaw_sigma);
  /// Prediction to T_O_B. drift: factor on the drift in the options. Before it, the keyframes beyond max_active that
  /// were woken longest ago come to rest.
  void predict(const SE3& T_M_O, const SE3& T_O_B, Timestamp t, double drift = 1.0);
  /// Adds a keyframe of the odometry, at T_O_K: the last one in keyframes().
  void add_keyframe(const SE3& T_M_O, const SE3& T_O_K, Timestamp t);
  /// Replaces all keyframes by those of another run; covariance: of those that do not rest, six rows each.
  void load(std::vector<SE3> T_M_K, const Eigen::MatrixXd& covariance, std::span<const TiedPose> resting = {});
  /// These are in view: they do not rest until max_active others were woken after them.
  void wake(std::span<const std::uint32_t> keyframes);
  /// The order of the other keyframes stays.
  void remove_keyframe(std::size_t keyframe);
  /// Updates all poses with the observations, of keyframes that do not rest; expected: how many points were searched
  /// for; T_B_C: one per image. Returns the corrected T_M_O; nothing if they do not agree, without any change.
  std::optional<SE3> update(std::span<const MapObservation> observations, std::size_t expected,
                            const std::vector<SE3>& T_B_C);

  const SE3& T_M_B() const { return T_M_B_; }
  const std::vector<SE3>& keyframes() const { return T_M_K_; }
  /// Covariance of the body relative to the map's first keyframe.
  Matrix6d covariance() const { return P_.topLeftCorner<6, 6>(); }
  /// Of the keyframes that do not rest, six rows each.
  Eigen::MatrixXd keyframe_covariance() const;
  std::vector<TiedPose> resting() const { return resting_.poses(); }
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
  double misfit(std::span<const MapObservation> observations, std::span<const LinearizedObservation> rows,
                const Eigen::VectorXd& error) const;
  SE3 correct(const Eigen::VectorXd& error);
  std::vector<std::size_t> awake() const;
  void rest_beyond_limit();
  void rest(std::span<const std::size_t> keyframes);
  TiedPose tied(std::size_t keyframe, Eigen::Index row) const;
  void fill_rows(const TiedPose& pose);
  void select_rows();
  void shrink(std::span<const Eigen::Index> m, const Eigen::MatrixXd& P_m, const Eigen::MatrixXd& A);

  MapFilterConfig config_;
  bool fixed_keyframes_;
  SE3 T_O_B_, T_M_B_;
  Timestamp t_;
  static constexpr Eigen::Index kResting = -1;
  std::vector<SE3> T_M_K_;
  std::vector<Timestamp> woken_;                     ///< when it was in view last
  std::vector<Eigen::Index> row_;                    ///< first row in P_; kResting: none
  Eigen::MatrixXd P_ = Eigen::MatrixXd::Zero(6, 6);  ///< body first, then the keyframes that do not rest
  RestingPoses resting_;
};

}  // namespace edged
