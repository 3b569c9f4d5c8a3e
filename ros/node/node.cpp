// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/node.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/pipeline/mode.hpp"

namespace edged::node {
namespace {

using SteadyClock = std::chrono::steady_clock;
constexpr Duration kRecentImu = std::chrono::seconds(2);
constexpr auto kLongestWait = std::chrono::milliseconds(50);
constexpr auto kDiagnosticsPeriod = std::chrono::seconds(1);
constexpr Duration kMostJitter = std::chrono::milliseconds(5);

/// Stops the transport, whose threads call the node, however the scope is left.
class TransportStop {
 public:
  explicit TransportStop(Transport& transport) : transport_(transport) {}
  ~TransportStop() { transport_.stop(); }
  TransportStop(const TransportStop&) = delete;
  TransportStop& operator=(const TransportStop&) = delete;

 private:
  Transport& transport_;
};

/// What is wrong with a topic, each with its remedy; a text that does not change while it stays wrong.
std::vector<std::string> troubles_of(const std::string& topic, const InputCounters& input) {
  std::vector<std::string> all;
  if (!input.transport_trouble.empty()) all.push_back(topic + ": " + input.transport_trouble);
  if (!input.trouble.empty()) all.push_back(fmt::format("{}: unreadable messages: {}", topic, input.trouble));
  if (input.missed > input.lost + input.refused)
    all.push_back(topic +
                  ": numbers are missing, or stamps of the IMU, so messages were lost before they came here (counted "
                  "in /diagnostics): raise net.core.rmem_max, or lower the rate");
  if (input.refused > 0)
    all.push_back(topic +
                  ": messages were refused, as this computer is too slow: lower the rate, or use fewer cameras");
  if (input.lost > 0)
    all.push_back(
        topic +
        ": messages were lost on the way (counted in /diagnostics): raise net.core.rmem_max, or lower the rate");
  if (input.time_back > 0)
    all.push_back(topic +
                  ": time goes back within messages: the driver loses data at high rates; lower its bias or rate");
  if (input.time_ahead > 0) all.push_back(topic + ": time jumps ahead within messages: the driver loses data");
  if (input.stamp_jitter > kMostJitter)
    all.push_back(topic + ": stamps of the messages are those of their arrival; the clock of the sensor is used");
  return all;
}

}  // namespace

Node::Node(const NodeConfig& config, const Calibration& calibration, Transport& transport)
    : transport_(transport),
      rig_name_(calibration.rig.name),
      odometry_(calibration.rig, calibration.imu, config.mode, config.options, {config.delays, Inference::OwnThread}),
      backlog_(config.max_age_s),
      outputs_(transport, config),
      autopilot_(transport, config) {
  // The first of a kind has a short name for its topic, another has its own.
  const Rig used = used_cameras(calibration.rig, config.mode, config.options.cameras);
  for (const RigCamera& camera : used.cameras) {
    const bool events = camera.modality == Modality::Events, first = &camera == used.find(camera.modality);
    const std::string topic = events ? "events" : "image";
    outputs_.add_camera(camera.name, first ? (events ? "events" : "frames") : camera.name);
    subscribe(first ? topic : camera.name + "/" + topic, events ? Role::Events : Role::Frames, camera.name);
  }
  for (const Role role : {Role::Imu, Role::Height, Role::Velocity})
    subscribe(kRoleNames[static_cast<std::size_t>(role)], role, "");
  outputs_.publish_cameras(transport.now(), used);
  load_map(config);
}

void Node::load_map(const NodeConfig& config) {
  if (config.map_file.empty()) {
    if (config.options.map.localize_only)
      throw InputError("map.localize_only needs the map to localize in: set map_file, too");
    return;
  }
  std::ifstream in(config.map_file, std::ios::binary);
  try {
    odometry_.load_map(std::string(std::istreambuf_iterator<char>(in), {}));
  } catch (const InputError& e) {
    throw InputError::format("map_file {}: {}", config.map_file, in.is_open() ? e.what() : "cannot be read");
  }
}

void Node::subscribe(const std::string& topic, Role role, const std::string& camera) {
  const std::string name = transport_.full_name(topic);
  const auto [entry, is_new] = inputs_.try_emplace(name, transport_.wire(), role, camera);
  SensorInput& input = entry->second;
  if (!is_new)
    throw InputError::format("{} is to be both {} and {}: remap one of them", name, input.sensor(),
                             sensor_text(role, camera));
  if (!clocks_) clocks_.emplace(name);  // the first camera's
  transport_.subscribe(name, role, [this, name, &input](const WireMessage& message) {
    try {
      on_message(name, input, message);
    } catch (...) {  // which would end the process from a thread of the transport
      fail(std::current_exception());
    }
  });
  spdlog::info(fmt::format("{} from {}", input.sensor(), name));
}

void Node::fail(std::exception_ptr failure) {
  const std::lock_guard lock(mutex_);
  if (!failure_) failure_ = std::move(failure);
}

bool Node::failed() {
  const std::lock_guard lock(mutex_);
  return failure_ != nullptr;
}

void Node::on_message(const std::string& topic, SensorInput& input, const WireMessage& message) {
  std::optional<Measurement> measurement = input.read(message);
  if (!measurement) return;
  if (const auto stamp = last_stamp(*measurement))
    if (const auto wrong = clocks_->note(topic, *stamp)) spdlog::warn(*wrong);
  if (!backlog_.admit(*measurement)) return;
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
    if (!recent_imu_.empty()) back = recent_imu_.back().t - sample.t;
    if (back > kRecentImu) recent_imu_.clear();
    if (recent_imu_.empty() || sample.t > recent_imu_.back().t) recent_imu_.push_back(sample);
    while (sample.t - recent_imu_.front().t > kRecentImu) recent_imu_.pop_front();
    covariance = covariance_;
  }
  if (back > kRecentImu)
    spdlog::warn(
        fmt::format("the clock of the IMU has jumped back by {:.1f} s: the estimate starts anew once all "
                    "sensors have followed",
                    to_seconds(back)));
  // A late sample is ignored.
  const std::optional<NavState> state = odometry_.newest_state();
  if (!state || state->t != sample.t) return;
  autopilot_.send(*state, sample);
  outputs_.publish_prediction({*state, sample.gyro_B, covariance});
}

