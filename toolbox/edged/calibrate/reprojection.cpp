// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/calibrate/reprojection.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "edged/estimator/factors/blocks.hpp"

namespace edged {
namespace {

FreeLens lens_of(const double* block, DistortionModel distortion) {
  FreeLens lens{distortion, {}};
  std::copy_n(block, kLensParameters, lens.values.begin());
  return lens;
}

/// One corner: its residual, and how what follows from a derivative of the pixel is weighted.
struct CornerTerm {
  Eigen::Vector2d residual;
  Eigen::Matrix2d weight;  // of a derivative of the pixel
};

CornerTerm term_of(const Eigen::Vector2d& pixel, const Eigen::Vector2d& measured, double sigma_px) {
  const Eigen::Vector2d r = (pixel - measured) / sigma_px;
  const Robust at = robust(r.squaredNorm());
  return {at.factor * r, (at.factor * Eigen::Matrix2d::Identity() + at.slope * r * r.transpose()) / sigma_px};
}

/// A corner behind the camera has a constant residual, as far as the loss reaches.
const Eigen::Vector2d kLost(10.0, 10.0);

template <int Columns>
void put(double** jacobians, int block, Eigen::Index corner, const Eigen::Matrix<double, 2, Columns>& J) {
  if (jacobians == nullptr || jacobians[block] == nullptr) return;
  double* rows = jacobians[block] + 2 * corner * Columns;
  Eigen::Map<Eigen::Matrix<double, 2, Columns, Columns == 1 ? Eigen::ColMajor : Eigen::RowMajor>>{rows} = J;
}

Eigen::Matrix<double, 2, 7> of_pose(const Eigen::Matrix<double, 2, 6>& J) {
  Eigen::Matrix<double, 2, 7> out;
  out << J, Eigen::Vector2d::Zero();
  return out;
}

}  // namespace

std::vector<CornerPair> pairs_of(const TargetView& view, const TargetLayout& layout) {
  std::vector<CornerPair> out;
  for (const TargetCorner& corner : view.corners) {
    const Eigen::Vector2d& p = layout.corners.at(static_cast<std::size_t>(corner.id));
    out.push_back({{p.x(), p.y(), 0.0}, corner.pixel});
  }
  return out;
}

Robust robust(double squared) {
  constexpr double kScale = kRobustAt * kRobustAt;
  if (squared < 1e-8) return {1.0, -0.5 / kScale};  // the limit
  const double rho = kScale * std::log1p(squared / kScale), d_rho = 1.0 / (1.0 + squared / kScale);
  const double factor = std::sqrt(rho / squared);
  return {factor, (d_rho * squared - rho) / (squared * squared * factor)};
}

bool PoseBlockManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  std::copy_n(x, 7, x_plus_delta);
  plus(BlockKind::Pose, x_plus_delta, delta);
  return true;
}

bool PoseBlockManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>{jacobian}.setIdentity();
  return true;
}

bool PoseBlockManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  tangent_difference(BlockKind::Pose, y, x, y_minus_x);
  return true;
}

bool PoseBlockManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>{jacobian}.setIdentity();
  return true;
}

PlainReprojection::PlainReprojection(std::vector<CornerPair> corners, DistortionModel distortion, double sigma_px)
    : corners_(std::move(corners)), distortion_(distortion), sigma_px_(sigma_px) {
  set_num_residuals(2 * static_cast<int>(corners_.size()));
  *mutable_parameter_block_sizes() = {7, kLensParameters};
}

bool PlainReprojection::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const SE3 T_C_T = pose_of(blocks[0]);
  const Eigen::Matrix3d R = T_C_T.R();
  const FreeLens lens = lens_of(blocks[1], distortion_);
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(corners_.size()); ++i) {
    const CornerPair& corner = corners_[static_cast<std::size_t>(i)];
    PixelByPoint by_point = PixelByPoint::Zero();
    PixelByLens by_lens = PixelByLens::Zero();
    const auto pixel = project_free(lens, T_C_T * corner.p_T, &by_point, &by_lens);
    CornerTerm term{kLost, Eigen::Matrix2d::Zero()};
    if (pixel) term = term_of(*pixel, corner.pixel, sigma_px_);
    Eigen::Map<Eigen::Vector2d>{residuals + 2 * i} = term.residual;
    Eigen::Matrix<double, 3, 6> by_pose;
    by_pose << Eigen::Matrix3d::Identity(), -R * skew(corner.p_T);
    put<7>(jacobians, 0, i, of_pose(term.weight * by_point * by_pose));
    put<kLensParameters>(jacobians, 1, i, term.weight * by_lens);
  }
  return true;
}

