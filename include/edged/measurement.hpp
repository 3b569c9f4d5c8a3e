// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What flows through the system. Plain structs; finished results are not changed any more.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <variant>
#include <vector>

#include "edged/core/lie.hpp"
#include "edged/core/time.hpp"

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

struct StampedPose {
  Timestamp t;
  SE3 T;  ///< the user of a trajectory says which two frames
};

using Trajectory = std::vector<StampedPose>;

/// The state of the body B in the world W (z up) at one instant.
struct NavState {
  Timestamp t;  ///< IMU clock
  SE3 T_W_B;
  Eigen::Vector3d v_W = Eigen::Vector3d::Zero();         ///< velocity of B in W [m/s]
  Eigen::Vector3d bias_gyro = Eigen::Vector3d::Zero();   ///< [rad/s], measured = true + bias
  Eigen::Vector3d bias_accel = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// Names one corner for as long as it is tracked; never reused, unique over all cameras.
using FeatureId = std::uint64_t;

/// One tracked corner in one image, as the estimator sees it.
struct FeatureObservation {
  FeatureId id = 0;
  Eigen::Vector2d point = Eigen::Vector2d::Zero();  ///< undistorted, on the unit plane z = 1 of its camera
  double sigma = 0.0;  ///< standard deviation of each coordinate of point (px / focal length)
};

/// What one camera of the rig saw at one instant.
struct CameraObservations {
  std::string camera;
  std::vector<FeatureObservation> features;
};

/// A point of the world that the estimator has placed by the sights of a corner.
struct Landmark {
  FeatureId id = 0;  ///< of the corner
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
};

/// Gravity in W [m/s^2].
inline const Eigen::Vector3d kGravity_W(0.0, 0.0, -9.81);

}  // namespace edged
