// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Agreement of height and velocity sensors with the IMU: signs, axes and scale, without any camera.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/checks/agreement/gyro_integral.hpp"
#include "edged/checks/finding.hpp"
#include "edged/checks/statistics/external_statistics.hpp"
#include "edged/measurement.hpp"
#include "edged/se3.hpp"

namespace edged {

/// Ratio of the changes of height to those from the accelerometer.
struct HeightAgreement {
  double scale = 1.0, scale_sigma = 0.0;
};

/// Rotation and ratio of the velocity in the body's axes to the measured one.
struct VelocityAgreement {
  SE3 T_B_S;  ///< the best rotation, and the position of the sensor
  double scale = 1.0;
  double sigma = 0.0;                               ///< sigma of the entries of R_B_S in the determined axes
  bool left_handed = false;                         ///< a rotation fits only after the signs are applied
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();  ///< signs of the axes
};

/// Over a few seconds, the motion of the body is the integral of the accelerometer, with unknown velocity, gravity and
/// biases (docs/external-sensors.md, Y1). Nothing if the motion does not determine the result.
std::optional<HeightAgreement> compare_heights(const std::vector<HeightSample>& samples, const GyroIntegral& gyro);
/// noise: of a sample [m/s].
std::optional<VelocityAgreement> compare_velocities(const std::vector<VelocitySample>& samples,
                                                    const GyroIntegral& gyro, double noise);

/// Collects samples, at most a quarter of an hour at 25 Hz, and adds findings about them.
class ExternalCheck {
 public:
  void add(const ExternalSample& sample);
  void judge(const GyroIntegral& gyro, const ExternalStatisticsByName& statistics, std::vector<Finding>& out) const;

 private:
  std::vector<HeightSample> heights_;
  std::vector<VelocitySample> velocities_;
};

}  // namespace edged
