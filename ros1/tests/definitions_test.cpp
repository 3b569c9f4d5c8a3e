// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/ros/definitions.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

namespace edged::ros1 {
namespace {

/// As the tool of ROS computes it from the installed definitions.
std::string md5_of_ros(const std::string& type) {
  const std::string command = "rosmsg md5 " + type + " 2>/dev/null";
  std::FILE* out = popen(command.c_str(), "r");
  std::string md5(32, '\0');
  md5.resize(std::fread(md5.data(), 1, md5.size(), out));
  pclose(out);
  return md5;
}

TEST(Definitions, HaveTheSumsOfThoseThatRosInstalls) {
  for (const char* type :
       {"nav_msgs/Odometry", "geometry_msgs/PoseWithCovarianceStamped", "nav_msgs/Path", "tf2_msgs/TFMessage",
        "sensor_msgs/PointCloud2", "sensor_msgs/Image", "sensor_msgs/Imu", "diagnostic_msgs/DiagnosticArray"})
    EXPECT_EQ(ros1_md5_of(type), md5_of_ros(type)) << type;
}

}  // namespace
}  // namespace edged::ros1
