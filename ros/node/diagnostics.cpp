// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "edged/core/measurements/external_sensor.hpp"

namespace edged::node {
namespace {

std::string summary(const NodeHealth& health) {
  std::string text = health.status ? to_string(*health.status) : "no packet yet";
  if (!health.reason.empty()) text += ": " + health.reason;
  for (const auto& [topic, input] : health.inputs) {
    if (input.messages == 0 && !input.optional && input.transport_trouble.empty())
      text += fmt::format("; nothing has come on {}", topic);
    if (input.unreadable > 0) text += fmt::format("; {}: {}", topic, input.trouble);
    if (!input.transport_trouble.empty()) text += fmt::format("; {}: {}", topic, input.transport_trouble);
  }
  if (health.newly_lost > 0) text += fmt::format("; {} measurements lost since the last report", health.newly_lost);
  return text;
}

Diagnosis::Level level_of(const NodeHealth& health) {
  if (health.status == TrackingStatus::Lost) return Diagnosis::Level::Error;
  const bool troubled =
      std::ranges::any_of(health.inputs, [](const auto& input) { return !input.second.transport_trouble.empty(); });
  const bool fine = health.status == TrackingStatus::Good && health.newly_lost == 0 && health.wrong_clocks == 0;
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

}  // namespace

std::size_t lost_measurements(const NodeHealth& health) {
  const IntakeCounters& intake = health.odometry.intake;
  const PacketizerCounters& packets = health.odometry.packets;
  std::size_t lost = intake.unknown_camera + intake.absurd_stamps + intake.far_ahead + intake.clocks_set_back +
                     intake.events_outside + intake.frames_unfit + intake.no_room + packets.packets_overflow +
                     packets.events_late + packets.frames_late + packets.imu_not_finite + packets.imu_late +
                     health.left_out.events + health.left_out.frames;
  for (const auto& [topic, input] : health.inputs)  // what the transport lost is missing among the numbers, too
    lost += input.unreadable + std::max(input.missed, input.lost + input.refused);
  return lost;
}

Diagnosis diagnose(const NodeHealth& health) {
  Diagnosis diagnosis{level_of(health), summary(health), {}};
  Values& values = diagnosis.values;
  const auto count = [&](const std::string& key, std::size_t n) { add_count(values, key, n); };
  for (const auto& [topic, input] : health.inputs) add_input(values, topic, input);
  if (health.age)
    values.emplace_back("newest step behind newest measurement [s]", fmt::format("{:.3f}", to_seconds(*health.age)));
  count("topics with stamps of another speed", health.wrong_clocks);
  count("events left out, too slow", health.left_out.events);
  count("frames left out, too slow", health.left_out.frames);
  const auto& [intake, packets, use] = health.odometry;
  count("of an unknown camera", intake.unknown_camera);
  count("of a camera not used", intake.unused_camera);
  count("absurd stamps", intake.absurd_stamps);
  count("stamps far ahead", intake.far_ahead);
  count("clocks set back", intake.clocks_set_back);
  count("events outside the image", intake.events_outside);
  count("frames unfit", intake.frames_unfit);
  count("no room", intake.no_room);
  count("packets", packets.packets);
  count("packets before the IMU", packets.packets_before_imu);
  count("packets after the IMU", packets.packets_after_imu);
  count("packets dropped, IMU away too long", packets.packets_overflow);
  count("events late", packets.events_late);
  count("events of flickering lamps", packets.events_flicker);
  count("events of dropped packets", packets.events_lost);
  count("frames late", packets.frames_late);
  count("IMU samples not finite", packets.imu_not_finite);
  count("IMU samples late", packets.imu_late);
  for (std::size_t i = 0; i < external_sensors().size(); ++i) {
    if (packets.external[i] == 0) continue;
    const std::string name(external_sensors()[i].name);
    count(name + " samples used", use.used[i]);
    count(name + " samples rejected", use.rejected[i]);
    count(name + " samples late", packets.external_late[i]);
  }
  return diagnosis;
}

}  // namespace edged::node
