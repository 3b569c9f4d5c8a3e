// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "edged/core/measurements/external_sensor.hpp"
#include "edged/imu/imu_gate.hpp"

namespace edged::node {
namespace {

/// Of all events that came, those that were left out as the node is too slow.
std::string dropped_percent(const NodeHealth& health) {
  std::size_t events = 0;
  for (const auto& [topic, input] : health.inputs) events += input.events;
  return fmt::format("{:.0f}", 100.0 * static_cast<double>(health.dropped.events) / static_cast<double>(events));
}

std::string summary(const NodeHealth& health) {
  std::string text = health.status ? to_string(*health.status) : "no packet yet";
  if (!health.reason.empty()) text += ": " + health.reason;
  for (const auto& [topic, input] : health.inputs) {
    if (input.messages == 0 && !input.optional && input.transport_trouble.empty())
      text += fmt::format("; nothing received on {}", topic);
    if (input.unreadable > 0) text += fmt::format("; {}: {}", topic, input.trouble);
    if (!input.transport_trouble.empty()) text += fmt::format("; {}: {}", topic, input.transport_trouble);
  }
  if (health.imu_clock_unknown)
    text += "; the offset of the IMU's clock is not known: turn the camera by hand about several axes for 10 s";
  if (!health.missing_transform.empty()) text += "; " + health.missing_transform;
  if (health.newly_lost > 0) text += fmt::format("; {} measurements lost since the last report", health.newly_lost);
  if (health.newly_lost > 0 && health.dropped.events > 0)
    text += fmt::format("; too slow: {} % of all events dropped", dropped_percent(health));
  return text;
}

Diagnosis::Level level_of(const NodeHealth& health) {
  if (health.status == TrackingStatus::Lost) return Diagnosis::Level::Error;
  const bool troubled =
      std::ranges::any_of(health.inputs, [](const auto& input) { return !input.second.transport_trouble.empty(); });
  const bool fine = health.status == TrackingStatus::Good && health.newly_lost == 0 && health.wrong_clocks == 0 &&
                    health.missing_transform.empty() && !health.imu_clock_unknown;
  return fine && !troubled ? Diagnosis::Level::Ok : Diagnosis::Level::Warning;
}

using Values = std::vector<std::pair<std::string, std::string>>;

void add_count(Values& values, const std::string& key, std::size_t count) {
  values.emplace_back(key, std::to_string(count));
}

void add_input(Values& values, const std::string& topic, const InputCounters& input) {
  add_count(values, topic + " messages", input.messages);
  if (input.events > 0) add_count(values, topic + " events", input.events);
  add_count(values, topic + " messages unreadable", input.unreadable);
  add_count(values, topic + " messages missed", input.missed);
  add_count(values, topic + " messages lost by the transport", input.lost);
  add_count(values, topic + " messages refused, too slow", input.refused);
  if (input.events == 0) return;
  add_count(values, topic + " events left out, after missing messages", input.left_out);
  add_count(values, topic + " steps of time back in a message", input.time_back);
  add_count(values, topic + " jumps of time ahead in a message", input.time_ahead);
  values.emplace_back(topic + " stamps off the clock of the sensor [ms]",
                      fmt::format("{:.1f}", 1e3 * to_seconds(input.stamp_jitter)));
}

struct Count {
  std::string what;
  std::size_t n;
  bool lost;  ///< measurements that are in no packet
};

std::vector<Count> counts_of(const NodeHealth& health) {
  const auto& [intake, packets, use] = health.odometry;
  std::vector<Count> counts{{"topics with stamps of another speed", health.wrong_clocks, false},
                            {"events left out, too slow", health.dropped.events, true},
                            {"frames left out, too slow", health.dropped.frames, true},
                            {"of an unknown camera", intake.unknown_camera, true},
                            {"of a camera not used", intake.unused_camera, false},
                            {"impossible stamps", intake.absurd_stamps, true},
                            {"stamps far ahead", intake.far_ahead, true},
                            {"clocks set back", intake.clocks_set_back, true},
                            {"events outside the image", intake.events_outside, true},
                            {"frames unfit", intake.frames_unfit, true},
                            {"no room", intake.no_room, true},
                            {"packets", packets.packets, false},
                            {"packets before the IMU", packets.packets_before_imu, false},
                            {"packets after the IMU", packets.packets_after_imu, false},
                            {"packets dropped, IMU away too long", packets.packets_overflow, true},
                            {"events late", packets.events_late, true},
                            {"events of bursts beyond any sensor's rate", packets.events_surplus, true},
                            {"events of flickering lamps", packets.events_flicker, false},
                            {"events of dropped packets", packets.events_lost, false},
                            {"frames late", packets.frames_late, true}};
  for (std::size_t i = 0; i < kImuFaults; ++i)
    counts.push_back({fmt::format("IMU samples {}", imu_fault_infos()[i].text), packets.imu[i],
                      static_cast<ImuFault>(i) != ImuFault::Spread});
  return counts;
}

}  // namespace

std::size_t lost_measurements(const NodeHealth& health) {
  std::size_t lost = 0;
  for (const Count& count : counts_of(health)) lost += count.lost ? count.n : 0;
  for (const auto& [topic, input] : health.inputs)  // what the transport lost is missing among the numbers, too
    lost += input.unreadable + std::max(input.missed, input.lost + input.refused);
  return lost;
}

Diagnosis diagnose(const NodeHealth& health) {
  Diagnosis diagnosis{level_of(health), summary(health), {}};
  Values& values = diagnosis.values;
  for (const auto& [topic, input] : health.inputs) add_input(values, topic, input);
  if (!health.request.empty()) values.emplace_back("last request", health.request);
  if (health.age)
    values.emplace_back("newest step behind newest measurement [s]", fmt::format("{:.3f}", to_seconds(*health.age)));
  for (const Count& count : counts_of(health)) add_count(values, count.what, count.n);
  if (health.dropped.events > 0) values.emplace_back("events left out, too slow [%]", dropped_percent(health));
  const auto& [intake, packets, use] = health.odometry;
  for (std::size_t i = 0; i < external_sensors().size(); ++i) {
    if (packets.external[i] == 0) continue;
    const std::string name(external_sensors()[i].name);
    add_count(values, name + " samples used", use.used[i]);
    add_count(values, name + " samples rejected", use.rejected[i]);
    add_count(values, name + " samples late", packets.external_late[i]);
  }
  return diagnosis;
}

}  // namespace edged::node
