// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/base_frame.hpp"

#include <fmt/format.h>

#include <sstream>

#include "edged/core/check.hpp"
#include "edged/core/config/option_text.hpp"

namespace edged::node {
namespace {

constexpr std::size_t kMostFrames = 10'000;     // of a robot's description
constexpr std::size_t kSmallestTransform = 64;  // bytes of a TransformStamped

/// "x y z roll pitch yaw", as static_transform_publisher has them [m], [rad].
SE3 pose_from(const std::string& text) {
  std::istringstream in(text);
  Eigen::Vector3d p, rpy;
  std::string rest;
  for (double& number : p) in >> number;
  for (double& number : rpy) in >> number;
  if (in.fail() || in >> rest || !p.allFinite() || !rpy.allFinite())
    throw InputError::format("body_pose '{}': give six numbers, x y z [m] roll pitch yaw [rad]", text);
  return {rotation_of(rpy), p};
}

}  // namespace

void StaticTransforms::add(Wire wire, ByteSpan message) {
  const std::lock_guard lock(mutex_);
  try {
    WireReader reader(wire, message);
    for (std::uint32_t left = reader.list(kSmallestTransform); left > 0; --left) {
      std::string_view parent;
      reader.header(&parent);
      const std::string child(reader.text());
      const Eigen::Vector3d p = reader.vector<3>();
      const Eigen::Vector4d q = reader.vector<4>();
      const bool usable = p.allFinite() && std::abs(q.norm() - 1.0) < 1e-3;
      if (usable && (edges_.contains(child) || edges_.size() < kMostFrames))
        edges_.insert_or_assign(child, Edge{std::string(parent), SE3(Eigen::Quaterniond(q[3], q[0], q[1], q[2]), p)});
    }
  } catch (const Damage&) {  // the publisher's next message will do
  }
}

StaticTransforms::FromRoot StaticTransforms::from_root(std::string frame) const {
  SE3 T_ancestor_frame;
  for (std::size_t steps = 0; steps < edges_.size(); ++steps) {  // a circle has no root
    const auto edge = edges_.find(frame);
    if (edge == edges_.end()) break;
    T_ancestor_frame = edge->second.T_parent_child * T_ancestor_frame;
    frame = edge->second.parent;
  }
  return {std::move(frame), T_ancestor_frame};
}

std::optional<SE3> StaticTransforms::find(const std::string& parent, const std::string& child) const {
  const std::lock_guard lock(mutex_);
  const FromRoot of_parent = from_root(parent), of_child = from_root(child);
  if (of_parent.root != of_child.root) return std::nullopt;
  return of_parent.T_root_frame.inverse() * of_child.T_root_frame;
}

BaseFrame::BaseFrame(Transport& transport, const NodeConfig& config) : frames_(config.frame_names()) {
  const bool is_body = frames_.base == frames_.body;
  if (!config.body_pose.empty()) {
    if (is_body) throw InputError("body_pose is the pose of the IMU in base_frame: set base_frame, too");
    T_base_B_ = pose_from(config.body_pose);
  } else if (!is_body) {
    transport.subscribe_type(
        transport.full_name("/tf_static"), "tf2_msgs/TFMessage", true,
        [this, wire = transport.wire()](const WireMessage& message) { transforms_.add(wire, message.bytes); });
  }
}

std::optional<SE3> BaseFrame::on_body() const {
  if (frames_.base == frames_.body) return SE3();
  if (T_base_B_) return T_base_B_->inverse();
  return transforms_.find(frames_.body, frames_.base);
}

std::string BaseFrame::waiting_for() const {
  if (on_body()) return "";
  return fmt::format("no transform from {} to {} on /tf_static: publish the robot's description, or set body_pose",
                     frames_.base, frames_.body);
}

}  // namespace edged::node
