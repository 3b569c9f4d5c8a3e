// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/linear_prior.hpp"

#include "edged/core/check.hpp"
#include "edged/state.hpp"

namespace edged {

LinearPrior prior_at(BlockKey key, std::span<const double> values, const Eigen::VectorXd& sigmas) {
  LinearPrior prior;
  prior.blocks = {key};
  prior.x0 = {{values.begin(), values.end()}};
  prior.J = sigmas.cwiseMax(1e-9).cwiseInverse().asDiagonal();
  prior.r = Eigen::VectorXd::Zero(sigmas.size());
  return prior;
}

LinearPrior gauge_prior(BlockKey pose, const PoseBlock& at, double position_sigma, double yaw_sigma) {
  LinearPrior prior;
  prior.blocks = {pose};
  prior.x0 = {{at.begin(), at.end()}};
  prior.J = Eigen::MatrixXd::Zero(4, 6);
  prior.J.topLeftCorner<3, 3>().diagonal().setConstant(1.0 / position_sigma);
  // A rotation about O's z by psi is the right perturbation R^T e_z psi.
  prior.J.block<1, 3>(3, 3) = pose_of(at.data()).R().row(2) / yaw_sigma;
  prior.r = Eigen::VectorXd::Zero(4);
  return prior;
}

LinearPrior motion_prior(BlockKey motion, const MotionBlock& mean, const Eigen::Vector3d& sigmas) {
  Eigen::Matrix<double, 9, 1> each;
  for (int i = 0; i < 9; ++i) each[i] = sigmas[i / 3];
  return prior_at(motion, mean, each);
}

LinearPrior rest_prior(BlockKey pose, const PoseBlock& at, BlockKey motion, const MotionBlock& mean,
                       const Eigen::Vector3d& accel_B, double sigma) {
  const Eigen::Vector3d reaction_B = pose_of(at.data()).R().transpose() * -kGravity_W;
  LinearPrior prior;
  prior.blocks = {pose, motion};
  prior.x0 = {{at.begin(), at.end()}, {mean.begin(), mean.end()}};
  prior.J = Eigen::MatrixXd::Zero(3, 15);
  // R Exp(phi) rotates the reading of the body by -phi.
  prior.J.middleCols<3>(3) = skew(reaction_B) / sigma;
  prior.J.rightCols<3>().diagonal().setConstant(1.0 / sigma);
  prior.r = (reaction_B + Eigen::Map<const Eigen::Vector3d>(mean.data() + 6) - accel_B) / sigma;
  return prior;
}

LinearPriorFactor::LinearPriorFactor(LinearPrior prior)
    : Factor(static_cast<int>(prior.r.size()), prior.blocks), prior_(std::move(prior)) {
  Eigen::Index columns = 0;
  for (const BlockKey& key : prior_.blocks) columns += tangent_size(key.kind);
  EDGED_CHECK(prior_.J.cols() == columns && prior_.x0.size() == prior_.blocks.size(),
              "a prior of {} blocks with {} columns, {} of them in J", prior_.blocks.size(), columns, prior_.J.cols());
}

bool LinearPriorFactor::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  Eigen::VectorXd difference(prior_.J.cols());
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < prior_.blocks.size(); ++i) {
    const BlockKind kind = prior_.blocks[i].kind;
    tangent_difference(kind, blocks[i], prior_.x0[i].data(), difference.data() + column);
    if (jacobians != nullptr && jacobians[i] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(
          jacobians[i], prior_.J.rows(), block_size(kind));
      J.leftCols(tangent_size(kind)) = prior_.J.middleCols(column, tangent_size(kind));
      if (kind == BlockKind::Pose) {
        J.col(6).setZero();
        // d Log(q0^-1 q Exp(d)) / d d: the inverse right Jacobian at the difference.
        const Eigen::Vector3d phi = difference.segment<3>(column + 3);
        J.middleCols<3>(3) = prior_.J.middleCols(column + 3, 3) * so3::right_jacobian_inverse(phi);
      }
    }
    column += tangent_size(kind);
  }
  Eigen::Map<Eigen::VectorXd>(residuals, prior_.r.size()).noalias() = prior_.J * difference + prior_.r;
  return true;
}

}  // namespace edged
