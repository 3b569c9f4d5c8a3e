// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/blocks.hpp"

namespace edged {

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const SE3 T = pose_of(x);
  const Eigen::Map<const Eigen::Vector3d> d_p(delta), d_phi(delta + 3);
  const PoseBlock block = to_block(SE3(T.rotation() * so3::exp(d_phi), T.translation() + d_p));
  std::copy(block.begin(), block.end(), x_plus_delta);
  return true;
}

bool PoseManifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> J(jacobian);
  J.setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  tangent_difference(BlockKind::Pose, y, x, y_minus_x);
  return true;
}

bool PoseManifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> J(jacobian);
  J.setIdentity();
  return true;
}

}  // namespace edged
