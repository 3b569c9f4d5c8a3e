// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "messages.hpp"

#include <sensor_msgs/fill_image.h>
#include <sensor_msgs/image_encodings.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace edged::ros1 {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

std_msgs::Header header_of(Timestamp t, const std::string& frame) {
  std_msgs::Header header;
  header.stamp = to_ros(t);
  header.frame_id = frame;
  return header;
}

geometry_msgs::Vector3 vector_message(const Eigen::Vector3d& v) {
  geometry_msgs::Vector3 message;
  message.x = v.x(), message.y = v.y(), message.z = v.z();
  return message;
}

geometry_msgs::Quaternion rotation_message(const Eigen::Quaterniond& q) {
  geometry_msgs::Quaternion message;
  message.x = q.x(), message.y = q.y(), message.z = q.z(), message.w = q.w();
  return message;
}

geometry_msgs::TransformStamped transform_message(Timestamp t, const std::string& parent, const std::string& child,
                                                  const SE3& T_parent_child) {
  geometry_msgs::TransformStamped message;
  message.header = header_of(t, parent);
  message.child_frame_id = child;
  message.transform.translation = vector_message(T_parent_child.translation());
  message.transform.rotation = rotation_message(T_parent_child.rotation());
  return message;
}

}  // namespace

ros::Time to_ros(Timestamp t) {
  const std::int64_t last = ros::TIME_MAX.sec * kSecond + ros::TIME_MAX.nsec;
  const std::int64_t ns = std::clamp<std::int64_t>(to_ns(t), 0, last);
  return {static_cast<std::uint32_t>(ns / kSecond), static_cast<std::uint32_t>(ns % kSecond)};
}

geometry_msgs::Pose to_ros(const SE3& pose) {
  geometry_msgs::Pose message;
  message.position.x = pose.translation().x();
  message.position.y = pose.translation().y();
  message.position.z = pose.translation().z();
  message.orientation = rotation_message(pose.rotation());
  return message;
}

nav_msgs::Odometry odometry_message(const NavState& state, const Eigen::Vector3d& gyro_B,
                                    const std::optional<StateCovariance>& covariance, const FrameNames& frames) {
  nav_msgs::Odometry message;
  message.header = header_of(state.t, frames.world);
  message.child_frame_id = frames.body;
  message.pose.pose = to_ros(state.T_W_B);
  const Eigen::Matrix3d R_W_B = state.T_W_B.rotation().toRotationMatrix();
  message.twist.twist.linear = vector_message(R_W_B.transpose() * state.v_W);
  message.twist.twist.angular = vector_message(gyro_B - state.bias_gyro);
  if (covariance) {
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> P(message.pose.covariance.data());
    P.topLeftCorner<3, 3>() = covariance->position;
    P.bottomRightCorner<3, 3>() = R_W_B * covariance->rotation * R_W_B.transpose();
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> V(message.twist.covariance.data());
    V.topLeftCorner<3, 3>() = R_W_B.transpose() * covariance->velocity * R_W_B;
  }
  return message;
}

geometry_msgs::PoseWithCovarianceStamped pose_message(const nav_msgs::Odometry& odometry) {
  geometry_msgs::PoseWithCovarianceStamped message;
  message.header = odometry.header;
  message.pose = odometry.pose;
  return message;
}

geometry_msgs::PoseStamped stamped_pose_message(const nav_msgs::Odometry& odometry) {
  geometry_msgs::PoseStamped message;
  message.header = odometry.header;
  message.pose = odometry.pose.pose;
  return message;
}

tf2_msgs::TFMessage transforms_message(const NavState& state, const Rig& rig, const FrameNames& frames) {
  tf2_msgs::TFMessage message;
  message.transforms.push_back(transform_message(state.t, frames.world, frames.body, state.T_W_B));
  for (const RigCamera& camera : rig.cameras)
    message.transforms.push_back(transform_message(state.t, frames.body, camera.name, camera.T_B_C));
  return message;
}

sensor_msgs::PointCloud2 landmarks_message(Timestamp t, std::span<const Landmark> landmarks, const FrameNames& frames) {
  sensor_msgs::PointCloud2 message;
  message.header = header_of(t, frames.world);
  message.height = 1;
  sensor_msgs::PointCloud2Modifier modifier(message);
  using Field = sensor_msgs::PointField;
  modifier.setPointCloud2Fields(4, "x", 1, Field::FLOAT32, "y", 1, Field::FLOAT32, "z", 1, Field::FLOAT32, "id", 1,
                                Field::UINT32);
  modifier.resize(landmarks.size());
  message.is_dense = 1;
  sensor_msgs::PointCloud2Iterator<float> xyz(message, "x");
  sensor_msgs::PointCloud2Iterator<std::uint32_t> id(message, "id");
  for (const Landmark& landmark : landmarks) {
    for (int axis = 0; axis < 3; ++axis) xyz[axis] = static_cast<float>(landmark.p_W[axis]);
    *id = static_cast<std::uint32_t>(landmark.id);
    ++xyz, ++id;
  }
  return message;
}

sensor_msgs::Image tracks_message(Timestamp t, const std::string& camera, const cv::Mat& image,
                                  std::span<const Track> tracks) {
  const cv::Scalar green(80, 220, 80), orange(0, 140, 255);
  const auto point = [](const Eigen::Vector2d& pixel) { return cv::Point2d(pixel.x(), pixel.y()); };
  cv::Mat rendered;
  cv::cvtColor(image, rendered, cv::COLOR_GRAY2BGR);
  for (const Track& track : tracks) {
    cv::line(rendered, point(track.previous_pixel), point(track.pixel), orange, 1, cv::LINE_AA);
    cv::circle(rendered, point(track.pixel), 2, green, 1, cv::LINE_AA);
  }
  sensor_msgs::Image message;
  message.header = header_of(t, camera);
  sensor_msgs::fillImage(message, sensor_msgs::image_encodings::BGR8, static_cast<std::uint32_t>(rendered.rows),
                         static_cast<std::uint32_t>(rendered.cols), static_cast<std::uint32_t>(rendered.step[0]),
                         rendered.data);
  return message;
}

}  // namespace edged::ros1
