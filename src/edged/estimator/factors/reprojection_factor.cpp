// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/reprojection_factor.hpp"

#include <optional>

#include "edged/estimator/factors/blocks.hpp"

namespace edged {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using RowMajor26 = Eigen::Matrix<double, 2, 6, Eigen::RowMajor>;
using RowMajor27 = Eigen::Matrix<double, 2, 7, Eigen::RowMajor>;
using RowMajor24 = Eigen::Matrix<double, 2, 4, Eigen::RowMajor>;

/// A body moved on along its rate.
SE3 moved_body(const SE3& T_W_B, const BodyRate& rate, double time) {
  return {T_W_B.rotation() * so3::exp(rate.omega_B * time), T_W_B.translation() + rate.v_W * time};
}

/// The landmark as its anchor has it: what all its observations share. Everything is scaled by rho, so that points at
/// infinity (rho = 0) are ordinary points.
struct AnchoredLandmark {
  AnchoredLandmark(const SE3& T_B_C, const LandmarkView& anchor, const double* pose, const double* calibration,
                   const double* inverse_depth)
      : rho(inverse_depth[0]),
        time(calibration[3]),
        phi(calibration),
        R_B_C((T_B_C.rotation() * so3::exp(phi)).toRotationMatrix()),
        t_B_C(T_B_C.translation()),
        bearing(anchor.point.homogeneous()),
        x_B(R_B_C * bearing + rho * t_B_C),
        rate(anchor.rate) {
    const SE3 T_W_B = moved_body(pose_of(pose), rate, time);
    R_W_B = T_W_B.R();
    p_W_B = T_W_B.translation();
  }

  double rho, time;
  Vector3d phi;
  Matrix3d R_B_C;
  Vector3d t_B_C, bearing;
  Vector3d x_B;  ///< in the anchor's body, times rho
  BodyRate rate;
  Matrix3d R_W_B;  ///< of the anchor
  Vector3d p_W_B;
};

/// Derivatives of what the landmark has in the world by its own blocks, shared by its observations.
struct LandmarkDerivatives {
  explicit LandmarkDerivatives(const AnchoredLandmark& l)
      // A turn of the state's body is one of the moved body seen along Exp(omega time).
      : by_turn(-l.R_W_B * skew(l.x_B) * so3::exp(l.rate.omega_B * -l.time).toRotationMatrix()),
        by_phi(-l.R_W_B * l.R_B_C * skew(l.bearing)),
        by_time(l.R_W_B * l.rate.omega_B.cross(l.x_B) + l.rho * l.rate.v_W),
        by_rho(l.R_W_B * l.t_B_C + l.p_W_B),
        Jr(so3::right_jacobian(l.phi)) {}
  Matrix3d by_turn, by_phi;
  Vector3d by_time, by_rho;
  Matrix3d Jr;
};

/// Error of one observation on the unit plane and its derivatives.
struct Observation {
  Vector2d e;
  RowMajor26 by_anchor, by_seen;
  RowMajor24 by_calibration;
  Vector2d by_rho;
};

/// False when the landmark is not in front of the camera. shared: nothing when no derivatives are wanted.
bool look(const AnchoredLandmark& l, const LandmarkDerivatives* shared, const LandmarkView& view, const double* pose,
          Observation& observation) {
  const SE3 T_W_B = moved_body(pose_of(pose), view.rate, l.time);
  const Matrix3d R_B_W = T_W_B.R().transpose(), R_C_B = l.R_B_C.transpose();
  const Vector3d x_W = l.R_W_B * l.x_B + l.rho * (l.p_W_B - T_W_B.translation());
  const Vector3d x_B = R_B_W * x_W;
  const Vector3d x_C = R_C_B * (x_B - l.rho * l.t_B_C);
  if (x_C.z() < kMinDepthShare) return false;
  const double z_inv = 1.0 / x_C.z();
  const Vector2d predicted = x_C.head<2>() * z_inv;
  observation.e = predicted - view.point;
  if (shared == nullptr) return true;

  Eigen::Matrix<double, 2, 3> by_xC;
  by_xC << z_inv, 0, -predicted.x() * z_inv, 0, z_inv, -predicted.y() * z_inv;
  const Eigen::Matrix<double, 2, 3> by_xB = by_xC * R_C_B, by_xW = by_xB * R_B_W;
  const Matrix3d back = so3::exp(view.rate.omega_B * -l.time).toRotationMatrix();
  observation.by_anchor << l.rho * by_xW, by_xW * shared->by_turn;
  observation.by_seen << -l.rho * by_xW, by_xB * skew(x_B) * back;
  observation.by_calibration.leftCols<3>() = (by_xC * skew(x_C) + by_xW * shared->by_phi) * shared->Jr;
  observation.by_calibration.col(3) =
      by_xW * (shared->by_time - l.rho * view.rate.v_W) - by_xB * view.rate.omega_B.cross(x_B);
  observation.by_rho = by_xW * (shared->by_rho - T_W_B.translation()) - by_xC * (R_C_B * l.t_B_C);
  return true;
}

void write_pose(double* jacobian, const RowMajor26& by_pose) {
  if (jacobian != nullptr) Eigen::Map<RowMajor27>(jacobian) << by_pose, Vector2d::Zero();
}

void write_landmark(double* by_calibration, double* by_rho, const Observation& observation) {
  if (by_calibration != nullptr) Eigen::Map<RowMajor24>{by_calibration} = observation.by_calibration;
  if (by_rho != nullptr) Eigen::Map<Vector2d>{by_rho} = observation.by_rho;
}

}  // namespace

