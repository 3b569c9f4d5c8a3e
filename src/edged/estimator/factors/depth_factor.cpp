// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/depth_factor.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

using Eigen::RowVector3d;
using Eigen::Vector3d;

/// ln 1/z of one landmark in the observing camera, and its derivatives (docs/math.md, D1).
struct LogInverseDepth {
  double value = 0.0;
  Eigen::Matrix<double, 1, 6> d_observer, d_anchor;
  double d_rho = 0.0;
};

std::optional<LogInverseDepth> log_inverse_depth(const DepthLandmark& landmark, const SE3& T_O_B1, const SE3& T_O_B0,
                                                 double rho, const Vector3d& t_B_E, const Vector3d& z_E_in_B) {
  if (rho <= 0.0) return std::nullopt;
  // As in the reprojection factor everything is scaled by rho: z = w / rho.
  const Vector3d x_B0 =
      landmark.T_B_C.rotation() * landmark.anchor_point.homogeneous() + rho * landmark.T_B_C.translation();
  const Vector3d step_O = T_O_B0.translation() - T_O_B1.translation();
  const Eigen::Matrix3d R_O_B0 = T_O_B0.R(), R_B1_O = T_O_B1.R().transpose();
  const Vector3d x_B1 = R_B1_O * (R_O_B0 * x_B0 + rho * step_O);
  const double w = z_E_in_B.dot(x_B1 - rho * t_B_E);
  if (w < kFactorTuning.min_depth_share) return std::nullopt;

  LogInverseDepth out;
  out.value = std::log(rho) - std::log(w);
  const RowVector3d d_x_B1 = -z_E_in_B.transpose() / w;
  const RowVector3d d_x_O = d_x_B1 * R_B1_O;
  out.d_anchor << rho * d_x_O, -d_x_O * R_O_B0 * skew(x_B0);
  out.d_observer << -rho * d_x_O, d_x_B1 * skew(x_B1);
  out.d_rho = 1.0 / rho + d_x_O.dot(R_O_B0 * landmark.T_B_C.translation() + step_O) - d_x_B1.dot(t_B_E);
  return out;
}

std::vector<BlockKey> blocks_of(BlockKey scale, StateId state, const std::vector<DepthLandmark>& landmarks) {
  std::vector<BlockKey> blocks = {scale, {BlockKind::Pose, state}}, depths;
  for (const DepthLandmark& landmark : landmarks) {
    const BlockKey anchor{BlockKind::Pose, landmark.anchor};
    if (std::ranges::find(blocks, anchor) == blocks.end()) blocks.push_back(anchor);
    depths.push_back({BlockKind::InverseDepth, landmark.id});
  }
  blocks.insert(blocks.end(), depths.begin(), depths.end());
  return blocks;
}

}  // namespace

DepthFactor::DepthFactor(const DepthMeasurement& measured, BlockKey scale, std::vector<DepthLandmark> landmarks)
    : Factor(1, blocks_of(scale, measured.state, landmarks)),
      residual_(measured.residual),
      t_B_E_(measured.T_B_E.translation()),
      z_E_in_B_(measured.T_B_E.R().col(2)),
      landmarks_(std::move(landmarks)),
      poses_(blocks().size() - 1 - landmarks_.size()),
      rho_source_(1.0 / measured.source_depth_m),
      weight_(measured.weight),
      loss_(kFactorTuning.cauchy_scale) {
  for (const DepthLandmark& landmark : landmarks_) {
    const auto block = std::ranges::find(blocks(), BlockKey{BlockKind::Pose, landmark.anchor});
    anchor_blocks_.push_back(static_cast<std::size_t>(block - blocks().begin()));
  }
}

bool DepthFactor::marginalized_with(const std::set<BlockKey>& leaving) const {
  return poses_ == 1 && leaving.contains(blocks()[1]);
}

bool DepthFactor::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const auto jacobian = [&](std::size_t block) { return jacobians == nullptr ? nullptr : jacobians[block]; };
  for (std::size_t i = 0; i < poses_; ++i) {
    if (double* J = jacobian(1 + i)) std::fill_n(J, 7, 0.0);
  }
  const bool log_form = residual_ == DepthResidual::Log;
  const double share = 1.0 / static_cast<double>(landmarks_.size());
  const SE3 T_O_B1 = pose_of(blocks[1]);
  double mean = 0.0;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const DepthLandmark& landmark = landmarks_[i];
    const std::size_t anchor = anchor_blocks_[i], depth = 1 + poses_ + i;
    const auto ln = log_inverse_depth(landmark, T_O_B1, pose_of(blocks[anchor]), blocks[depth][0], t_B_E_, z_E_in_B_);
    if (!ln) return false;
    const double value = log_form ? ln->value : std::exp(ln->value);
    mean += share * value;
    const double slope = weight_ * share * (log_form ? 1.0 : value);  // of the residual over ln 1/z_i
    using Tangent = Eigen::Map<Eigen::Matrix<double, 1, 6>>;
    if (double* J = jacobian(1)) Tangent(J) += slope * ln->d_observer;
    if (double* J = jacobian(anchor)) Tangent(J) += slope * ln->d_anchor;
    if (double* J = jacobian(depth)) *J = slope * ln->d_rho;
  }
  const double ln_s = blocks[0][0], scaled = std::exp(ln_s) * rho_source_;
  residuals[0] = weight_ * (log_form ? mean - ln_s - std::log(rho_source_) : mean - scaled);
  if (double* J = jacobian(0)) *J = -weight_ * (log_form ? 1.0 : scaled);
  return true;
}

}  // namespace edged
