// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Calibrates gyro against camera from corner rays, over all rotations at once.
#pragma once

#include <optional>
#include <span>

#include "edged/checks/agreement/gyro_integral.hpp"
#include "edged/checks/agreement/visual_turns.hpp"

namespace edged {

/// The relation of the gyro's rotation to that of a camera.
struct GyroMount {
  Eigen::Matrix3d R_B_C = Eigen::Matrix3d::Identity();
  double shift_s = 0.0;                            ///< t_imu = t_cam + shift
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< bias of the gyro, in its measurement
  double gyro_scale = 1.0;                         ///< measured over true angular speed
};

struct RayFit {
  GyroMount mount;
  Eigen::Matrix3d rotation_covariance =
      Eigen::Matrix3d::Zero();  ///< covariance of the error in R_B_C * Exp(error) [rad^2]
  double shift_sigma_s = 0.0;
  double shift_t = 0.0;  ///< Student's t of the tenths of the recording that mount.shift_s fits better than `given_s`
  double unexplained = 1.0;  ///< share of the cost that independent rotations explain, but those of the gyro do not
  double scale_sigma = 0.0;  ///< sigma of mount.gyro_scale
  double scale_unexplained = 1.0;  ///< unexplained share with mount.gyro_scale; the other results assume a scale of 1
};

inline constexpr std::size_t kTimeBlocks = 10;        ///< of a recording, for the jackknife
inline constexpr std::size_t kFewestTurnsToFit = 30;  ///< of a recording

/// The epipolar errors of the corners of a turn, for one rotation and the direction of translation that fits best.
class EpipolarErrors {
 public:
  /// The error of a corner [rad], and its derivatives with respect to step in R_begin_end * Exp(step) and to two
  /// directions in which the translation may turn.
  struct Error {
    double value;
    Eigen::Matrix<double, 5, 1> J;
  };

  /// spread: the scale of the Cauchy loss of the errors.
  EpipolarErrors(const Turn& turn, const Eigen::Matrix3d& R_begin_end, double spread);

  Error of(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;
  /// Unit vector of the translation, of either sign.
  const Eigen::Vector3d& t() const { return t_; }

 private:
  Eigen::Matrix3d R_;
  Eigen::Vector3d t_, a_, b_;
};

/// The unit direction of the translation during a rotation, in the camera axes at its begin. R: rotation from end to
/// begin. Zero if the corners do not determine it.
Eigen::Vector3d translation_direction(const Turn& turn, const Eigen::Matrix3d& R_begin_end);

/// The mount with the smallest epipolar error of all corners, for any translation in each rotation (Gauss-Newton on the
/// cost of Kneip and Lynen, ICCV 2013, summed over all rotations). With a narrow view or a flat scene, one pair of
/// images hardly separates rotation from translation, but the common parameters of all pairs are well determined.
/// given_s: the shift of the calibration. Nothing without corners, or with too little rotation of the gyro.
std::optional<RayFit> fit_rays(std::span<const Turn> turns, const GyroIntegral& gyro, const GyroMount& start,
                               double given_s);

}  // namespace edged
