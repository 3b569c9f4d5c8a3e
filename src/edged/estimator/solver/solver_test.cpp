// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The window's solver against Ceres, on the same terms.
#include "edged/estimator/solver/solver.hpp"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include "edged/estimator/factors/test_landmark_cost.hpp"
#include "edged/estimator/solver/normal_equations.hpp"
#include "edged/estimator/test_world.hpp"
#include "edged/estimator/window/cost.hpp"
#include "edged/estimator/window/landmarks.hpp"

namespace edged {
namespace {

// p' = p + d_p, q' = q * Exp(d_phi); derivatives by the tangent stand in the first six columns.
#if CERES_VERSION_MAJOR * 100 + CERES_VERSION_MINOR >= 201
constexpr auto kManifoldOwnership = &ceres::Problem::Options::manifold_ownership;

class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    std::copy_n(x, 7, x_plus_delta);
    plus(BlockKind::Pose, x_plus_delta, delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    tangent_difference(BlockKind::Pose, y, x, y_minus_x);
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
};
#else  // Ceres 2.0, that of Ubuntu 22.04
constexpr auto kManifoldOwnership = &ceres::Problem::Options::local_parameterization_ownership;

class PoseManifold final : public ceres::LocalParameterization {
 public:
  int GlobalSize() const override { return 7; }
  int LocalSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    std::copy_n(x, 7, x_plus_delta);
    plus(BlockKind::Pose, x_plus_delta, delta);
    return true;
  }
  bool ComputeJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>{jacobian}.setIdentity();
    return true;
  }
};
#endif

/// The blocks of the window, as parameters of Ceres.
class CeresBlocks {
 public:
  explicit CeresBlocks(const Window& window) : window_(window) {}

  double* at(BlockKey key) {
    const double* values = window_.block(key);
    return blocks_.try_emplace(key, values, values + block_size(key.kind)).first->second.data();
  }

 private:
  const Window& window_;
  std::map<BlockKey, std::vector<double>> blocks_;
};

/// The term's residuals as cost functions of Ceres.
void add_landmark(const Window& window, const LandmarkTerm& term, CeresBlocks& all, ceres::Problem& problem,
                  std::vector<std::unique_ptr<ceres::CostFunction>>& owned) {
  std::vector<StateId> poses;
  std::vector<std::size_t> cameras;
  const auto place_in = [](auto& known, auto value) {
    const auto found = std::ranges::find(known, value);
    const auto place = static_cast<std::size_t>(found - known.begin());
    if (found == known.end()) known.push_back(value);
    return place;
  };
  const auto view = [&](const ObservationKey& image, const ImagePoint& point) {
    const BodyRate rate = window.states().at(image.state).rate();
    const std::size_t pose = place_in(poses, image.state), camera = place_in(cameras, image.camera);
    return LandmarkView{point.at_zero, rate, pose, camera, point.by_intrinsics};
  };
  for (std::size_t i = 0; i < term.residuals.size(); ++i) {
    const LandmarkResidual& at = term.residuals[i];
    poses.clear(), cameras.clear();
    std::vector<LandmarkView> views = {view(term.anchor, term.point), view(at.seen, at.point)};
    if (at.correlation != 0.0) views.push_back(view(term.residuals[i - 1].seen, term.residuals[i - 1].point));
    std::vector<double*> blocks;
    std::vector<SE3> T_B_C;
    for (const StateId state : poses) blocks.push_back(all.at({BlockKind::Pose, state}));
    for (const std::size_t camera : cameras) {
      blocks.push_back(all.at({BlockKind::Calibration, camera}));
      T_B_C.push_back(window.cameras()[camera].given.T_B_C);
    }
    blocks.push_back(all.at({BlockKind::InverseDepth, term.id}));
    owned.push_back(std::make_unique<LandmarkCost>(T_B_C, std::move(views), 1.0 / at.weight, at.correlation));
    problem.AddResidualBlock(owned.back().get(), const_cast<ceres::LossFunction*>(&visual_loss()), blocks);
  }
}

/// The final cost; `all` are the blocks there.
double solve_with_ceres(const Window& window, CeresBlocks& all, int iterations) {
  const Cost cost = cost_of(window);
  std::vector<std::unique_ptr<ceres::CostFunction>> landmarks;
  PoseManifold manifold;
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.*kManifoldOwnership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(options);
  for (const auto& [id, state] : window.states()) {
    problem.AddParameterBlock(all.at({BlockKind::Pose, id}), 7, &manifold);
  }
  for (const auto& factor : cost.factors) {  // the problem does not delete what it does not own
    std::vector<double*> blocks;
    for (const BlockKey& key : factor->blocks()) blocks.push_back(all.at(key));
    problem.AddResidualBlock(const_cast<Factor*>(factor.get()), const_cast<ceres::LossFunction*>(factor->loss()),
                             blocks);
  }
  for (const LandmarkTerm& term : cost.landmarks) add_landmark(window, term, all, problem, landmarks);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.max_num_iterations = iterations;
  solver.initial_trust_region_radius = 1e9;
  solver.function_tolerance = 1e-15;
  solver.gradient_tolerance = solver.parameter_tolerance = 0.0;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  return summary.final_cost;
}

/// Perturbed landmarks and IMU; errors of a track correlate, calibrations are free.
Window disturbed_window(TestWorld& world, const TestWorldOptions& options) {
  Window window = tracked_window(world, options, 6, {0.95, 0.8});
  triangulate_features(window, {});
  window.free_calibration({});
  int i = 0;
  for (const auto& [id, state] : window.states()) {
    displace(window, id, {0.004, -0.002 * i, 0.002}, {0.004 * i, -0.01, 0.008});
    window.move({BlockKind::Motion, id}, std::array{0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0});
    ++i;
  }
  stretch_depths(window, 1.03);
  // Without it the scale is so weak a direction that two solvers need many steps to agree on it.
  const auto& [first, state] = *window.states().begin();
  window.add_soft_prior(motion_prior({BlockKind::Motion, first}, state.motion, {0.02, 1e-3, 1e-2}));
  return window;
}

