// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Turns the odometry into what an autopilot receives in every status.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "edged/autopilot/vehicle_odometry.hpp"
#include "edged/state.hpp"
#include "edged/step.hpp"

namespace edged {

/// Good: quality 51 to 100. Degraded: 1 to 50, with the covariance that grows while vision is lost. Initializing and
/// Lost: nothing, as autopilots by default fuse what they receive, whatever its quality, and notice silence. The reset
/// counter increases where the pose jumps: a restart of the estimator, a relocalization, a large correction by the map.
///
/// Not synchronized. Where states come from another thread than steps, a state of the newest step may reach `at` before
/// the step reaches `note`: one message then has the old reset counter, which an autopilot rejects as an outlier.
class VehicleTracker {
 public:
  /// R_V_B: from the axes of the IMU to those of the vehicle.
  explicit VehicleTracker(const Eigen::Quaterniond& R_V_B) : R_V_B_(R_V_B) {}

  /// Each step, in order.
  void note(const Step& step);

  /// A state predicted from the newest step, and the IMU sample at its time. Nothing without a pose. Both timestamps
  /// are those of the state. Variances are those of the step, grown to the time of the state.
  std::optional<VehicleOdometry> at(const NavState& state, const Eigen::Vector3d& gyro_B) const;

 private:
  /// What is kept of the newest step with a pose.
  struct Newest {
    Timestamp t;
    SE3 T_M_O;
    std::optional<StateCovariance> covariance;
    std::int8_t quality = 0;
  };

  bool jumps(const Step& step) const;

  Eigen::Quaterniond R_V_B_;
  bool tracking_ = false;
  std::optional<Newest> newest_;
  std::uint8_t resets_ = 0;
};

}  // namespace edged
