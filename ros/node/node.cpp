// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/node.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/map/saved_map.hpp"
#include "edged/pipeline/mode.hpp"

namespace edged::node {
namespace {

using SteadyClock = std::chrono::steady_clock;
constexpr auto kLongestWait = std::chrono::milliseconds(50);
constexpr double kJump_m = 0.05;  // of the pose in the map that is logged
constexpr auto kDiagnosticsPeriod = std::chrono::seconds(1);

/// What is published has stamps of the clock as it is set now.
void stamp(Step& step, std::optional<Estimate>& base, Duration set_by) {
  step.t += set_by;
  step.state.t += set_by;
  for (KeyframeRecord& keyframe : step.marginalized_keyframes) keyframe.t += set_by;
  if (base) base->state.t += set_by;
}

}  // namespace

Node::Node(const NodeConfig& config, const Calibration& calibration, Transport& transport)
    : transport_(transport),
      rig_name_(calibration.rig.name),
      make_odometry_([config, calibration] {
        return Odometry(calibration.rig, calibration.imu, config.mode, config.options,
                        {config.delays, Inference::OwnThread, false});
      }),
      odometry_(make_odometry_()),
      base_(transport, config),
      outputs_(transport, config, base_.given()),
      imu_rate_(transport, config, calibration.imu.gyro_noise),
      inputs_(transport, config.max_age_s,
              [this](const ImuSample& sample) { imu_rate_.add(sample, inputs_.clock_set_by()); }),
      requests_(transport) {
  // The first of a kind has a short name for its topic, another has its own.
  const Rig used = used_cameras(calibration.rig, config.mode, config.options.cameras);
  for (const RigCamera& camera : used.cameras) {
    const bool events = camera.modality == Modality::Events, first = &camera == used.find(camera.modality);
    const std::string topic = events ? "events" : "image";
    outputs_.add_camera(camera.name, first ? (events ? "events" : "frames") : camera.name);
    inputs_.subscribe(first ? topic : camera.name + "/" + topic, events ? Role::Events : Role::Frames, camera.name);
  }
  inputs_.subscribe("imu", Role::Imu, "");
  if (!config.imu_time_offset.empty())
    inputs_.set_imu_clock({given_imu_offset_s(config.imu_time_offset), 1.0, used.cameras, calibration.has_extrinsics});
  for (std::size_t i = 0; i < kExternalSensors; ++i)
    inputs_.subscribe(std::string(external_sensors()[i].name), external_role(i), "");
  outputs_.publish_cameras(transport.now(), used);
  load_map(config);
}

void Node::load_map(const NodeConfig& config) {
  if (config.map_file.empty()) {
    if (config.options.map.localize_only)
      throw InputError("map.localize_only needs the map to localize in: set map_file, too");
    return;
  }
  try {
    const std::string map = read_map_file(config.map_file);
    odometry_.load_map(map);
    if (config.options.map.localize_only) loaded_map_ = map;
  } catch (const InputError& e) {
    throw InputError::format("map_file {}: {}", config.map_file, e.what());
  }
}

/// Its result is a line of the log, and in the diagnostics.
void Node::serve(const Request& request) {
  try {
    served_ = fmt::format("{}: {}", request.text(), result_of(request));
    spdlog::info(served_);
  } catch (const InputError& e) {
    served_ = fmt::format("{}: not done: {}", request.text(), e.what());
    spdlog::error(served_);
  }
}

std::string Node::result_of(const Request& request) {
  if (request.kind == Request::Kind::SaveMap) return save_map(request.file);
  Odometry fresh = make_odometry_();
  if (request.kind == Request::Kind::Reset) {
    if (!loaded_map_.empty()) fresh.load_map(loaded_map_);
    start_anew(std::move(fresh));
    return loaded_map_.empty() ? "the estimate starts again, in a new map" : "the body is searched in the loaded map";
  }
  const std::string map = read_map_file(request.file);
  fresh.load_map(map);
  if (!loaded_map_.empty()) loaded_map_ = map;
  start_anew(std::move(fresh));
  return "the estimate starts again, and the body is searched in this map";
}

std::string Node::save_map(const std::string& file) const {
  const std::optional<std::string> map = odometry_.save_map();
  if (!map) throw InputError("there is no map, or the body has not been found in the loaded one");
  const std::size_t keyframes = saved_map_from_bytes(*map).keyframes.size();
  if (keyframes == 0) throw InputError("no keyframe has left the window yet, or map.enabled is false");
  write_map_file(file, *map);
  return fmt::format("done: {} keyframes, {:.1f} MB", keyframes, 1e-6 * static_cast<double>(map->size()));
}

void Node::start_anew(Odometry fresh) {
  odometry_ = std::move(fresh);
  odom_ = OdomFrame();
  newest_step_.reset();
  imu_rate_.forget();
  outputs_.clear();
}

Diagnosis Node::run(const std::function<bool()>& stop) {
  try {
    receive(stop);
  } catch (...) {
    inputs_.interrupt();
    transport_.stop();  // whose threads call this node
    throw;
  }
  add_waiting();  // so that no thread of the transport waits for room
  transport_.stop();
  add_waiting();
  odometry_.finish();
  while (make_step()) continue;
  return publish_diagnostics();
}

void Node::receive(const std::function<bool()>& stop) {
  transport_.start();
  SteadyClock::time_point next_diagnostics;
  while (transport_.ok() && !stop()) {
    while (const auto request = requests_.next()) serve(*request);
    if (!make_step())
      if (std::optional<Measurement> measurement = inputs_.next(kLongestWait)) odometry_.add(std::move(*measurement));
    if (SteadyClock::now() < next_diagnostics) continue;
    publish_diagnostics();
    next_diagnostics = SteadyClock::now() + kDiagnosticsPeriod;
  }
}

void Node::add_waiting() {
  while (std::optional<Measurement> measurement = inputs_.next({})) odometry_.add(std::move(*measurement));
}

/// Whether there was work.
bool Node::make_step() {
  std::optional<Step> step = odometry_.next();
  if (!step) return false;
  newest_step_ = step->t;
  log_.add(*step);
  if (const double moved_m = odom_.note(*step); moved_m > kJump_m)
    spdlog::info(fmt::format("the map has moved the pose by {:.2f} m", moved_m));
  const SE3 T_map_odom = odom_.T_M_odom();
  const std::optional<SE3> T_B_base = base_.on_body();
  std::optional<Estimate> base;
  if (T_B_base) base = at(*T_B_base, imu_rate_.estimate_of(*step));
  imu_rate_.note(*step, T_map_odom, T_B_base);
  stamp(*step, base, inputs_.clock_set_by());
  outputs_.publish(*step, base, T_map_odom);
  if (is_tracking(step->status)) outputs_.publish_cameras(step->t, odometry_.rig());
  return true;
}

Diagnosis Node::publish_diagnostics() {
  NodeHealth health;
  health.odometry = odometry_.counters();
  inputs_.describe(health);
  health.request = served_;
  if (newest_step_) health.missing_transform = base_.waiting_for();
  log_.complete(health);
  if (const auto newest = imu_rate_.newest(); newest && newest_step_) health.age = *newest - *newest_step_;
  Diagnosis diagnosis = diagnose(health);
  outputs_.publish(diagnosis, rig_name_);
  return diagnosis;
}

}  // namespace edged::node
