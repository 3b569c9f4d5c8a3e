// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Every factor's analytic Jacobian against central differences over its tangent spaces.
#include <gtest/gtest.h>

#include <random>

#include "edged/estimator/factors/depth_factor.hpp"
#include "edged/estimator/factors/imu_factor.hpp"
#include "edged/estimator/factors/linear_prior.hpp"
#include "edged/estimator/factors/standstill_factor.hpp"
#include "edged/estimator/factors/test_jacobians.hpp"
#include "edged/estimator/factors/test_landmark_cost.hpp"

namespace edged {
namespace {

std::vector<double> pose(const Eigen::Vector3d& phi, const Eigen::Vector3d& p) {
  const PoseBlock block = to_block(SE3(so3::exp(phi), p));
  return {block.begin(), block.end()};
}

Preintegration some_motion() {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 40; ++i) {
    const double t = 0.005 * i;
    samples.push_back({timestamp_from_seconds(t), {0.8 + t, -0.5, 0.3 * t}, {0.4, 9.6 - t, 1.5 + 2 * t}});
  }
  return {samples, {0.01, -0.02, 0.03}, {0.1, 0.05, -0.1}, ImuNoise{}};
}

TEST(ImuFactor, JacobiansMatchCentralDifferences) {
  const Preintegration imu = some_motion();
  const ImuFactor factor(0, 1, imu);
  const std::vector<double> intrinsics = {3e-3, -2e-3, 1e-3,  2e-3, -4e-3, 1e-3,  0.5e-3, -1e-3, 2e-3,
                                          1e-3, 2e-3,  -3e-3, 1e-3, 5e-3,  -2e-3, 1e-3,   2e-3,  -1e-3};
  check_jacobians(factor,
                  {BlockKind::Pose, BlockKind::Motion, BlockKind::Pose, BlockKind::Motion, BlockKind::ImuIntrinsics},
                  {pose({0.3, -0.8, 0.2}, {1, 2, 3}),
                   {0.4, -0.3, 0.2, 0.02, -0.01, 0.025, 0.12, 0.02, -0.05},
                   pose({0.45, -0.85, 0.25}, {1.1, 1.9, 3.05}),
                   {0.5, -0.2, 0.3, 0.021, -0.012, 0.026, 0.13, 0.03, -0.06},
                   intrinsics});
}

TEST(ImuFactor, IsZeroForTheMotionThatWasMeasured) {
  const Preintegration imu = some_motion();
  OdomState start;
  start.T_O_B = SE3(so3::exp({0.3, -0.8, 0.2}), {1, 2, 3});
  start.v_O = {0.4, -0.3, 0.2};
  start.bias_gyro = imu.bias_gyro();
  start.bias_accel = imu.bias_accel();
  const OdomState end = propagate(start, imu);
  const auto motion = [](const OdomState& s) {
    return std::vector<double>{s.v_O.x(),       s.v_O.y(),        s.v_O.z(),        s.bias_gyro.x(), s.bias_gyro.y(),
                               s.bias_gyro.z(), s.bias_accel.x(), s.bias_accel.y(), s.bias_accel.z()};
  };
  const auto block = [](const SE3& T) {
    const PoseBlock b = to_block(T);
    return std::vector<double>(b.begin(), b.end());
  };
  const Eigen::VectorXd r = evaluate(ImuFactor(0, 1, imu), {block(start.T_O_B), motion(start), block(end.T_O_B),
                                                            motion(end), std::vector<double>(18, 0.0)});
  EXPECT_LT(r.cwiseAbs().maxCoeff(), 1e-5);  // in standard deviations
}

TEST(StandstillFactor, JacobiansMatchCentralDifferences) {
  check_jacobians(StandstillFactor(0, 1), {BlockKind::Pose, BlockKind::Pose},
                  {pose({0.3, -0.8, 0.2}, {1, 2, 3}), pose({0.35, -0.7, 0.25}, {1.1, 1.9, 3.05})});
}

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
      check_jacobians(
          factor, {BlockKind::Pose, BlockKind::Pose, BlockKind::Calibration, BlockKind::InverseDepth},
          {pose({0.1, 0.2, -0.1}, {1, 0.5, 0.2}), pose({0.15, 0.15, -0.05}, {1.1, 0.45, 0.22}), calibration, {rho}});
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
        {pose({0.1, 0.2, -0.1}, {1, 0.5, 0.2}),
         pose({0.15, 0.15, -0.05}, {1.1, 0.45, 0.22}),
         pose({0.12, 0.18, -0.08}, {1.05, 0.48, 0.21}),
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
  const auto pose_0 = pose({0.1, 0.2, -0.1}, {1, 0.5, 0.2}), pose_1 = pose({0.15, 0.15, -0.05}, {1.1, 0.45, 0.22}),
             pose_2 = pose({0.12, 0.18, -0.08}, {1.05, 0.48, 0.21});
  constexpr BlockKind kPose = BlockKind::Pose, kCalibration = BlockKind::Calibration, kDepth = BlockKind::InverseDepth;
  const LandmarkView anchor{{0.2, -0.1}, rate_0, 0, 0, kBy}, same_instant{{0.25, -0.05}, rate_0, 0, 1, kByOther},
      later{{0.25, -0.05}, rate_1, 1, 1, kByOther}, before{{0.22, -0.08}, rate_2, 2, 1, kBy},
      before_at_anchor{{0.2, 0.0}, rate_0, 0, 1, kByOther};
  for (const double rho : {0.02, 0.5, 2.0}) {
    check_jacobians(LandmarkCost(T_B_C, {anchor, same_instant}, 5e-3), {kPose, kCalibration, kCalibration, kDepth},
                    {pose_0, one, other, {rho}});
    check_jacobians(LandmarkCost(T_B_C, {anchor, later}, 5e-3), {kPose, kPose, kCalibration, kCalibration, kDepth},
                    {pose_0, pose_1, one, other, {rho}});
    check_jacobians(LandmarkCost(T_B_C, {anchor, later, before}, 5e-3, 0.9),
                    {kPose, kPose, kPose, kCalibration, kCalibration, kDepth},
                    {pose_0, pose_1, pose_2, one, other, {rho}});
    check_jacobians(LandmarkCost(T_B_C, {anchor, later, before_at_anchor}, 5e-3, 0.9),
                    {kPose, kPose, kCalibration, kCalibration, kDepth}, {pose_0, pose_1, one, other, {rho}});
  }
}

TEST(LandmarkFactor, ChargesATrackForADriftOnce) {
  const SE3 T_B_C;
  const auto anchor = pose({0, 0, 0}, {0, 0, 0}), before = pose({0, 0, 0}, {0.1, 0, 0}),
             seen = pose({0, 0, 0}, {0.2, 0, 0});
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
  const auto pose_0 = pose({0.1, 0.2, -0.1}, {1, 0.5, 0.2}), pose_1 = pose({0.15, 0.15, -0.05}, {1.1, 0.45, 0.22});
  const Eigen::Vector3d p_O = pose_of(pose_0.data()) * T_B_C * Eigen::Vector3d(0.4, -0.2, 2.0);
  const Eigen::Vector3d p_C1 = (pose_of(pose_1.data()) * T_B_C).inverse() * p_O;
  const LandmarkCost factor({T_B_C}, {{{0.2, -0.1}, {}, 0}, {p_C1.hnormalized(), {}, 1}}, 5e-3);
  EXPECT_LT(evaluate(factor, {pose_0, pose_1, kExact, {0.5}}).norm(), 1e-9);
}

TEST(LandmarkFactor, IsZeroForAPointSeenLaterByATurnedCamera) {
  const SE3 T_B_C(so3::exp({0.02, -0.01, 1.5}), {0.05, -0.02, 0.03});
  const auto pose_0 = pose({0.1, 0.2, -0.1}, {1, 0.5, 0.2}), pose_1 = pose({0.15, 0.15, -0.05}, {1.1, 0.45, 0.22});
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
  const auto here = pose({0, 0, 0}, {0, 0, 0}), turned = pose({0, 3.1, 0}, {0, 0, 0});
  const double rho = 1.0;
  const CalibrationBlock exact{};
  const double* blocks[] = {here.data(), turned.data(), exact.data(), &rho};
  double r[2];
  EXPECT_FALSE(factor.Evaluate(blocks, r, nullptr));
}

constexpr BlockKey kScale{BlockKind::LogScale, 0};

/// Three landmarks of two cameras, anchored in the observing state and in two others.
struct DepthScene {
  SE3 T_B_E{so3::exp({0.02, -0.01, 1.5}), {0.05, -0.02, 0.03}}, T_B_F{so3::exp({-0.1, 0.05, 1.4}), {-0.04, 0.01, 0.0}};
  std::vector<DepthLandmark> landmarks = {
      {7, T_B_E, {0.2, -0.1}, 0}, {8, T_B_F, {-0.1, 0.15}, 1}, {9, T_B_E, {0.05, 0.0}, 2}};
  Blocks blocks = {{0.3},
                   pose({0.1, 0.2, -0.1}, {1, 0.5, 0.2}),
                   pose({0.15, 0.15, -0.05}, {1.1, 0.45, 0.22}),
                   pose({0.02, 0.25, -0.2}, {0.8, 0.6, 0.1}),
                   {0.5},
                   {0.02},
                   {2.0}};
};

TEST(DepthFactor, JacobiansMatchCentralDifferencesInBothForms) {
  const DepthScene scene;
  for (const DepthResidual form : {DepthResidual::Log, DepthResidual::Paper}) {
    const DepthFactor factor({form, 0, scene.T_B_E, 1.7, 2.5, 1.0}, kScale, scene.landmarks);
    check_jacobians(factor,
                    {BlockKind::LogScale, BlockKind::Pose, BlockKind::Pose, BlockKind::Pose, BlockKind::InverseDepth,
                     BlockKind::InverseDepth, BlockKind::InverseDepth},
                    scene.blocks);
  }
}

TEST(DepthFactor, IsZeroWhereTheSourceTimesItsScaleIsTheMiddleOfTheLandmarks) {
  const DepthScene scene;
  const std::vector<DepthLandmark> own = {scene.landmarks[0]};
  const double s = 1.4, depth = 2.0;  // of the only landmark, in its own anchor view
  for (const DepthResidual form : {DepthResidual::Log, DepthResidual::Paper}) {
    const DepthFactor factor({form, 0, scene.T_B_E, s * depth, 3.0, 1.0}, kScale, own);
    EXPECT_NEAR(evaluate(factor, {{std::log(s)}, scene.blocks[1], {1.0 / depth}})[0], 0.0, 1e-12);
  }
}

TEST(DepthFactor, GoesIntoThePriorWithItsStateOnlyIfItsLandmarksLeaveToo) {
  const DepthScene scene;
  const DepthMeasurement measured{DepthResidual::Log, 0, scene.T_B_E, 1.7, 2.5, 1.0};
  const std::set<BlockKey> leaving = {{BlockKind::Pose, 0}, {BlockKind::Motion, 0}, kScale};
  EXPECT_TRUE(DepthFactor(measured, kScale, {scene.landmarks[0]}).marginalized_with(leaving));
  EXPECT_FALSE(DepthFactor(measured, kScale, scene.landmarks).marginalized_with(leaving));
  EXPECT_FALSE(DepthFactor(measured, kScale, {scene.landmarks[0]}).marginalized_with({kScale}));
}

TEST(DepthFactor, RefusesALandmarkBehindTheCamera) {
  const DepthFactor factor({DepthResidual::Log, 0, SE3(), 1.0, 1.0, 1.0}, kScale, {{7, SE3(), {0.0, 0.0}, 1}});
  const double ln_s = 0.0, rho = 1.0;
  const auto turned = pose({0, 3.1, 0}, {0, 0, 0}), here = pose({0, 0, 0}, {0, 0, 0});
  const double* blocks[] = {&ln_s, turned.data(), here.data(), &rho};
  double r[1];
  EXPECT_FALSE(factor.Evaluate(blocks, r, nullptr));
}

TEST(RestPrior, IsWhatAnAccelerometerAtRestReadsToFirstOrder) {
  const Eigen::Vector3d accel_B(0.4, -0.3, 9.9);
  const SE3 upright(Eigen::Quaterniond::FromTwoVectors(accel_B, Eigen::Vector3d::UnitZ()), {1.0, 2.0, 3.0});
  const MotionBlock unbiased{};
  const LinearPrior prior =
      rest_prior({BlockKind::Pose, 0}, to_block(upright), {BlockKind::Motion, 0}, unbiased, accel_B, 0.5);
  const LinearPriorFactor factor(prior);
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d small = 1e-4 * Eigen::Vector3d::Unit(axis);
    const SE3 tilted(upright.rotation() * so3::exp(small), upright.translation());
    MotionBlock biased = unbiased;
    biased[static_cast<std::size_t>(6 + (axis + 1) % 3)] = 0.05;
    const PoseBlock pose = to_block(tilted);
    const double* blocks[] = {pose.data(), biased.data()};
    Eigen::Vector3d r;
    ASSERT_TRUE(factor.Evaluate(blocks, r.data(), nullptr));
    const Eigen::Vector3d bias = Eigen::Map<const Eigen::Vector3d>(biased.data() + 6);
    EXPECT_LT((r - (tilted.R().transpose() * -kGravity_W + bias - accel_B) / 0.5).norm(), 1e-6);
  }
}

