// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/landmark_factor.hpp"

#include <gtest/gtest.h>

#include "edged/camera/intrinsics.hpp"
#include "edged/estimator/factors/test_jacobians.hpp"
#include "edged/estimator/factors/test_landmark_cost.hpp"

namespace edged {
namespace {

const std::vector<double> kExact(kCalibrationSize, 0.0);
const std::vector<double> kOff{0.03, -0.02, 0.04, 0.012, 0.02, -0.01, 0.015, 0.01, -0.02, 0.005, -0.008, 0.02, -0.015};
static_assert(kCalibrationSize == 13, "one number here, and in every list of these tests");
ByIntrinsics by_intrinsics_of(const CameraModel& camera, const Eigen::Vector2d& point) {
  return point_by_intrinsics(camera, camera, point);
}
const ByIntrinsics kBy = by_intrinsics_of(
    CameraModel(240, 180, 200, 190, 119.5, 91.0, DistortionModel::RadTan, {-0.37, 0.15, -3e-4, -7e-4, 0.0}),
    {0.2, -0.1});
const ByIntrinsics kByOther = by_intrinsics_of(
    CameraModel(240, 180, 180, 185, 124.5, 90.0, DistortionModel::RadTan, {-0.3, 0.1, 2e-4, 4e-4, 0.0}), {0.25, -0.05});

TEST(LandmarkFactor, JacobiansMatchCentralDifferences) {
  const SE3 T_B_C(so3::exp({0.02, -0.01, 1.5}), {0.05, -0.02, 0.03});
  const BodyRate rate_0{{0.5, -1.2, 0.8}, {1.0, -0.4, 0.3}}, rate_1{{-0.7, 0.9, 0.4}, {0.8, 0.2, -0.6}};
  for (const double rho : {0.02, 0.5, 2.0}) {
    const LandmarkCost factor({T_B_C}, {{{0.2, -0.1}, rate_0, 0, 0, kBy}, {{0.25, -0.05}, rate_1, 1, 0, kByOther}},
                              5e-3);
    for (const auto& calibration : {kExact, kOff}) {
      check_jacobians(factor, {BlockKind::Pose, BlockKind::Pose, BlockKind::Calibration, BlockKind::InverseDepth},
                      {pose_block({0.1, 0.2, -0.1}, {1, 0.5, 0.2}),
                       pose_block({0.15, 0.15, -0.05}, {1.1, 0.45, 0.22}),
                       calibration,
                       {rho}});
    }
  }
}

TEST(LandmarkFactor, JacobiansBesideAnObservationBeforeMatchCentralDifferences) {
  const SE3 T_B_C(so3::exp({0.02, -0.01, 1.5}), {0.05, -0.02, 0.03});
  const BodyRate rate_0{{0.5, -1.2, 0.8}, {1.0, -0.4, 0.3}}, rate_1{{-0.7, 0.9, 0.4}, {0.8, 0.2, -0.6}},
      rate_2{{0.3, 0.2, -0.9}, {-0.5, 0.7, 0.1}};
  for (const double rho : {0.02, 0.5, 2.0}) {
    const LandmarkCost factor(
        {T_B_C},
        {{{0.2, -0.1}, rate_0, 0, 0, kBy}, {{0.25, -0.05}, rate_1, 1, 0, kByOther}, {{0.22, -0.08}, rate_2, 2, 0, kBy}},
        5e-3, 0.9);
    check_jacobians(
        factor, {BlockKind::Pose, BlockKind::Pose, BlockKind::Pose, BlockKind::Calibration, BlockKind::InverseDepth},
        {pose_block({0.1, 0.2, -0.1}, {1, 0.5, 0.2}),
         pose_block({0.15, 0.15, -0.05}, {1.1, 0.45, 0.22}),
         pose_block({0.12, 0.18, -0.08}, {1.05, 0.48, 0.21}),
         kOff,
         {rho}});
  }
}

TEST(LandmarkFactor, JacobiansOfAnotherCameraMatchCentralDifferences) {
  const std::vector<SE3> T_B_C = {SE3(so3::exp({0.02, -0.01, 1.5}), {0.05, -0.02, 0.03}),
                                  SE3(so3::exp({-0.03, 0.04, 1.4}), {-0.06, 0.01, 0.02})};
  const std::vector<double> one = kOff,
                            other{-0.01, 0.03, 0.02, -0.008, 0.01, 0.02, -0.03, -0.01, 0.01, 0.004, 0.007, 0.03, -0.02};
  const BodyRate rate_0{{0.5, -1.2, 0.8}, {1.0, -0.4, 0.3}}, rate_1{{-0.7, 0.9, 0.4}, {0.8, 0.2, -0.6}},
      rate_2{{0.3, 0.2, -0.9}, {-0.5, 0.7, 0.1}};
  const auto pose_0 = pose_block({0.1, 0.2, -0.1}, {1, 0.5, 0.2}),
             pose_1 = pose_block({0.15, 0.15, -0.05}, {1.1, 0.45, 0.22}),
             pose_2 = pose_block({0.12, 0.18, -0.08}, {1.05, 0.48, 0.21});
  constexpr BlockKind kPose = BlockKind::Pose, kCalibration = BlockKind::Calibration, kRho = BlockKind::InverseDepth;
  const LandmarkView anchor{{0.2, -0.1}, rate_0, 0, 0, kBy}, same_instant{{0.25, -0.05}, rate_0, 0, 1, kByOther},
      later{{0.25, -0.05}, rate_1, 1, 1, kByOther}, before{{0.22, -0.08}, rate_2, 2, 1, kBy},
      before_at_anchor{{0.2, 0.0}, rate_0, 0, 1, kByOther};
  for (const double rho : {0.02, 0.5, 2.0}) {
    check_jacobians(LandmarkCost(T_B_C, {anchor, same_instant}, 5e-3), {kPose, kCalibration, kCalibration, kRho},
                    {pose_0, one, other, {rho}});
    check_jacobians(LandmarkCost(T_B_C, {anchor, later}, 5e-3), {kPose, kPose, kCalibration, kCalibration, kRho},
                    {pose_0, pose_1, one, other, {rho}});
    check_jacobians(LandmarkCost(T_B_C, {anchor, later, before}, 5e-3, 0.9),
                    {kPose, kPose, kPose, kCalibration, kCalibration, kRho},
                    {pose_0, pose_1, pose_2, one, other, {rho}});
    check_jacobians(LandmarkCost(T_B_C, {anchor, later, before_at_anchor}, 5e-3, 0.9),
                    {kPose, kPose, kCalibration, kCalibration, kRho}, {pose_0, pose_1, one, other, {rho}});
  }
}

TEST(LandmarkFactor, ChargesATrackForADriftOnce) {
  const SE3 T_B_C;
  const auto anchor = pose_block({0, 0, 0}, {0, 0, 0}), before = pose_block({0, 0, 0}, {0.1, 0, 0}),
             seen = pose_block({0, 0, 0}, {0.2, 0, 0});
  const Eigen::Vector2d drift(3e-3, -1e-3);
  const auto view = [&](double x, std::size_t pose) {
    return LandmarkView{Eigen::Vector2d(0.1 - x, 0.2) + drift, {}, pose};
  };
  const LandmarkCost factor({T_B_C}, {{{0.1, 0.2}, {}, 0}, view(0.2 * 0.5, 1), view(0.1 * 0.5, 2)}, 1e-3, 0.9);
  const Eigen::VectorXd r = evaluate(factor, {anchor, seen, before, kExact, {0.5}});
  EXPECT_LT((r + 0.1 * drift / 1e-3).norm(), 1e-9);
}

TEST(LandmarkFactor, IsZeroForAPointWhereItWasSeen) {
  const SE3 T_B_C(so3::exp({0.02, -0.01, 1.5}), {0.05, -0.02, 0.03});
  const auto pose_0 = pose_block({0.1, 0.2, -0.1}, {1, 0.5, 0.2}),
             pose_1 = pose_block({0.15, 0.15, -0.05}, {1.1, 0.45, 0.22});
  const Eigen::Vector3d p_O = pose_of(pose_0.data()) * T_B_C * Eigen::Vector3d(0.4, -0.2, 2.0);
  const Eigen::Vector3d p_C1 = (pose_of(pose_1.data()) * T_B_C).inverse() * p_O;
  const LandmarkCost factor({T_B_C}, {{{0.2, -0.1}, {}, 0}, {p_C1.hnormalized(), {}, 1}}, 5e-3);
  EXPECT_LT(evaluate(factor, {pose_0, pose_1, kExact, {0.5}}).norm(), 1e-9);
}

TEST(LandmarkFactor, IsZeroForAPointSeenLaterByATurnedCamera) {
  const SE3 T_B_C(so3::exp({0.02, -0.01, 1.5}), {0.05, -0.02, 0.03});
  const auto pose_0 = pose_block({0.1, 0.2, -0.1}, {1, 0.5, 0.2}),
             pose_1 = pose_block({0.15, 0.15, -0.05}, {1.1, 0.45, 0.22});
  const BodyRate rate_0{{0.5, -1.2, 0.8}, {1.0, -0.4, 0.3}}, rate_1{{-0.7, 0.9, 0.4}, {0.8, 0.2, -0.6}};
  const std::vector<double> calibration = kOff;
  const SE3 T_O_C0 = camera_pose(pose_of(pose_0.data()), rate_0, T_B_C, calibration.data());
  const SE3 T_O_C1 = camera_pose(pose_of(pose_1.data()), rate_1, T_B_C, calibration.data());
  const Eigen::Vector3d p_C1 = T_O_C1.inverse() * (T_O_C0 * Eigen::Vector3d(0.4, -0.2, 2.0));
  const LandmarkCost factor({T_B_C}, {{{0.2, -0.1}, rate_0, 0}, {p_C1.hnormalized(), rate_1, 1}}, 5e-3);
  EXPECT_LT(evaluate(factor, {pose_0, pose_1, calibration, {0.5}}).norm(), 1e-9);
}

TEST(LandmarkFactor, RefusesAPointBehindTheCamera) {
  const LandmarkCost factor({SE3()}, {{{0.0, 0.0}, {}, 0}, {{0.0, 0.0}, {}, 1}}, 5e-3);
  const auto here = pose_block({0, 0, 0}, {0, 0, 0}), turned = pose_block({0, 3.1, 0}, {0, 0, 0});
  const double rho = 1.0;
  const CalibrationBlock exact{};
  const double* blocks[] = {here.data(), turned.data(), exact.data(), &rho};
  double r[2];
  EXPECT_FALSE(factor.Evaluate(blocks, r, nullptr));
}

}  // namespace
}  // namespace edged
