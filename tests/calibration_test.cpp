// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The whole system with a calibration that is a little wrong.
#include <gtest/gtest.h>

#include <iostream>
#include <numbers>

#include "end_to_end.hpp"

namespace edged {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;

const Flight& flight() {
  static const Flight recorded = simulate_flight("room", 11, 15.0);
  return recorded;
}

/// About twice what is left: see the output.
FlightRun follow(const Calibration& wrong, Mode mode, double ate_m, double scale_error) {
  FlightRun run = run_flight(wrong, flight().measurements, mode);
  const FlightScore result = score(flight(), run);
  std::cout << mode_name(mode) << ": " << describe(result, run.statistics) << '\n';
  EXPECT_EQ(run.statistics.last_status(), TrackingStatus::Good);
  EXPECT_EQ(run.statistics.times_lost(), 0U);
  EXPECT_LT(result.evaluation.ate_m.rmse, ate_m);
  EXPECT_NEAR(result.evaluation.scale, 1.0, scale_error);
  return run;
}

class WrongCalibration : public testing::TestWithParam<Mode> {
 protected:
  static double most_ate_m() { return GetParam() == Mode::Events ? 0.06 : 0.02; }
};

TEST_P(WrongCalibration, OfRotationAndTimeIsFound) {
  Calibration wrong = flight().calibration;
  for (RigCamera& camera : wrong.rig.cameras) {
    const double sign = camera.modality == Modality::Events ? 1.0 : -1.0;
    const Eigen::Vector3d turn = sign * 2.0 * kDeg * Eigen::Vector3d(0.6, -0.5, 0.62).normalized();
    camera.T_B_C = SE3(camera.T_B_C.rotation() * so3::exp(turn), camera.T_B_C.translation());
    camera.time_offset += duration_from_seconds(-0.010 * sign);
  }
  const FlightRun run = follow(wrong, GetParam(), most_ate_m(), 0.05);
  const FlightRun of_right = run_flight(flight().calibration, flight().measurements, GetParam());
  for (const RigCamera& found : run.rig.cameras) {
    const RigCamera& right = flight().calibration.rig.camera(found.name);
    // An edge must have moved a part of a pixel before its event fires: that is late by what the right one finds, too.
    const RigCamera& reachable = found.modality == Modality::Events ? of_right.rig.camera(found.name) : right;
    const double turned_deg = so3::log((right.T_B_C.inverse() * found.T_B_C).rotation()).norm() / kDeg;
    const double off_ms = 1e3 * to_seconds(found.time_offset - reachable.time_offset);
    std::cout << "  " << found.name << ": " << turned_deg << " deg and " << off_ms
              << " ms are left; from the right one "
              << 1e3 * to_seconds(of_right.rig.camera(found.name).time_offset - right.time_offset) << " ms\n";
    EXPECT_LT(turned_deg, 0.2);
    EXPECT_LT(std::abs(off_ms), 0.5);
  }
}

TEST_P(WrongCalibration, OfTheFocalLengthByAPercentIsBorne) {
  for (const double factor : {0.99, 1.01}) {
    Calibration wrong = flight().calibration;
    for (RigCamera& camera : wrong.rig.cameras) {
      const CameraModel& m = camera.model;
      camera.model = CameraModel(m.width(), m.height(), factor * m.fx(), factor * m.fy(), m.cx(), m.cy(),
                                 m.distortion(), m.coefficients());
    }
    follow(wrong, GetParam(), most_ate_m(), 0.05);
  }
}

INSTANTIATE_TEST_SUITE_P(, WrongCalibration, testing::ValuesIn(kAllModes),
                         [](const auto& test) { return mode_name(test.param); });

}  // namespace
}  // namespace edged
