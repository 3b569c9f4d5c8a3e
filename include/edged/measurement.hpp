// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What sensors give. Plain structs.
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
  bool made_up = false;                               ///< interpolated where the recording has a gap
};

using Measurement = std::variant<EventBatch, Frame, ImuSample>;

/// What a camera gives.
enum class Modality { Events, Frames };

}  // namespace edged
