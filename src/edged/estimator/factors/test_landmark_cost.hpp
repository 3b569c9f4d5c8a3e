// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The observation of a landmark as a cost function of Ceres: for tests, where Ceres is the oracle.
#pragma once

#include <ceres/cost_function.h>

#include <algorithm>
#include <vector>

#include "edged/estimator/factors/blocks.hpp"
#include "edged/estimator/factors/landmark_factor.hpp"

namespace edged {

struct LandmarkView {
  Eigen::Vector2d point;  ///< on the unit plane
  BodyRate rate;
  std::size_t pose = 0;    ///< index of its state among the poses
  std::size_t camera = 0;  ///< index among the cameras
  ByIntrinsics by_intrinsics = ByIntrinsics::Zero();
  ImagePoint image_point() const { return {point, by_intrinsics}; }
};

/// Blocks: poses; calibrations of the cameras; inverse depth. Views: the anchor's, the observation, and with one the
/// observation before. Residual (2): (e - correlation * e_before) / sigma.
class LandmarkCost final : public ceres::CostFunction {
 public:
  /// T_B_C: of the cameras.
  LandmarkCost(std::vector<SE3> T_B_C, std::vector<LandmarkView> views, double sigma, double correlation = 0.0)
      : T_B_C_(std::move(T_B_C)), views_(std::move(views)), weights_{0.0, 1.0 / sigma, -correlation / sigma} {
    for (const LandmarkView& view : views_) poses_ = std::max(poses_, view.pose + 1);
    set_num_residuals(2);
    std::vector<int>& sizes = *mutable_parameter_block_sizes();
    sizes.assign(poses_, 7);
    sizes.insert(sizes.end(), T_B_C_.size(), kCalibrationSize);
    sizes.push_back(1);
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    std::vector<CameraOnBody> cameras;
    for (std::size_t i = 0; i < T_B_C_.size(); ++i) cameras.emplace_back(T_B_C_[i], blocks[poses_ + i]);
    std::vector<CameraAt> at;
    for (const LandmarkView& view : views_) {
      at.emplace_back(cameras[view.camera], pose_of(blocks[view.pose]), view.rate);
    }
    const std::size_t depth = poses_ + cameras.size();
    const CameraView anchor{cameras[views_[0].camera], at[0]};
    const ImagePoint point = views_[0].image_point();  // must outlive the landmark
    const AnchoredLandmark anchored(anchor, point, *blocks[depth]);
    const LandmarkDerivatives landmark(anchored, anchored.rho);
    const auto jacobian = [&](std::size_t block) { return jacobians == nullptr ? nullptr : jacobians[block]; };
    for (std::size_t i = 0; i <= depth; ++i) {
      if (double* J = jacobian(i)) std::fill_n(J, 2 * parameter_block_sizes()[i], 0.0);
    }
    Eigen::Map<Eigen::Vector2d> r(residuals);
    r.setZero();
    for (std::size_t i = 1; i < views_.size(); ++i) {
      const LandmarkView& view = views_[i];
      ObservationError error;
      if (!landmark.error({cameras[view.camera], at[i]}, view.image_point(), error)) return false;
      r += weights_[i] * error.e;
      using OfCalibration = Eigen::Map<Eigen::Matrix<double, 2, kCalibrationSize, Eigen::RowMajor>>;
      add_pose(jacobian(views_[0].pose), weights_[i] * error.by_anchor);
      add_pose(jacobian(view.pose), weights_[i] * error.by_seen);
      if (double* J = jacobian(poses_ + views_[0].camera)) {
        OfCalibration(J) += weights_[i] * error.by_anchor_calibration;
      }
      const bool other = view.camera != views_[0].camera;
      if (double* J = other ? jacobian(poses_ + view.camera) : nullptr)
        OfCalibration(J) += weights_[i] * error.by_seen_calibration;
      if (double* J = jacobian(depth)) Eigen::Map<Eigen::Vector2d>(J) += weights_[i] * error.by_rho;
    }
    return true;
  }

 private:
  static void add_pose(double* jacobian, const Eigen::Matrix<double, 2, 6>& by_pose) {
    if (jacobian == nullptr) return;
    Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>>{jacobian}.leftCols<6>() += by_pose;
  }

  std::vector<SE3> T_B_C_;
  std::vector<LandmarkView> views_;
  double weights_[3];
  std::size_t poses_ = 0;
};

}  // namespace edged