Eigen::Vector3d Node::gyro_at(Timestamp t) {
  const std::lock_guard lock(mutex_);
  const auto after = std::ranges::find_if(recent_imu_.rbegin(), recent_imu_.rend(),
                                          [t](const ImuSample& sample) { return sample.t <= t; });
  return after == recent_imu_.rend() ? Eigen::Vector3d::Zero().eval() : after->gyro_B;
}

Diagnosis Node::run(const std::function<bool()>& stop) {
  receive(stop);
  if (failure_) std::rethrow_exception(failure_);
  odometry_.finish();
  while (make_step()) continue;
  return publish_diagnostics();
}

void Node::receive(const std::function<bool()>& stop) {
  const TransportStop stopped_at_end(transport_);
  transport_.start();
  SteadyClock::time_point next_diagnostics;
  while (transport_.ok() && !failed() && !stop()) {
    if (!make_step()) wait();
    if (SteadyClock::now() < next_diagnostics) continue;
    publish_diagnostics();
    next_diagnostics = SteadyClock::now() + kDiagnosticsPeriod;
  }
}

/// Whether there was work.
bool Node::make_step() {
  const std::optional<Step> step = odometry_.next();
  if (!step) {
    backlog_.note_idle();
    return false;
  }
  backlog_.note_step(step->t);
  autopilot_.note(*step);
  report(*step);
  {
    const std::lock_guard lock(mutex_);
    covariance_ = step->covariance;
  }
  outputs_.publish(*step, gyro_at(step->t));
  if (is_tracking(step->status)) outputs_.publish_cameras(step->t, odometry_.rig());
  return true;
}

void Node::report(const Step& step) {
  reason_ = step.status == TrackingStatus::Lost ? step.lost_because : step.waiting_for;
  if (!step.started.empty()) spdlog::info(step.started);
  if (status_ == step.status) return;
  status_ = step.status;
  const auto level = step.status == TrackingStatus::Lost ? spdlog::level::warn : spdlog::level::info;
  spdlog::log(level, fmt::format("{}{}{}", to_string(step.status), reason_.empty() ? "" : ": ", reason_));
}

NodeHealth Node::health() {
  NodeHealth health{status_, reason_,       {}, odometry_.counters(), backlog_.counters(), clocks_->wrong(),
                    0,       backlog_.age()};
  for (const auto& [topic, input] : inputs_) health.inputs.emplace(topic, input.counters());
  for (const auto& [topic, troubles] : transport_.troubles()) {
    InputCounters& input = health.inputs[topic];
    input.lost = troubles.lost;
    input.refused = troubles.refused;
    input.transport_trouble = troubles.trouble;
  }
  const std::size_t lost = lost_measurements(health);
  health.newly_lost = lost - std::exchange(lost_, lost);
  return health;
}

/// Each once in the log; the counters go on in the diagnostics.
void Node::report_troubles(const NodeHealth& health) {
  constexpr std::size_t kMostLines = 100;  // texts of damaged messages may differ without end
  for (const auto& [topic, input] : health.inputs)
    for (const std::string& trouble : troubles_of(topic, input))
      if (said_.size() < kMostLines && said_.insert(trouble).second) spdlog::warn(trouble);
}

Diagnosis Node::publish_diagnostics() {
  const NodeHealth now = health();
  report_troubles(now);
  Diagnosis diagnosis = diagnose(now);
  outputs_.publish(diagnosis, rig_name_);
  return diagnosis;
}

void Node::wait() {
  std::unique_lock lock(mutex_);
  added_.wait_for(lock, kLongestWait, [this] { return something_new_; });
  something_new_ = false;
}

}  // namespace edged::node
