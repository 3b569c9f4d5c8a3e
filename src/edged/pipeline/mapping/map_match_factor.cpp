// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/mapping/map_match_factor.hpp"

#include <vector>

#include "edged/map/tuning.hpp"

namespace edged {
namespace {

using PoseJacobian = Eigen::Matrix<double, 2, 7, Eigen::RowMajor>;

std::vector<BlockKey> blocks_of(const MatchedImage& image, const MatchedKeyframe& keyframe) {
  std::vector<BlockKey> blocks = {{BlockKind::Pose, image.state}};
  if (keyframe.state) blocks.push_back({BlockKind::Pose, *keyframe.state});
  return blocks;
}

}  // namespace

MapMatchFactor::MapMatchFactor(const MatchedImage& image, const MatchedKeyframe& keyframe,
                               const MapObservation& observation, const Eigen::Matrix2d& whiten, double share)
    : Factor(2, blocks_of(image, keyframe)),
      T_A_B_(image.T_A_B),
      T_B_C_(image.T_B_C),
      T_O_K_(keyframe.T_O_K),
      observation_(observation),
      whiten_(whiten),
      loss_(new ceres::CauchyLoss(kMapTuning.cauchy_sigmas), share, ceres::TAKE_OWNERSHIP) {}

bool MapMatchFactor::Evaluate(double const* const* values, double* residuals, double** jacobians) const {
  const SE3 T_O_A = pose_of(values[0]);
  const SE3 T_O_K = blocks().size() > 1 ? pose_of(values[1]) : T_O_K_;
  const auto row = linearised(observation_, T_O_A * T_A_B_, T_O_K, T_B_C_);
  if (!row) return false;
  Eigen::Map<Eigen::Vector2d>{residuals} = whiten_ * row->r;
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) {
    Eigen::Map<PoseJacobian> J(jacobians[0]);
    J.leftCols<6>() = whiten_ * row->by_body * transport(T_O_A, T_A_B_);
    J.col(6).setZero();
  }
  if (blocks().size() > 1 && jacobians[1] != nullptr) {
    Eigen::Map<PoseJacobian> J(jacobians[1]);
    J.leftCols<6>() = whiten_ * row->by_keyframe;
    J.col(6).setZero();
  }
  return true;
}

}  // namespace edged
