// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The observation of a landmark as a cost function of Ceres: for tests, where Ceres is the oracle.
#pragma once

#include <ceres/cost_function.h>

#include <optional>

#include "edged/estimator/factors/blocks.hpp"
#include "edged/estimator/factors/landmark_factor.hpp"

namespace edged {

struct LandmarkView {
  Eigen::Vector2d point;  ///< on the unit plane
  BodyRate rate;
};

/// Blocks: poses of the anchor, of the observing state and, with one, of the observation before; calibration of the
/// camera; inverse depth. Residual (2): (e - correlation * e_before) / sigma.
class LandmarkCost final : public ceres::CostFunction {
 public:
  LandmarkCost(const SE3& T_B_C, const LandmarkView& anchor, const LandmarkView& seen, double sigma,
               const std::optional<LandmarkView>& before = std::nullopt, double correlation = 0.0)
      : T_B_C_(T_B_C), anchor_(anchor), seen_(seen), before_(before), correlation_(correlation), weight_(1.0 / sigma) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = before ? std::vector<int>{7, 7, 7, 4, 1} : std::vector<int>{7, 7, 4, 1};
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const std::size_t calibration = before_ ? 3 : 2;
    const CameraOnBody camera(T_B_C_, blocks[calibration]);
    const auto at = [&](std::size_t pose, const LandmarkView& view) {
      return CameraAt(camera, pose_of(blocks[pose]), view.rate);
    };
    const CameraAt anchor = at(0, anchor_);
    const AnchoredLandmark anchored(camera, anchor, anchor_.point, *blocks[calibration + 1]);
    const LandmarkDerivatives landmark(anchored);
    ObservationError now, before;
    if (!landmark.error(at(1, seen_), seen_.point, now)) return false;
    if (before_ && !landmark.error(at(2, *before_), before_->point, before)) return false;
    const double of_before = before_ ? -correlation_ * weight_ : 0.0;
    if (!before_) before = now;
    Eigen::Map<Eigen::Vector2d>{residuals} = weight_ * now.e + of_before * before.e;
    if (jacobians == nullptr) return true;
    write_pose(jacobians[0], weight_ * now.by_anchor + of_before * before.by_anchor);
    write_pose(jacobians[1], weight_ * now.by_seen);
    if (before_) write_pose(jacobians[2], of_before * before.by_seen);
    if (double* J = jacobians[calibration]) {
      Eigen::Map<Eigen::Matrix<double, 2, 4, Eigen::RowMajor>>{J} =
          weight_ * now.by_calibration + of_before * before.by_calibration;
    }
    if (double* J = jacobians[calibration + 1]) {
      Eigen::Map<Eigen::Vector2d>{J} = weight_ * now.by_rho + of_before * before.by_rho;
    }
    return true;
  }

 private:
  static void write_pose(double* jacobian, const Eigen::Matrix<double, 2, 6>& by_pose) {
    if (jacobian == nullptr) return;
    Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>>{jacobian} << by_pose, Eigen::Vector2d::Zero();
  }

  SE3 T_B_C_;
  LandmarkView anchor_, seen_;
  std::optional<LandmarkView> before_;
  double correlation_, weight_;
};

}  // namespace edged
