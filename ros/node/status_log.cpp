// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/status_log.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>
#include <vector>

namespace edged::node {
namespace {

constexpr auto kWaitPeriod = std::chrono::seconds(5);
constexpr Duration kMostJitter = std::chrono::milliseconds(5);
constexpr std::size_t kMostLines = 100;  // texts of damaged messages may differ without end

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
  for (const ClockStep& step : input.clock_steps)
    all.push_back(fmt::format("{}: the clock of {} was set by {:+.3f} s: {}", topic,
                              step.of_stamps ? "the stamps" : "the sensor",
                              to_seconds(step.of_stamps ? step.stamps_by : -step.stamps_by),
                              step.of_stamps ? "the estimate continues" : "it is aligned again"));
  if (input.stamp_jitter > kMostJitter)
    all.push_back(topic + ": stamps of the messages are those of their arrival; the clock of the sensor is used");
  return all;
}

}  // namespace

void StatusLog::add(const Step& step) {
  reason_ = step.status == TrackingStatus::Lost       ? step.lost_because
            : step.status == TrackingStatus::Degraded ? step.degraded_because
                                                      : step.waiting_for;
  if (!step.started.empty()) spdlog::info(step.started);
  if (std::exchange(status_, step.status) == step.status) return;
  const auto level = step.status == TrackingStatus::Lost ? spdlog::level::warn : spdlog::level::info;
  spdlog::log(level, fmt::format("{}{}{}", to_string(step.status), reason_.empty() ? "" : ": ", reason_));
}

void StatusLog::complete(NodeHealth& health) {
  health.status = status_;
  health.reason = reason_;
  const std::size_t lost = lost_measurements(health);
  const std::size_t before = std::exchange(lost_, lost);
  health.newly_lost = lost > before ? lost - before : 0;  // counters of the odometry begin anew with it
  const auto now = DropReport::Clock::now();
  const bool waits = !status_ || *status_ == TrackingStatus::Initializing;
  if (!waits || now - waits_from_ >= kWaitPeriod) {
    if (waits) spdlog::warn("waiting: " + diagnose(health).message);
    waits_from_ = now;
  }
  if (const auto line = drops_.update(health.dropped, now)) spdlog::warn(*line);
  if (!health.missing_transform.empty() && said_.insert(health.missing_transform).second)
    spdlog::warn(health.missing_transform);
  for (const auto& [topic, input] : health.inputs)
    for (const std::string& trouble : troubles_of(topic, input))
      if (said_.size() < kMostLines && said_.insert(trouble).second) spdlog::warn(trouble);
}

}  // namespace edged::node