MovingReprojection::MovingReprojection(std::vector<CornerPair> corners, DistortionModel distortion, double sigma_px,
                                       const Instant& instant)
    : corners_(std::move(corners)), distortion_(distortion), sigma_px_(sigma_px), instant_(instant) {
  set_num_residuals(2 * static_cast<int>(corners_.size()));
  *mutable_parameter_block_sizes() = {7, 9, 7, 1, 2, kLensParameters};
}

bool MovingReprojection::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const SE3 T_W_B = pose_of(blocks[0]), T_B_C = pose_of(blocks[2]);
  const Eigen::Map<const Eigen::Vector3d> v_W(blocks[1]), bias_gyro(blocks[1] + 3);
  const Eigen::Vector3d omega_B = instant_.gyro_B - bias_gyro, tilt(blocks[4][0], blocks[4][1], 0.0);
  const double after_s = instant_.after_state_s + blocks[3][0];
  const Eigen::Matrix3d turn_back = so3::exp(-after_s * omega_B).toRotationMatrix();  // R_Bdelta_B
  const Eigen::Matrix3d turn_by_rate = turn_back * so3::right_jacobian(-after_s * omega_B);
  const Eigen::Matrix3d R_B_W = turn_back * T_W_B.R().transpose(), R_C_B = T_B_C.R().transpose();
  const Eigen::Matrix3d R_W_T = (so3::exp(tilt) * instant_.R_W_T).toRotationMatrix();
  const Eigen::Matrix<double, 3, 2> turn_by_tilt = so3::right_jacobian(-tilt).leftCols<2>();
  const FreeLens lens = lens_of(blocks[5], distortion_);
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(corners_.size()); ++i) {
    const CornerPair& corner = corners_[static_cast<std::size_t>(i)];
    const Eigen::Vector3d p_W = R_W_T * corner.p_T;
    const Eigen::Vector3d p_B = R_B_W * (p_W - T_W_B.translation() - after_s * v_W);
    const Eigen::Vector3d p_C = R_C_B * (p_B - T_B_C.translation());
    PixelByPoint by_point = PixelByPoint::Zero();
    PixelByLens by_lens = PixelByLens::Zero();
    const auto pixel = project_free(lens, p_C, &by_point, &by_lens);
    CornerTerm term{kLost, Eigen::Matrix2d::Zero()};
    if (pixel) term = term_of(*pixel, corner.pixel, sigma_px_);
    Eigen::Map<Eigen::Vector2d>{residuals + 2 * i} = term.residual;
    if (jacobians == nullptr) continue;
    const PixelByPoint by_p_C = term.weight * by_point, by_p_B = by_p_C * R_C_B;
    Eigen::Matrix<double, 2, 6> by_body, by_mount;
    by_body << -by_p_B * R_B_W, by_p_B * skew(p_B) * turn_back;
    Eigen::Matrix<double, 2, 9> by_motion = Eigen::Matrix<double, 2, 9>::Zero();
    by_motion.leftCols<3>() = -after_s * by_p_B * R_B_W;
    by_motion.middleCols<3>(3) = -after_s * by_p_B * skew(p_B) * turn_by_rate;
    by_mount << -by_p_B, by_p_C * skew(p_C);
    put<7>(jacobians, 0, i, of_pose(by_body));
    put<9>(jacobians, 1, i, by_motion);
    put<7>(jacobians, 2, i, of_pose(by_mount));
    put<1>(jacobians, 3, i, by_p_B * (p_B.cross(omega_B) - R_B_W * v_W));
    put<2>(jacobians, 4, i, -by_p_B * R_B_W * skew(p_W) * turn_by_tilt);
    put<kLensParameters>(jacobians, 5, i, term.weight * by_lens);
  }
  return true;
}

}  // namespace edged
