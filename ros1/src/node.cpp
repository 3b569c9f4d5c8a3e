// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node.hpp"

#include <fmt/format.h>
#include <ros/console.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "edged/pipeline/mode.hpp"

namespace edged::ros1 {
namespace {

constexpr std::uint32_t kNoLimit = 0;  // excess measurements are dropped and counted by the backlog or the odometry
constexpr unsigned kThreads = 3;       // one for each sensor that every rig has
constexpr Duration kRecentImu = std::chrono::seconds(2);
constexpr auto kLongestWait = std::chrono::milliseconds(50);
constexpr double kDiagnosticsPeriod_s = 1.0;

Bytes bytes_of(const topic_tools::ShapeShifter& message) {
  Bytes bytes(message.size());
  ros::serialization::OStream stream(bytes.data(), message.size());
  message.write(stream);
  return bytes;
}

}  // namespace

Node::Node(const NodeConfig& config, const Calibration& calibration)
    : private_("~"),
      rig_name_(calibration.rig.name),
      odometry_(calibration.rig, calibration.imu, config.mode, config.options, {config.delays, Inference::OwnThread}),
      backlog_(config.max_age_s),
      outputs_(private_, config),
      spinner_(kThreads) {
  // The first of a kind has a short name for its topic, another has its own.
  const Rig used = used_cameras(calibration.rig, config.mode, config.options.cameras);
  for (const RigCamera& camera : used.cameras) {
    const bool events = camera.modality == Modality::Events, first = &camera == used.find(camera.modality);
    const std::string topic = events ? "events" : "image";
    subscribe(first ? topic : camera.name + "/" + topic, events ? Role::Events : Role::Frames, camera.name);
    if (!first) outputs_.add_camera(private_, camera.name);
  }
  for (const Role role : {Role::Imu, Role::Height, Role::Velocity})
    subscribe(kRoleNames[static_cast<std::size_t>(role)], role, "");
}

/// Any type is accepted: the message has its type. Messages of one topic arrive one by one, in order.
void Node::subscribe(const std::string& topic, Role role, const std::string& camera) {
  const std::string name = public_.resolveName(topic);
  SensorInput& input = inputs_.try_emplace(name, role, camera).first->second;
  using Message = topic_tools::ShapeShifter;
  const auto callback = [this, &input](const Message::ConstPtr& message) { on_message(input, *message); };
  subscriptions_.push_back(
      public_.subscribe<Message>(topic, kNoLimit, callback, nullptr, ros::TransportHints().tcpNoDelay()));
  ROS_INFO("%s from %s", kRoleNames[static_cast<std::size_t>(role)], name.c_str());
}

void Node::on_message(SensorInput& input, const topic_tools::ShapeShifter& message) {
  const Bytes bytes = bytes_of(message);
  std::optional<Measurement> measurement = input.read({message.getDataType(), message.getMD5Sum(), bytes});
  if (!measurement || !backlog_.admit(*measurement)) return;
  std::optional<ImuSample> sample;
  if (const auto* imu = std::get_if<ImuSample>(&*measurement)) sample = *imu;
  odometry_.add(std::move(*measurement));
  if (sample) predict(*sample);
  {
    const std::lock_guard lock(mutex_);
    something_new_ = true;
  }
  added_.notify_one();
}

void Node::predict(const ImuSample& sample) {
  std::optional<StateCovariance> covariance;
  Duration back(0);
  {
    const std::lock_guard lock(mutex_);
    if (recent_imu_.empty() || sample.t > recent_imu_.back().t) recent_imu_.push_back(sample);
    while (sample.t - recent_imu_.front().t > kRecentImu) recent_imu_.pop_front();
    back = recent_imu_.back().t - sample.t;
    covariance = covariance_;
  }
  if (back > kRecentImu)
    ROS_ERROR_THROTTLE(5, "the clock of the IMU has jumped back by %.1f s: restart the node", to_seconds(back));
  // A late sample is ignored.
  if (const auto state = odometry_.newest_state(); state && state->t == sample.t)
    outputs_.publish_prediction(*state, sample.gyro_B, covariance);
}

Eigen::Vector3d Node::gyro_at(Timestamp t) {
  const std::lock_guard lock(mutex_);
  const auto after = std::ranges::find_if(recent_imu_.rbegin(), recent_imu_.rend(),
                                          [t](const ImuSample& sample) { return sample.t <= t; });
  return after == recent_imu_.rend() ? Eigen::Vector3d::Zero().eval() : after->gyro_B;
}

void Node::run(const std::function<bool()>& stop) {
  spinner_.start();
  ros::WallTime next_diagnostics;
  while (ros::ok() && !stop()) {
    if (!make_step()) wait();
    if (ros::WallTime::now() < next_diagnostics) continue;
    publish_diagnostics();
    next_diagnostics = ros::WallTime::now() + ros::WallDuration(kDiagnosticsPeriod_s);
  }
  spinner_.stop();
  odometry_.finish();
  while (make_step()) continue;
  for (const auto& value : publish_diagnostics().values) ROS_INFO("%s: %s", value.key.c_str(), value.value.c_str());
}

/// Whether there was work.
bool Node::make_step() {
  const std::optional<Step> step = odometry_.next();
  if (!step) {
    backlog_.note_idle();
    return false;
  }
  backlog_.note_step(step->t);
  report(*step);
  {
    const std::lock_guard lock(mutex_);
    covariance_ = step->covariance;
  }
  outputs_.publish(*step, gyro_at(step->t), odometry_.rig());
  return true;
}

void Node::report(const Step& step) {
  reason_ = step.status == TrackingStatus::Lost ? step.lost_because : step.waiting_for;
  if (!step.started.empty()) ROS_INFO("%s", step.started.c_str());
  if (status_ == step.status) return;
  status_ = step.status;
  const std::string text = fmt::format("{}{}{}", to_string(step.status), reason_.empty() ? "" : ": ", reason_);
  if (step.status == TrackingStatus::Lost) {
    ROS_WARN("%s", text.c_str());
  } else {
    ROS_INFO("%s", text.c_str());
  }
}

NodeHealth Node::health() {
  NodeHealth health{status_, reason_, {}, odometry_.counters(), backlog_.counters(), 0, backlog_.age()};
  for (const auto& [topic, input] : inputs_) health.inputs.emplace(topic, input.counters());
  const std::size_t lost = lost_measurements(health);
  health.newly_lost = lost - std::exchange(lost_, lost);
  return health;
}

diagnostic_msgs::DiagnosticStatus Node::publish_diagnostics() {
  diagnostic_msgs::DiagnosticStatus status = diagnostics_message(health(), rig_name_);
  outputs_.publish(status);
  return status;
}

void Node::wait() {
  std::unique_lock lock(mutex_);
  added_.wait_for(lock, kLongestWait, [this] { return something_new_; });
  something_new_ = false;
}

}  // namespace edged::ros1
