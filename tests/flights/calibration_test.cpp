// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The whole system with a calibration that is a little wrong.
#include <gtest/gtest.h>

#include <iostream>
#include <map>
#include <numbers>
#include <string>

#include "end_to_end.hpp"

namespace edged {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;

constexpr int kSeed = 11;

const Flight& flight(int seed = kSeed) { return shared_flight("room", seed, 15.0); }

/// About twice what is left: see the output.
FlightRun follow(const Flight& flight, const Calibration& wrong, Mode mode, double ate_m, double scale_error) {
  FlightRun run = run_flight(wrong, flight.measurements, mode);
  const FlightScore result = score(flight, run);
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

/// The calibration turned by 2 deg and late by 10 ms, each camera another way.
Calibration turned_and_late(Calibration calibration) {
  for (RigCamera& camera : calibration.rig.cameras) {
    const double sign = camera.modality == Modality::Events ? 1.0 : -1.0;
    const Eigen::Vector3d turn = sign * 2.0 * kDeg * Eigen::Vector3d(0.6, -0.5, 0.62).normalized();
    camera.T_B_C = SE3(camera.T_B_C.rotation() * so3::exp(turn), camera.T_B_C.translation());
    camera.time_offset += duration_from_seconds(-0.010 * sign);
  }
  return calibration;
}

/// The mean angle [deg] between the rays of some pixels in the body's frame: a shift of the principal point is a
/// rotation, too, and a run estimates both.
double turned_deg_between(const RigCamera& right, const RigCamera& found) {
  double sum = 0.0;
  int count = 0;
  for (const double x : {0.25, 0.5, 0.75}) {
    for (const double y : {0.25, 0.5, 0.75}) {
      const Eigen::Vector2d pixel(x * right.model.width(), y * right.model.height());
      const Eigen::Vector3d a = right.T_B_C.R() * right.model.pixel_to_ray(pixel).normalized(),
                            b = found.T_B_C.R() * found.model.pixel_to_ray(pixel).normalized();
      sum += std::atan2(a.cross(b).norm(), a.dot(b)) / kDeg;
      ++count;
    }
  }
  return sum / count;
}

struct LeftOver {
  double turned_deg = 0.0, off_ms = 0.0;
};

/// What is left of it after a flight, by the camera's name.
std::map<std::string, LeftOver> left_over(const Flight& flight, const FlightRun& run, Mode mode) {
  std::map<std::string, LeftOver> left;
  const FlightRun of_right = run_flight(flight.calibration, flight.measurements, mode);
  for (const RigCamera& found : run.rig.cameras) {
    const RigCamera& right = flight.calibration.rig.camera(found.name);
    // An edge must have moved a part of a pixel before its event fires: that is late by what the right one finds, too.
    const RigCamera& reachable = found.modality == Modality::Events ? of_right.rig.camera(found.name) : right;
    const double turned_deg = turned_deg_between(right, found);
    const double off_ms = std::abs(1e3 * to_seconds(found.time_offset - reachable.time_offset));
    left[found.name] = {turned_deg, off_ms};
    std::cout << "  " << found.name << ": " << turned_deg << " deg and " << off_ms
              << " ms are left; from the right one "
              << 1e3 * to_seconds(of_right.rig.camera(found.name).time_offset - right.time_offset) << " ms\n";
  }
  return left;
}

/// The mean over three flights: what is left of an event camera's turn scatters between 0.06 and 0.3 deg.
TEST_P(WrongCalibration, OfRotationAndTimeIsFound) {
  constexpr int kFlights = 3;
  std::map<std::string, LeftOver> mean;
  for (int seed = kSeed; seed < kSeed + kFlights; ++seed) {
    const Flight& recorded = flight(seed);
    const FlightRun run = follow(recorded, turned_and_late(recorded.calibration), GetParam(), most_ate_m(), 0.05);
    for (const auto& [camera, left] : left_over(recorded, run, GetParam())) {
      mean[camera].turned_deg += left.turned_deg / kFlights;
      mean[camera].off_ms += left.off_ms / kFlights;
    }
  }
  for (const auto& [camera, left] : mean) {
    EXPECT_LT(left.turned_deg, 0.2) << camera;
    EXPECT_LT(left.off_ms, 0.5) << camera;
  }
}

TEST_P(WrongCalibration, OfTheFocalLengthByAPercentIsBorne) {
  const Flight& recorded = flight();
  for (const double factor : {0.99, 1.01}) {
    Calibration wrong = recorded.calibration;
    for (RigCamera& camera : wrong.rig.cameras) {
      const CameraModel& m = camera.model;
      camera.model = CameraModel(m.width(), m.height(), factor * m.fx(), factor * m.fy(), m.cx(), m.cy(),
                                 m.distortion(), m.coefficients());
    }
    follow(recorded, wrong, GetParam(), most_ate_m(), 0.05);
  }
}

INSTANTIATE_TEST_SUITE_P(, WrongCalibration, testing::ValuesIn(kAllModes),
                         [](const auto& test) { return mode_name(test.param); });

}  // namespace
}  // namespace edged
