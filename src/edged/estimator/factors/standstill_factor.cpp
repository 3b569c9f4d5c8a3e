// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/standstill_factor.hpp"

#include "edged/estimator/tuning.hpp"

namespace edged {

std::shared_ptr<Factor> StandstillFactor::without(const DroppedState& dropped) const {
  const bool into = blocks()[1].id == dropped.id;  // the factor of the dropped state continues
  return into ? nullptr : std::make_shared<StandstillFactor>(dropped.before, dropped.after);
}

bool StandstillFactor::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const SE3 T_O_Ba = pose_of(blocks[0]), T_O_Bb = pose_of(blocks[1]);
  const double position_weight = 1.0 / kFactorTuning.standstill_position_sigma_m,
               rotation_weight = 1.0 / kFactorTuning.standstill_rotation_sigma;
  const Eigen::Vector3d phi = so3::log(T_O_Ba.rotation().conjugate() * T_O_Bb.rotation());
  Eigen::Map<Vector6d> r(residuals);
  r << position_weight * (T_O_Bb.translation() - T_O_Ba.translation()), rotation_weight * phi;
  if (jacobians == nullptr) return true;
  for (int i = 0; i < 2; ++i) {
    if (jacobians[i] == nullptr) continue;
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> J(jacobians[i]);
    J.setZero();
    const double sign = i == 0 ? -1.0 : 1.0;
    J.topLeftCorner<3, 3>().diagonal().setConstant(sign * position_weight);
    // Log(Exp(-d) R) and Log(R Exp(d)): the inverse left and right Jacobians at phi.
    J.block<3, 3>(3, 3) = sign * rotation_weight * so3::right_jacobian_inverse(sign * phi);
  }
  return true;
}

}  // namespace edged
