// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/covariance.hpp"

#include <gtest/gtest.h>

#include "edged/estimator/solver/marginalization.hpp"
#include "edged/estimator/solver/normal_equations.hpp"
#include "edged/estimator/solver/sliding.hpp"
#include "edged/estimator/test_world.hpp"
#include "edged/estimator/window/landmarks.hpp"

namespace edged {
namespace {

TEST(Covariance, IsTheInverseOfWhatMarginalisationLeavesOfAState) {
  TestWorld world({});
  Window window = inertial_window(world);
  const StateId newest = window.newest_id();
  const std::optional<Matrix15d> P = covariance(window, newest);
  ASSERT_TRUE(P);

  const Cost cost = cost_of(window);
  std::set<BlockKey> others = blocks_of(cost);
  others.erase({BlockKind::Pose, newest});
  others.erase({BlockKind::Motion, newest});
  const LinearPrior left = marginalize(window, cost, others);
  const Matrix15d product = left.J.transpose() * left.J * *P;
  EXPECT_LT((product - Matrix15d::Identity()).cwiseAbs().maxCoeff(), 1e-4);
}

/// Scales the window about a point.
void rescale(Window& window, const Eigen::Vector3d& about, double factor) {
  for (const auto& [id, state] : window.states()) {
    const Eigen::Vector3d step = (factor - 1.0) * (state.T_O_B().translation() - about);
    const Eigen::Vector3d dv = (factor - 1.0) * state.nav().v_O;
    window.move({BlockKind::Pose, id}, std::array{step.x(), step.y(), step.z(), 0.0, 0.0, 0.0});
    window.move({BlockKind::Motion, id}, std::array{dv.x(), dv.y(), dv.z(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0});
  }
  for (const auto& [id, feature] : window.features())
    if (feature.anchor)
      window.move({BlockKind::InverseDepth, id}, std::array{(1.0 / factor - 1.0) * feature.inverse_depth});
}

/// Of a motion too gentle for the IMU the scale changes a lot. Jacobians at first estimates, which mix both scales,
/// took that for information on it.
TEST(Covariance, OfTheScaleStaysWhereTheScaleChanges) {
  const TestWorldOptions options{.pixel_noise = 0.1};
  const auto sigma_after = [&](double rescaled) {
    TestWorld world(options);
    Window window = tracked_window(world, options, 6);
    window.set_imu_noise_scale(1e4);
    triangulate_features(window, {});
    const Eigen::Vector3d start = window.states().begin()->second.T_O_B().translation();
    const auto add = [&](double scale) {
      const double t = to_seconds(window.newest().t) + kTrackedPeriod_s;
      const EstimatorInput input = world.packet(t, kTrackedPeriod_s, true);
      OdomState nav = true_state(world, t, options.bias_gyro, options.bias_accel).nav();
      nav.T_O_B = SE3(nav.T_O_B.rotation(), start + scale * (nav.T_O_B.translation() - start));
      nav.v_O *= scale;
      window.add_state(window_state(nav, {}, input.motion.reintegrated(options.bias_gyro, options.bias_accel), true),
                       input.observations);
      drop_oldest_keyframe(window, {});
    };
    for (int i = 0; i < 3; ++i) add(1.0);
    rescale(window, start, rescaled);
    for (int i = 0; i < 2; ++i) add(rescaled);
    const Eigen::Vector3d way = window.newest().T_O_B().translation() - start;
    return std::sqrt(way.dot(covariance(window, window.newest_id()).value().topLeftCorner<3, 3>() * way)) /
           way.squaredNorm();
  };
  const double same = sigma_after(1.0), rescaled = sigma_after(1.5);
  EXPECT_GT(rescaled, 0.3 * same);
}

/// By landmarks alone, all of them so many times farther away than they are: the sum over the positions of the states.
double information_on_positions(double farther, Purpose purpose) {
  const TestWorldOptions options{.pixel_noise = 0.1};
  TestWorld world(options);
  Window window = tracked_window(world, options, 6);
  triangulate_features(window, {});
  for (const auto& [id, feature] : window.features())
    if (feature.anchor)
      window.move({BlockKind::InverseDepth, id}, std::array{(1.0 / farther - 1.0) * feature.inverse_depth});
  Cost cost = cost_of(window);
  const Layout layout(blocks_of(cost));
  cost.prior.reset();
  cost.factors.clear();
  const Eigen::MatrixXd H = normal_equations(window, cost, layout, nullptr, purpose).H.dense();
  double sum = 0.0;
  for (const auto& [id, state] : window.states())
    sum += H.diagonal().segment<3>(layout.offset.at({BlockKind::Pose, id})).sum();
  return sum;
}

TEST(Covariance, TakesLittleOnTranslationsFromDepthsThatAreHardlyKnown) {
  EXPECT_NEAR(information_on_positions(1.0, Purpose::Information) / information_on_positions(1.0, Purpose::Solution),
              1.0, 0.02);
  EXPECT_GT(information_on_positions(1e4, Purpose::Solution), 1e-4);
  EXPECT_NEAR(information_on_positions(1e4, Purpose::Information), 0.0, 1e-9);
}

TEST(Covariance, IsNothingWhenADirectionIsNotDetermined) {
  TestWorld world({});
  const Window window = inertial_window(world, Gauge::Free);
  EXPECT_FALSE(covariance(window, window.newest_id()));
}

}  // namespace
}  // namespace edged
