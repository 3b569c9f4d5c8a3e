// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Measurements of the sensors, as plain structs.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <variant>
#include <vector>

#include "edged/time.hpp"

namespace edged {

/// One brightness change of one pixel. 16 bytes.
struct Event {
  Timestamp t;          ///< camera clock
  std::uint16_t x = 0;  ///< column [px], raw (distorted)
  std::uint16_t y = 0;  ///< row [px]
  bool positive = false;
};

/// Consecutive events of one camera in time order.
struct EventBatch {
  std::string camera;  ///< name of the event camera in the rig
  std::vector<Event> events;
};

/// A standard image.
struct Frame {
  Timestamp t;         ///< camera clock, middle of the exposure
  std::string camera;  ///< name of the frame camera in the rig
  cv::Mat image;       ///< CV_8UC1, raw (distorted)
};

/// One inertial measurement in the body frame B.
struct ImuSample {
  Timestamp t;                                        ///< IMU clock
  Eigen::Vector3d gyro_B = Eigen::Vector3d::Zero();   ///< angular velocity [rad/s]
  Eigen::Vector3d accel_B = Eigen::Vector3d::Zero();  ///< specific force [m/s^2], about +9.81 upwards at rest
  bool interpolated = false;                          ///< interpolated where the recording has a gap
  bool gyro_clipped = false, accel_clipped = false;   ///< at the end of a range that the calibration does not state
};

/// The height of the body above a level that drifts slowly: a barometer, or a range finder above flat ground.
struct HeightSample {
  Timestamp t;            ///< IMU clock
  double height_m = 0.0;  ///< up positive, from an arbitrary zero
  double sigma_m = 0.0;   ///< 0: the option height.sigma_m
};

/// The velocity of a sensor on the body, in that sensor's own axes: wheel odometry, optical flow with range, DVL.
struct VelocitySample {
  Timestamp t;                                    ///< IMU clock
  Eigen::Vector3d v_S = Eigen::Vector3d::Zero();  ///< [m/s], of the sensor against the ground, in its axes S
  /// [m/s] each axis; 0: the option velocity.sigma_mps; infinite: not measured.
  Eigen::Vector3d sigma = Eigen::Vector3d::Zero();
};

using ExternalSample = std::variant<HeightSample, VelocitySample>;

using Measurement = std::variant<EventBatch, Frame, ImuSample, ExternalSample>;

/// What a camera delivers.
enum class Modality { Events, Frames };

}  // namespace edged
