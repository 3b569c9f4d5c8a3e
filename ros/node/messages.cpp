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

std::string odometry_message(const Format& format, const Estimate& estimate) {
  const NavState& state = estimate.state;
  WireWriter out = message_at(format.wire, state.t, format.frames.world);
  out.text(format.frames.body);
  write_pose(out, state.T_W_B);
  write_covariance(out, pose_covariance(estimate));
  write_vector(out, state.T_W_B.rotation().conjugate() * state.v_W);
  write_vector(out, estimate.gyro_B - state.bias_gyro);
  write_covariance(out, twist_covariance(estimate));
  return out.message();
}

std::string pose_message(const Format& format, const Estimate& estimate) {
  WireWriter out = message_at(format.wire, estimate.state.t, format.frames.world);
  write_pose(out, estimate.state.T_W_B);
  write_covariance(out, pose_covariance(estimate));
  return out.message();
}

std::string path_message(const Format& format, Timestamp t, const std::deque<StampedPose>& poses) {
  WireWriter out = message_at(format.wire, t, format.frames.world);
  write_counts(out, {poses.size()});
  for (const StampedPose& pose : poses) {
    write_header(out, format.wire, pose.t, format.frames.world);
    write_pose(out, pose.T);
  }
  return out.message();
}

std::string body_transform_message(const Format& format, const NavState& state) {
  WireWriter out(format.wire);
  write_counts(out, {1});
  write_transform(out, format.wire, state.t, format.frames.world, format.frames.body, state.T_W_B);
  return out.message();
}

std::string camera_transforms_message(const Format& format, Timestamp t, const Rig& rig) {
  WireWriter out(format.wire);
  write_counts(out, {rig.cameras.size()});
  for (const RigCamera& camera : rig.cameras)
    write_transform(out, format.wire, t, format.frames.body, camera.name, camera.T_B_C);
  return out.message();
}

std::string landmarks_message(const Format& format, Timestamp t, std::span<const Landmark> landmarks) {
  constexpr std::uint8_t kUint32 = 6, kFloat32 = 7;  // of sensor_msgs/PointField
  constexpr std::size_t kPointBytes = 16;
  WireWriter out = message_at(format.wire, t, format.frames.world);
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
  WireWriter out = message_at(format.wire, t, format.frames.world);
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
  WireWriter out = message_at(format.wire, t, format.frames.world);
  out.number(std::uint8_t{1});  // binary
  out.text(tree.getTreeType());
  out.number(tree.getResolution());
  out.bytes(as_bytes(voxels.str()));
  return out.message();
}

std::string tracks_message(Wire wire, Timestamp t, const CameraStep& camera) {
  const cv::Mat rendered = with_tracks(camera.image, camera.tracks);
  WireWriter out = message_at(wire, t, camera.name);
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
