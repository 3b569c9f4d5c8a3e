// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Velocity, acceleration and rate of a simulated motion against differences of its poses.
#pragma once

#include <gtest/gtest.h>

#include "edged/sim/motion/trajectory.hpp"

namespace edged {

struct DerivativeBounds {
  double step_s;  ///< of the differences
  double a_W;     ///< [m/s^2]
};

template <typename Motion>
void expect_derivatives_at(double t, const Motion& motion, const DerivativeBounds& bounds) {
  const double h = bounds.step_s;
  const Kinematics k = motion.at(t), before = motion.at(t - h), after = motion.at(t + h);
  const Eigen::Vector3d v = (after.T_W_B.translation() - before.T_W_B.translation()) / (2 * h);
  const Eigen::Vector3d a = (after.v_W - before.v_W) / (2 * h);
  const Eigen::Vector3d omega = so3::log(before.T_W_B.rotation().conjugate() * after.T_W_B.rotation()) / (2 * h);
  EXPECT_LT((v - k.v_W).norm(), 1e-5) << t;
  EXPECT_LT((a - k.a_W).norm(), bounds.a_W) << t;
  EXPECT_LT((omega - k.omega_B).norm(), 1e-5) << t;
}

}  // namespace edged
