// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Semi-dense depth of flights through a simulated room, against the true depth.
#include <gtest/gtest.h>

#include <iostream>

#include "dense_flight.hpp"

namespace edged {
namespace {

TEST(DenseDepthOfARoom, AgreesWithTheTrueDepthInEveryMode) {
  SimulatorConfig config = simulator_preset("room");
  config.seed = 5;
  config.duration_s = 10.0;
  const Flight flight = simulate_flight(config);
  for (const Mode mode : kAllModes) {
    const DenseRun run = map_densely(flight, mode);
    const DenseScore found = score(run, config);
    std::cout << mode_name(mode) << ": " << describe(run, found) << '\n';
    ASSERT_GE(found.points, 1000U) << mode_name(mode);
    EXPECT_LE(found.median_error, 0.02) << mode_name(mode);
    EXPECT_LE(found.outliers, 0.05) << mode_name(mode);
    EXPECT_GE(found.complete, 0.6) << mode_name(mode);
  }
}

}  // namespace
}  // namespace edged
