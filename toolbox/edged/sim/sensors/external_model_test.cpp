// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/sensors/external_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/sim/simulator.hpp"

namespace edged {
namespace {

/// A body that rises at 1 m/s, moves at 2 m/s along x and rotates about z at 3 rad/s.
struct Climb {
  Kinematics at(double t) const {
    Kinematics k;
    k.T_W_B = SE3(so3::exp(Eigen::Vector3d(0, 0, 3.0 * t)), Eigen::Vector3d(2.0 * t, 0, t));
    k.v_W = Eigen::Vector3d(2, 0, 1);
    k.omega_B = Eigen::Vector3d(0, 0, 3);
    return k;
  }
};

std::vector<ExternalSample> samples(const ExternalModelConfig& config, std::size_t index, double end_s) {
  ExternalModel model(config, index, 1, Duration(0));
  std::vector<ExternalSample> all;
  while (model.peek(Climb(), end_s)) all.push_back(model.pop());
  return all;
}

ExternalModelConfig exact() {
  ExternalModelConfig config;
  config.height.errors = {.rate_hz = 10.0};
  config.velocity.errors = {.rate_hz = 10.0};
  return config;
}

double height(const ExternalSample& sample) { return std::get<HeightSample>(sample).height_m; }
double t_s(const ExternalSample& sample) { return to_seconds(time_of(sample)); }

TEST(ExternalModel, WithoutErrorsReadsTheTruth) {
  ExternalModelConfig config = exact();
  config.height.zero_m = 5.0;
  config.velocity.p_B_S = {0.1, 0, 0};
  const auto heights = samples(config, 0, 2.0), velocities = samples(config, 1, 2.0);
  ASSERT_EQ(heights.size(), 20U);
  ASSERT_EQ(velocities.size(), 20U);
  for (const ExternalSample& sample : heights) EXPECT_NEAR(height(sample), t_s(sample) + 5.0, 1e-8);
  for (const ExternalSample& sample : velocities) {
    const Kinematics truth = Climb().at(t_s(sample));
    const Eigen::Vector3d v_B = truth.T_W_B.rotation().conjugate() * truth.v_W + Eigen::Vector3d(0, 0.3, 0);
    EXPECT_NEAR((std::get<VelocitySample>(sample).v_S - v_B).norm(), 0.0, 1e-6);
  }
}

TEST(ExternalModel, IsOffUnlessItHasARate) {
  EXPECT_TRUE(samples({}, 0, 10.0).empty());
  EXPECT_TRUE(samples({}, 1, 10.0).empty());
}

TEST(ExternalModel, ErrorsAreOfTheSizeThatWasAskedFor) {
  ExternalModelConfig config = exact();
  config.height.errors = {.rate_hz = 100.0, .noise = 0.2, .scale_error = 0.1};
  double squares = 0.0;
  const auto all = samples(config, 0, 20.0);
  for (const ExternalSample& sample : all) {
    squares += std::pow(height(sample) - 1.1 * t_s(sample), 2);
    EXPECT_EQ(std::get<HeightSample>(sample).sigma_m, 0.2);
  }
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(all.size())), 0.2, 0.02);
}

TEST(ExternalModel, AGapLeavesSamplesOutAndChangesNoOther) {
  ExternalModelConfig config = exact();
  config.height.errors = {.rate_hz = 10.0, .noise = 0.2, .walk = 0.1};
  const auto whole = samples(config, 0, 4.0);
  config.height.errors.gap_at_s = 1.0;
  config.height.errors.gap_s = 2.0;
  const auto holed = samples(config, 0, 4.0);
  ASSERT_EQ(holed.size(), 20U);
  EXPECT_EQ(height(holed.back()), height(whole.back()));
  for (const ExternalSample& sample : holed) EXPECT_TRUE(t_s(sample) < 1.0 || t_s(sample) >= 3.0);
}

TEST(ExternalModel, OutliersAreAsManyAsAskedForAndLateStampsAsLate) {
  ExternalModelConfig config = exact();
  config.height.errors = {.rate_hz = 100.0, .outlier_share = 0.05, .outlier = 50.0, .late_ms = 100.0};
  int wrong = 0;
  for (const ExternalSample& sample : samples(config, 0, 50.0))
    wrong += std::abs(height(sample) - (t_s(sample) - 0.1)) > 1e-6 ? 1 : 0;
  EXPECT_NEAR(wrong, 250, 60);
}

TEST(ExternalModel, TheSimulatorGivesItsSamplesInOrderAndChangesNothingElse) {
  SimulatorConfig config = simulator_preset("room");
  config.duration_s = 1.5;
  config.camera.width = config.camera.height = 32;
  Simulator plain(config);
  config.external.height.errors.rate_hz = 25.0;
  config.external.velocity.errors.rate_hz = 50.0;
  Simulator with(config);
  EXPECT_EQ(with.info().external, (std::vector<std::string>{"height", "velocity"}));
  EXPECT_TRUE(plain.info().external.empty());
  std::vector<Event> events, same;
  std::size_t heights = 0, velocities = 0;
  Timestamp last = Timestamp::min();
  while (const auto m = plain.next())
    if (const auto* batch = std::get_if<EventBatch>(&*m))
      events.insert(events.end(), batch->events.begin(), batch->events.end());
  while (const auto m = with.next()) {
    EXPECT_GE(*first_stamp(*m), last);
    last = *last_stamp(*m);
    if (const auto* batch = std::get_if<EventBatch>(&*m))
      same.insert(same.end(), batch->events.begin(), batch->events.end());
    if (const auto* sample = std::get_if<ExternalSample>(&*m)) ++(sample->index() == 0 ? heights : velocities);
  }
  EXPECT_EQ(heights, 38U);
  EXPECT_EQ(velocities, 75U);
  ASSERT_EQ(events.size(), same.size());
  for (std::size_t i = 0; i < events.size(); ++i) ASSERT_EQ(events[i].t, same[i].t);
}

}  // namespace
}  // namespace edged
