// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/standstill_factor.hpp"

#include <gtest/gtest.h>

#include "edged/estimator/factors/test_jacobians.hpp"

namespace edged {
namespace {

TEST(StandstillFactor, JacobiansMatchCentralDifferences) {
  check_jacobians(StandstillFactor(0, 1),
                  {pose_block({0.3, -0.8, 0.2}, {1, 2, 3}), pose_block({0.35, -0.7, 0.25}, {1.1, 1.9, 3.05})});
}

}  // namespace
}  // namespace edged
