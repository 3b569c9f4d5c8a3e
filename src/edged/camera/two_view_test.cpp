// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/two_view.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace edged {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Uniform in [-1, 1), the same on every standard library.
double uniform(std::mt19937_64& generator) { return static_cast<double>(generator() >> 11) * 0x1p-52 - 1.0; }

double gaussian(std::mt19937_64& generator) {
  const double u = 0.5 * (uniform(generator) + 1.0), v = uniform(generator);
  return std::sqrt(-2.0 * std::log(1.0 - u)) * std::cos(std::numbers::pi * v);
}

SE3 random_pose(std::mt19937_64& generator, double metres, double radians) {
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = uniform(generator) * (i < 3 ? metres : radians);
  return SE3::exp(xi);
}

View see(const SE3& T_A_C, const Vector3d& p_A) {
  const Vector3d p_C = T_A_C.inverse() * p_A;
  return {T_A_C, p_C.head<2>() / p_C.z()};
}

TEST(Triangulation, RecoversAPointSeenByTwoCameras) {
  std::mt19937_64 generator(1);
  for (int i = 0; i < 200; ++i) {
    const Vector3d p_A(uniform(generator), uniform(generator), 3.0 + uniform(generator));
    const std::vector<View> views = {see(random_pose(generator, 0.1, 0.2), p_A),
                                     see(SE3(Eigen::Quaterniond::Identity(), Vector3d(0.5, 0, 0)), p_A)};
    const auto found = triangulate(views);
    ASSERT_TRUE(found);
    EXPECT_LT((found->p_A - p_A).norm(), 1e-9);
    EXPECT_LT(found->rms_residual, 1e-10);
    const double parallax = ray_angle(views[0].point, (views[0].T_A_C.inverse() * views[1].T_A_C).R(), views[1].point);
    EXPECT_NEAR(found->parallax, parallax, 1e-12);
  }
}

TEST(Triangulation, RecoversAPointSeenByTenCameras) {
  std::mt19937_64 generator(2);
  const Vector3d p_A(0.3, -0.2, 2.5);
  std::vector<View> views;
  for (int i = 0; i < 10; ++i) views.push_back(see(random_pose(generator, 0.4, 0.3), p_A));
  const auto found = triangulate(views);
  ASSERT_TRUE(found);
  EXPECT_LT((found->p_A - p_A).norm(), 1e-9);
}

TEST(Triangulation, UnderNoiseIsAsGoodAsItsCovarianceSays) {
  constexpr double kSigma = 0.5 / 200.0;  // half a pixel
  constexpr int kRuns = 2000;
  std::mt19937_64 generator(3);
  const Vector3d p_A(0.2, 0.1, 2.0);
  std::vector<View> exact;
  for (int i = 0; i < 10; ++i) {
    exact.push_back(see(SE3(Eigen::Quaterniond::Identity(), Vector3d(-0.3 + 0.06 * i, 0.02 * i, 0)), p_A));
  }
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const View& view : exact) {
    const Vector3d p_C = view.T_A_C.inverse() * p_A;
    Eigen::Matrix<double, 2, 3> J;
    J << 1, 0, -p_C.x() / p_C.z(), 0, 1, -p_C.y() / p_C.z();
    J /= p_C.z();
    information += J.transpose() * J / (kSigma * kSigma);
  }
  const Eigen::Matrix3d covariance = information.inverse();
  Vector3d squared = Vector3d::Zero();
  double rms = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<View> noisy = exact;
    for (View& view : noisy) view.point += kSigma * Vector2d(gaussian(generator), gaussian(generator));
    const auto found = triangulate(noisy);
    ASSERT_TRUE(found);
    squared += (found->p_A - p_A).cwiseAbs2();
    rms += found->rms_residual;
  }
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(squared[i] / kRuns / covariance(i, i), 1.0, 0.15) << i;
  EXPECT_NEAR(rms / kRuns / kSigma, std::sqrt(17.0 / 20.0), 0.03);  // 20 residuals less three unknowns
}

TEST(Triangulation, ReachesTheMinimumOfTheResidualFromAPoorStart) {
  // Few degrees of parallax and much noise: the point nearest to the rays lies well before the best one.
  std::mt19937_64 generator(4);
  const Vector3d p_A(0.0, 0.0, 5.0);
  std::vector<View> views;
  for (int i = 0; i < 8; ++i) {
    views.push_back(see(SE3(Eigen::Quaterniond::Identity(), Vector3d(0.05 * i, 0, 0.1 * i)), p_A));
    views.back().point += 0.003 * Vector2d(gaussian(generator), gaussian(generator));
  }
  const auto found = triangulate(views);
  ASSERT_TRUE(found);
  const auto cost = [&](const Vector3d& p) {
    double sum = 0.0;
    for (const View& view : views) sum += (see(view.T_A_C, p).point - view.point).squaredNorm();
    return sum;
  };
  const double at_best = cost(found->p_A);
  EXPECT_NEAR(found->rms_residual, std::sqrt(at_best / 16.0), 1e-12);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double step : {-1e-3, 1e-3}) {
      EXPECT_GT(cost(found->p_A + step * Vector3d::Unit(axis)), at_best);
    }
  }
}

TEST(Triangulation, RefusesFewerThanTwoViews) {
  EXPECT_FALSE(triangulate({}));
  const std::vector<View> one = {{SE3(), Vector2d(0.1, 0.1)}};
  EXPECT_FALSE(triangulate(one));
}

TEST(Triangulation, RefusesLittleParallax) {
  const Vector3d p_A(0.0, 0.0, 10.0);
  const std::vector<View> views = {see(SE3(), p_A), see(SE3(Eigen::Quaterniond::Identity(), {0.05, 0, 0}), p_A)};
  EXPECT_FALSE(triangulate(views, 0.01));  // 0.005 rad
  EXPECT_TRUE(triangulate(views, 0.004));
  const std::vector<View> same = {views[0], views[0]};
  EXPECT_FALSE(triangulate(same));
  EXPECT_FALSE(triangulate(same, 0.0));
}

TEST(Triangulation, RefusesAPointBehindACamera) {
  // The rays diverge: they meet behind the cameras.
  const std::vector<View> views = {{SE3(), Vector2d(-0.2, 0.0)},
                                   {SE3(Eigen::Quaterniond::Identity(), {0.5, 0, 0}), Vector2d(0.2, 0.0)}};
  EXPECT_FALSE(triangulate(views));
}

TEST(RayAngle, IsTheAngleAfterRotation) {
  const Eigen::Matrix3d R = so3::exp(Vector3d(0, 0.3, 0)).toRotationMatrix();
  EXPECT_NEAR(ray_angle({0, 0}, R, {0, 0}), 0.3, 1e-14);
  EXPECT_NEAR(ray_angle({std::tan(0.3), 0}, R, {0, 0}), 0.0, 1e-14);
  EXPECT_NEAR(ray_angle({1, 0}, Eigen::Matrix3d::Identity(), {-1, 0}), std::numbers::pi / 2, 1e-14);
}

}  // namespace
}  // namespace edged
