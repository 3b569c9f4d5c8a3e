// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/messages.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "edged/io/ros/messages/messages.hpp"

namespace edged::node {
namespace {

using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

void write_header(WireWriter& out, Wire wire, Timestamp t, const std::string& frame) {
  out.header(std::clamp(t, timestamp_from_ns(0), latest_stamp(wire)), frame);
}

/// A message that begins with a header.
WireWriter message_at(Wire wire, Timestamp t, const std::string& frame) {
  WireWriter out(wire);
  write_header(out, wire, t, frame);
  return out;
}

void write_counts(WireWriter& out, std::initializer_list<std::size_t> counts) {
  for (const std::size_t count : counts) out.number(static_cast<std::uint32_t>(count));
}

void write_vector(WireWriter& out, const Eigen::Vector3d& v) { out.numbers({v.data(), 3}); }

/// A geometry_msgs/Pose, or a Transform, which has the same fields.
void write_pose(WireWriter& out, const SE3& T) {
  const Eigen::Quaterniond q = T.rotation();
  write_vector(out, T.translation());
  out.numbers(std::array{q.x(), q.y(), q.z(), q.w()});
}

void write_covariance(WireWriter& out, const RowMajor6& P) { out.numbers({P.data(), 36}); }

RowMajor6 pose_covariance(const Estimate& estimate) {
  RowMajor6 P = RowMajor6::Zero();
  if (!estimate.covariance) return P;
  const Eigen::Matrix3d R_W_B = estimate.state.T_W_B.rotation().toRotationMatrix();
  P.topLeftCorner<3, 3>() = estimate.covariance->position;
  P.bottomRightCorner<3, 3>() = R_W_B * estimate.covariance->rotation * R_W_B.transpose();
  return P;
}

RowMajor6 twist_covariance(const Estimate& estimate) {
  RowMajor6 P = RowMajor6::Zero();
  P.bottomRightCorner<3, 3>().diagonal().setConstant(estimate.gyro_sigma * estimate.gyro_sigma);
  if (!estimate.covariance) return P;
  const Eigen::Matrix3d R_W_B = estimate.state.T_W_B.rotation().toRotationMatrix();
  P.topLeftCorner<3, 3>() = R_W_B.transpose() * estimate.covariance->velocity * R_W_B;
  return P;
}

void write_transform(WireWriter& out, Wire wire, Timestamp t, const std::string& parent, const std::string& child,
                     const SE3& T_parent_child) {
  write_header(out, wire, t, parent);
  out.text(child);
  write_pose(out, T_parent_child);
}

void write_field(WireWriter& out, std::string_view name, std::uint32_t offset, std::uint8_t type) {
  out.text(name);
  out.number(offset);
  out.number(type);
  write_counts(out, {1});
}

cv::Mat with_tracks(const cv::Mat& image, std::span<const Track> tracks) {
  const cv::Scalar green(80, 220, 80), orange(0, 140, 255);
  const auto point = [](const Eigen::Vector2d& pixel) { return cv::Point2d(pixel.x(), pixel.y()); };
  cv::Mat rendered;
  cv::cvtColor(image, rendered, cv::COLOR_GRAY2BGR);
  for (const Track& track : tracks) {
    cv::line(rendered, point(track.previous_pixel), point(track.pixel), orange, 1, cv::LINE_AA);
    cv::circle(rendered, point(track.pixel), 2, green, 1, cv::LINE_AA);
  }
  return rendered;
}

}  // namespace

Estimate at(const SE3& T_B_C, const Estimate& of_body) {
  Estimate moved = of_body;
  const Eigen::Matrix3d R_W_B = of_body.state.T_W_B.R(), R_C_B = T_B_C.R().transpose();
  const Eigen::Vector3d omega_B = of_body.gyro_B - of_body.state.bias_gyro;
  const Eigen::Vector3d by_turning = omega_B.cross(T_B_C.translation());  // velocity of C against B, in B
  moved.state.T_W_B = of_body.state.T_W_B * T_B_C;
  moved.state.v_W += R_W_B * by_turning;
  moved.gyro_B = R_C_B * omega_B;
  moved.state.bias_gyro.setZero();
  if (!moved.covariance) return moved;
  auto& [position, rotation, velocity] = *moved.covariance;
  const Eigen::Matrix3d p_by_turn = R_W_B * skew(T_B_C.translation()), v_by_turn = R_W_B * skew(by_turning);
  position += p_by_turn * rotation * p_by_turn.transpose();
  velocity += v_by_turn * rotation * v_by_turn.transpose();
  rotation = (R_C_B * rotation * R_C_B.transpose()).eval();
  return moved;
}

Estimate in(const SE3& T_V_W, const Estimate& in_W) {
  Estimate moved = in_W;
  const Eigen::Matrix3d R = T_V_W.R();
  moved.state.T_W_B = T_V_W * in_W.state.T_W_B;
  moved.state.v_W = R * in_W.state.v_W;
  if (!moved.covariance) return moved;
  moved.covariance->position = R * in_W.covariance->position * R.transpose();
  moved.covariance->velocity = R * in_W.covariance->velocity * R.transpose();
  return moved;
}

std::string odometry_message(const Format& format, const Estimate& estimate) {
  const NavState& state = estimate.state;
  WireWriter out = message_at(format.wire, state.t, format.frames.odom);
  out.text(format.frames.base);
  write_pose(out, state.T_W_B);
  write_covariance(out, pose_covariance(estimate));
  write_vector(out, state.T_W_B.rotation().conjugate() * state.v_W);
  write_vector(out, estimate.gyro_B - state.bias_gyro);
  write_covariance(out, twist_covariance(estimate));
  return out.message();
}

std::string pose_message(const Format& format, const Estimate& estimate) {
  WireWriter out = message_at(format.wire, estimate.state.t, format.frames.map);
  write_pose(out, estimate.state.T_W_B);
  write_covariance(out, pose_covariance(estimate));
  return out.message();
}

std::string path_message(const Format& format, Timestamp t, const std::deque<StampedPose>& poses) {
  WireWriter out = message_at(format.wire, t, format.frames.map);
  write_counts(out, {poses.size()});
  for (const StampedPose& pose : poses) {
    write_header(out, format.wire, pose.t, format.frames.map);
    write_pose(out, pose.T);
  }
  return out.message();
}

std::string transforms_message(Wire wire, Timestamp t, std::span<const FrameTransform> transforms) {
  WireWriter out(wire);
  write_counts(out, {transforms.size()});
  for (const auto& [parent, child, T_parent_child] : transforms)
    write_transform(out, wire, t, parent, child, T_parent_child);
  return out.message();
}

std::string landmarks_message(const Format& format, Timestamp t, std::span<const Landmark> landmarks) {
  constexpr std::uint8_t kUint32 = 6, kFloat32 = 7;  // of sensor_msgs/PointField
  constexpr std::size_t kPointBytes = 16;
  WireWriter out = message_at(format.wire, t, format.frames.map);
  write_counts(out, {1, landmarks.size(), 4});  // height: not in the order of an image; width; fields
  write_field(out, "x", 0, kFloat32);
  write_field(out, "y", 4, kFloat32);
  write_field(out, "z", 8, kFloat32);
  write_field(out, "id", 12, kUint32);
  out.number(std::uint8_t{0});  // little-endian
  write_counts(out, {kPointBytes, kPointBytes * landmarks.size()});
  std::string points;
  for (const Landmark& landmark : landmarks) {
    for (int axis = 0; axis < 3; ++axis) append_number(points, static_cast<float>(landmark.p_W[axis]));
    append_number(points, static_cast<std::uint32_t>(landmark.id));
  }
  out.bytes(as_bytes(points));
  out.number(std::uint8_t{1});  // no invalid points
  return out.message();
}

std::string occupancy_message(const Format& format, Timestamp t, const OccupancySlice& slice, double voxel_m) {
  WireWriter out = message_at(format.wire, t, format.frames.map);
  out.time(std::clamp(t, timestamp_from_ns(0), latest_stamp(format.wire)));
  out.number(static_cast<float>(voxel_m));
  write_counts(out, {static_cast<std::size_t>(slice.cells.cols), static_cast<std::size_t>(slice.cells.rows)});
  write_pose(out, {Eigen::Quaterniond::Identity(), {slice.corner_W.x(), slice.corner_W.y(), 0.0}});
  out.bytes({slice.cells.data, slice.cells.total()});
  return out.message();
}

std::string octomap_message(const Format& format, Timestamp t, const octomap::OcTree& tree) {
  std::ostringstream voxels;
  tree.writeBinaryData(voxels);
  WireWriter out = message_at(format.wire, t, format.frames.map);
  out.number(std::uint8_t{1});  // binary
  out.text(tree.getTreeType());
  out.number(tree.getResolution());
  out.bytes(as_bytes(voxels.str()));
  return out.message();
}

std::string tracks_message(const Format& format, Timestamp t, const CameraStep& camera) {
  const cv::Mat rendered = with_tracks(camera.image, camera.tracks);
  WireWriter out = message_at(format.wire, t, format.frames.prefix + camera.name);
  write_counts(out, {static_cast<std::size_t>(rendered.rows), static_cast<std::size_t>(rendered.cols)});
  out.text("bgr8");
  out.number(std::uint8_t{0});  // little-endian
  write_counts(out, {rendered.step[0]});
  out.bytes({rendered.data, rendered.total() * rendered.elemSize()});
  return out.message();
}

std::string vehicle_odometry_message(const VehicleOdometry& odometry) {
  WireWriter out(Wire::Cdr);
  const auto numbers = [&out](const auto& values) {
    for (const float value : values) out.number(value);
  };
  out.number(odometry.timestamp);
  out.number(odometry.timestamp_sample);
  out.number(odometry.pose_frame);
  numbers(odometry.position);
  numbers(odometry.q);
  out.number(odometry.velocity_frame);
  numbers(odometry.velocity);
  numbers(odometry.angular_velocity);
  numbers(odometry.position_variance);
  numbers(odometry.orientation_variance);
  numbers(odometry.velocity_variance);
  out.number(odometry.reset_counter);
  out.number(odometry.quality);
  return out.message();
}

std::string diagnostics_message(Wire wire, Timestamp t, const std::string& hardware, const Diagnosis& diagnosis) {
  WireWriter out = message_at(wire, t, "");
  write_counts(out, {1});
  out.number(static_cast<std::uint8_t>(diagnosis.level));
  out.text("edged: odometry");
  out.text(diagnosis.message);
  out.text(hardware);
  write_counts(out, {diagnosis.values.size()});
  for (const auto& [key, value] : diagnosis.values) {
    out.text(key);
    out.text(value);
  }
  return out.message();
}

}  // namespace edged::node
