// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/standstill_factor.hpp"

#include "edged/estimator/factors/blocks.hpp"

namespace edged {

bool StandstillFactor::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const SE3 T_W_Ba = pose_of(blocks[0]), T_W_Bb = pose_of(blocks[1]);
  const Eigen::Vector3d phi = so3::log(T_W_Ba.rotation().conjugate() * T_W_Bb.rotation());
  Eigen::Map<Vector6d> r(residuals);
  r << position_weight_ * (T_W_Bb.translation() - T_W_Ba.translation()), rotation_weight_ * phi;
  if (jacobians == nullptr) return true;
  for (int i = 0; i < 2; ++i) {
    if (jacobians[i] == nullptr) continue;
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> J(jacobians[i]);
    J.setZero();
    const double sign = i == 0 ? -1.0 : 1.0;
    J.topLeftCorner<3, 3>().diagonal().setConstant(sign * position_weight_);
    // Log(Exp(-d) R) and Log(R Exp(d)): the inverse left and right Jacobians at phi.
    J.block<3, 3>(3, 3) = sign * rotation_weight_ * so3::right_jacobian_inverse(sign * phi);
  }
  return true;
}

}  // namespace edged