SE3 camera_pose(const SE3& T_W_B, const BodyRate& rate, const SE3& T_B_C, const double* calibration) {
  const Eigen::Map<const Eigen::Vector3d> phi(calibration);
  return moved_body(T_W_B, rate, calibration[3]) * SE3(T_B_C.rotation() * so3::exp(phi), T_B_C.translation());
}

bool ReprojectionFactor::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const AnchoredLandmark landmark(T_B_C_, anchor_, blocks[0], blocks[2], blocks[3]);
  std::optional<LandmarkDerivatives> shared;
  if (jacobians != nullptr) shared.emplace(landmark);
  Observation observation;
  if (!look(landmark, shared ? &*shared : nullptr, seen_, blocks[1], observation)) return false;
  Eigen::Map<Vector2d>{residuals} = weight_ * observation.e;
  if (!shared) return true;
  write_pose(jacobians[0], weight_ * observation.by_anchor);
  write_pose(jacobians[1], weight_ * observation.by_seen);
  observation.by_calibration *= weight_;
  observation.by_rho *= weight_;
  write_landmark(jacobians[2], jacobians[3], observation);
  return true;
}

bool TrackStepFactor::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const AnchoredLandmark landmark(T_B_C_, anchor_, blocks[0], blocks[3], blocks[4]);
  std::optional<LandmarkDerivatives> shared;
  if (jacobians != nullptr) shared.emplace(landmark);
  const LandmarkDerivatives* derivatives = shared ? &*shared : nullptr;
  Observation observation, before;
  if (!look(landmark, derivatives, seen_, blocks[1], observation) ||
      !look(landmark, derivatives, before_, blocks[2], before)) {
    return false;
  }
  const double weight_before = -correlation_ * weight_;
  Eigen::Map<Vector2d>{residuals} = weight_ * observation.e + weight_before * before.e;
  if (!shared) return true;
  write_pose(jacobians[0], weight_ * observation.by_anchor + weight_before * before.by_anchor);
  write_pose(jacobians[1], weight_ * observation.by_seen);
  write_pose(jacobians[2], weight_before * before.by_seen);
  observation.by_calibration = weight_ * observation.by_calibration + weight_before * before.by_calibration;
  observation.by_rho = weight_ * observation.by_rho + weight_before * before.by_rho;
  write_landmark(jacobians[3], jacobians[4], observation);
  return true;
}

}  // namespace edged
