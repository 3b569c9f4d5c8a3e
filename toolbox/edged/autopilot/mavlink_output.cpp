// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/autopilot/mavlink_output.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <chrono>

namespace edged {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr auto kHeartbeatPeriod = std::chrono::seconds(1);
constexpr auto kLongestWait = std::chrono::milliseconds(50);

}  // namespace

MavlinkOutput::MavlinkOutput(const std::string& url, const AutopilotConfig& config)
    : url_(url),
      port_(url),
      encoder_({static_cast<std::uint8_t>(config.system_id), static_cast<std::uint8_t>(config.component_id)}),
      stream_(config),
      thread_([this](const std::stop_token& stop) { serve(stop); }) {}

Duration MavlinkOutput::unix_now() { return std::chrono::system_clock::now().time_since_epoch(); }

void MavlinkOutput::note(const Step& step) {
  const std::lock_guard lock(mutex_);
  stream_.note(step);
}

bool MavlinkOutput::send(const NavState& state, const Eigen::Vector3d& gyro_B, Duration unix_time) {
  const std::lock_guard lock(mutex_);
  const std::optional<VehicleOdometry> odometry = stream_.next(state, gyro_B, unix_time);
  if (!odometry) return false;
  put(encoder_.odometry(*odometry), counters_.odometry);
  return true;
}

void MavlinkOutput::put(const MavlinkFrame& frame, std::size_t& counter) {
  if (port_.send(frame)) {
    ++counter;
  } else if (counters_.dropped++ == 0) {
    spdlog::warn(fmt::format("{}: a message was not sent: {}", url_, port_.failure()));
  }
}

MavlinkCounters MavlinkOutput::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

void MavlinkOutput::serve(const std::stop_token& stop) {
  MavlinkDecoder decoder;
  for (auto heartbeat = SteadyClock::now() + kHeartbeatPeriod; !stop.stop_requested();) {
    const bool arrived = port_.wait(kLongestWait);
    std::vector<std::uint8_t> bytes;
    {
      const std::lock_guard lock(mutex_);
      if (arrived) bytes = port_.receive();
      for (const MavlinkTimesync& request : decoder.add(bytes))
        put(encoder_.timesync(request, unix_now().count()), counters_.timesyncs);
      if (SteadyClock::now() >= heartbeat) {
        put(encoder_.heartbeat(), counters_.heartbeats);
        heartbeat = SteadyClock::now() + kHeartbeatPeriod;
      }
    }
    if (arrived && bytes.empty()) std::this_thread::sleep_for(kLongestWait);  // a broken line is always ready
  }
}

}  // namespace edged
