// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What an autopilot receives: one message of odometry in its conventions.
#pragma once

#include <array>
#include <cstdint>

namespace edged {

/// The fields, units, frames and constants of px4_msgs/VehicleOdometry. The world has z down and the origin and heading
/// of our map, which are not those of the Earth: FRD, not NED. The body V is the vehicle: x forward, y right, z down.
/// NaN: unknown.
struct VehicleOdometry {
  static constexpr std::uint8_t kPoseFrameFrd = 2, kVelocityFrameBodyFrd = 3;

  std::uint64_t timestamp = 0, timestamp_sample = 0;  ///< [us], of the IMU sample
  std::uint8_t pose_frame = kPoseFrameFrd;
  std::array<float, 3> position{};  ///< place of the IMU in the world [m]
  std::array<float, 4> q{};         ///< w, x, y, z: from V to the world
  std::uint8_t velocity_frame = kVelocityFrameBodyFrd;
  std::array<float, 3> velocity{};              ///< velocity of the IMU, in V [m/s]
  std::array<float, 3> angular_velocity{};      ///< in V [rad/s], without the bias of the gyro
  std::array<float, 3> position_variance{};     ///< along the axes of the world [m^2]
  std::array<float, 3> orientation_variance{};  ///< about the axes of V [rad^2]
  std::array<float, 3> velocity_variance{};     ///< along the axes of V [m^2/s^2]
  std::uint8_t reset_counter = 0;               ///< counts jumps of the pose; follows 255 with 0
  std::int8_t quality = 0;                      ///< 1 (worst) to 100
};

}  // namespace edged
