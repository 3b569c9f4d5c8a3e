// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A flight fed as drivers would: sensors that lag, a thread each; and the state that a controller asks for between
// steps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "end_to_end.hpp"

namespace edged {
namespace {

/// Slow at first, then turning and moving.
const Flight& flight() { return shared_flight("room", 3, 4.0); }

TEST(Feeding, AFlightWhoseSensorsLagGivesTheBitsOfTheRecording) {
  const FlightRun wanted = run_flight(flight().calibration, flight().measurements, Mode::Fused);
  Odometry odometry(flight().calibration.rig, flight().calibration.imu, Mode::Fused, {}, {{10.0, 10.0, 10.0}});
  std::vector<std::jthread> drivers;
  for (std::size_t sensor = 0; sensor < 3; ++sensor) {
    drivers.emplace_back([&odometry, sensor] {
      for (const Measurement& m : flight().measurements) {
        if (m.index() == sensor) odometry.add(m);
      }
    });
  }
  drivers.clear();
  odometry.finish();
  std::size_t i = 0;
  for (; const auto step = odometry.next(); ++i) {
    ASSERT_LT(i, wanted.steps.size());
    const NavState &got = step->state, &want = wanted.steps[i].state;
    ASSERT_EQ(got.t, want.t);
    ASSERT_EQ(got.T_W_B.translation(), want.T_W_B.translation()) << "step " << i;
    ASSERT_EQ(got.T_W_B.rotation().coeffs(), want.T_W_B.rotation().coeffs()) << "step " << i;
    ASSERT_EQ(got.v_W, want.v_W) << "step " << i;
  }
  EXPECT_EQ(i, wanted.steps.size());
}

TEST(Feeding, TheStateBetweenStepsIsWhereTheNextStepFindsTheBody) {
  Odometry odometry(flight().calibration.rig, flight().calibration.imu, Mode::Fused, {}, {kInOrder});
  std::optional<NavState> predicted;
  double sum = 0.0, path = 0.0;
  int compared = 0;
  std::optional<Eigen::Vector3d> before;
  for (const Measurement& m : flight().measurements) {
    predicted = odometry.newest_state();
    odometry.add(m);
    while (const auto step = odometry.next()) {
      if (!is_tracking(step->status)) continue;
      const Eigen::Vector3d& p_W_B = step->state.T_W_B.translation();
      if (before) path += (p_W_B - *before).norm();
      before = p_W_B;
      if (!predicted || std::abs(to_seconds(step->t - predicted->t)) > 0.01) continue;
      const Eigen::Vector3d expected =
          predicted->T_W_B.translation() + to_seconds(step->t - predicted->t) * predicted->v_W;
      sum += (expected - p_W_B).squaredNorm();
      ++compared;
    }
  }
  ASSERT_GT(compared, 50);
  const double rms_m = std::sqrt(sum / compared);
  std::printf("prediction %.2f mm from the next step, RMS of %d over %.2f m\n", 1e3 * rms_m, compared, path);
  EXPECT_LT(rms_m, 0.01);
  EXPECT_GT(path, 0.5);
}

}  // namespace
}  // namespace edged