TEST(LinearPriorFactor, JacobiansMatchCentralDifferencesAwayFromItsLinearisationPoint) {
  std::mt19937_64 random(7);
  const auto number = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 - 0.5; };
  LinearPrior prior;
  prior.blocks = {{BlockKind::Pose, 0}, {BlockKind::Motion, 0}};
  prior.x0 = {pose({0.1, 0.2, 0.3}, {1, 2, 3}), std::vector<double>(9, 0.1)};
  prior.J = Eigen::MatrixXd::NullaryExpr(12, 15, [&] { return number(); });
  prior.r = Eigen::VectorXd::NullaryExpr(12, [&] { return number(); });
  const LinearPriorFactor factor(prior);
  check_jacobians(factor, {BlockKind::Pose, BlockKind::Motion},
                  {pose({0.15, 0.1, 0.4}, {1.1, 2, 2.9}), std::vector<double>(9, 0.2)});
}

TEST(GaugePrior, SeesYawAndPositionButNotTilt) {
  const auto at = pose({0.4, -0.3, 0.8}, {1, 2, 3});
  PoseBlock block;
  std::copy(at.begin(), at.end(), block.begin());
  const LinearPrior prior = gauge_prior({BlockKind::Pose, 0}, block, 1e-2, 1e-2);
  const LinearPriorFactor factor(prior);
  const auto turned_about = [&](const Eigen::Vector3d& axis_O) {
    const PoseBlock b = to_block(SE3(so3::exp(1e-3 * axis_O) * pose_of(at.data()).rotation(), {1, 2, 3}));
    return evaluate(factor, {{b.begin(), b.end()}}).norm();
  };
  EXPECT_NEAR(turned_about(Eigen::Vector3d::UnitZ()), 0.1, 1e-6);
  EXPECT_NEAR(turned_about(Eigen::Vector3d::UnitX()), 0.0, 1e-4);
}

}  // namespace
}  // namespace edged