TEST(Solve, ComesToWhereCeresComes) {
  for (const auto& [iterations, shared] :
       {std::pair(1, false), std::pair(2, false), std::pair(20, false), std::pair(2, true), std::pair(20, true)}) {
    SCOPED_TRACE(testing::Message() << iterations << (shared ? ", the cameras see the same landmarks" : ""));
    const TestWorldOptions options{.cameras = 2, .shared_ids = shared};
    TestWorld world(options);
    Window window = disturbed_window(world, options);
    CeresBlocks blocks(window);
    const double by_ceres = solve_with_ceres(window, blocks, iterations);
    const SolveSummary summary = solve(window, iterations);
    ASSERT_TRUE(summary.usable);
    EXPECT_NEAR(summary.final_cost / by_ceres, 1.0, 1e-4);
    EXPECT_LT(summary.final_cost, 0.2 * summary.initial_cost);
    if (iterations < 20) continue;
    for (const auto& [id, state] : window.states()) {
      Vector6d difference;
      tangent_difference(BlockKind::Pose, state.pose.data(), blocks.at({BlockKind::Pose, id}), difference.data());
      EXPECT_LT(difference.norm(), 3e-4) << id;  // ours stops at a relative decrease of 1e-6 of the cost
    }
    for (const auto& [id, feature] : window.features()) {
      if (feature.anchor) {
        EXPECT_NEAR(feature.inverse_depth, *blocks.at({BlockKind::InverseDepth, id}), 3e-4) << id;
      }
    }
  }
}

TEST(Solve, HasTheValueOfTheCostThatCeresHas) {
  const TestWorldOptions options{.cameras = 2};
  TestWorld world(options);
  Window window = disturbed_window(world, options);
  const double value = value_of(window, cost_of(window));
  CeresBlocks blocks(window);
  EXPECT_NEAR(solve_with_ceres(window, blocks, 0) / value, 1.0, 1e-12);
}

TEST(Solve, IsNotUsableWithALandmarkBehindItsCamera) {
  const TestWorldOptions options{};
  TestWorld world(options);
  Window window = disturbed_window(world, options);
  const auto landmark =
      std::ranges::find_if(window.features(), [](const auto& f) { return f.second.anchor.has_value(); });
  ASSERT_NE(landmark, window.features().end());
  const StateId seen = landmark->second.observations.rbegin()->first.state;
  displace(window, seen, {0.0, 3.1, 0.0}, {0.0, 0.0, 0.0});
  const std::vector<double> turned = window.estimates();
  EXPECT_FALSE(solve(window, 5).usable);
  EXPECT_EQ(window.estimates(), turned);
}

/// The gradient of the normal equations against differences of the cost.
class NormalEquationsOf : public testing::TestWithParam<bool> {};

TEST_P(NormalEquationsOf, TheWindowHaveTheGradientOfTheCost) {
  const TestWorldOptions options{.cameras = 2, .shared_ids = GetParam()};
  TestWorld world(options);
  Window window = disturbed_window(world, options);
  Cost cost = cost_of(window);
  for (LandmarkTerm& term : cost.landmarks) term.coupled = true;  // nothing eliminated
  const Layout layout(blocks_of(cost));
  const Eigen::VectorXd g = normal_equations(window, cost, layout).g;
  const double largest = g.cwiseAbs().maxCoeff();
  const std::vector<double> kept = window.estimates();
  for (const auto& [key, offset] : layout.offset) {
    for (int i = 0; i < tangent_size(key.kind); ++i) {
      const double step = 1e-7;
      std::vector<double> d(static_cast<std::size_t>(tangent_size(key.kind)), 0.0);
      double values[2];
      for (const int side : {0, 1}) {
        d[static_cast<std::size_t>(i)] = side == 0 ? -step : step;
        window.move(key, d);
        values[side] = value_of(window, cost);
        window.restore(kept);
      }
      // The rates of states are constants of a landmark's term, but depend on motion blocks.
      const double slack = key.kind == BlockKind::Motion ? 1e-3 : 1e-5;
      EXPECT_NEAR(g[offset + i], (values[1] - values[0]) / (2.0 * step), slack * largest + 1e-3) << offset + i;
    }
  }
}

TEST_P(NormalEquationsOf, TheWindowHaveTheGradientThatIsComputedAlone) {
  const TestWorldOptions options{.cameras = 2, .shared_ids = GetParam()};
  TestWorld world(options);
  Window window = disturbed_window(world, options);
  Cost cost = cost_of(window);
  cost.landmarks.front().coupled = true;
  const Layout layout(blocks_of(cost));
  std::vector<DepthEquation> eliminated;
  const Eigen::VectorXd g = normal_equations(window, cost, layout, &eliminated).g;
  std::vector<DepthEquation> kept = eliminated;
  for (DepthEquation& depth : kept) depth.g = 1e9;
  EXPECT_LT((gradient(window, cost, layout, kept) - g).norm(), 1e-9 * g.norm());
  for (std::size_t i = 0; i < kept.size(); ++i)
    EXPECT_NEAR(kept[i].g, eliminated[i].g, 1e-9 * std::max(1.0, std::abs(eliminated[i].g)));
}

INSTANTIATE_TEST_SUITE_P(Cameras, NormalEquationsOf, testing::Values(false, true), [](const auto& test) {
  return test.param ? "that_see_the_same_landmarks" : "with_landmarks_of_their_own";
});

}  // namespace
}  // namespace edged
