// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "diagnostics.hpp"

#include <fmt/format.h>

#include "edged/core/external_sensor.hpp"

namespace edged::ros1 {
namespace {

using diagnostic_msgs::DiagnosticStatus;

std::string summary(const NodeHealth& health) {
  std::string text = health.status ? to_string(*health.status) : "no packet yet";
  if (!health.reason.empty()) text += ": " + health.reason;
  for (const auto& [topic, input] : health.inputs) {
    if (input.messages == 0 && !input.optional) text += fmt::format("; nothing has come on {}", topic);
    if (input.unreadable > 0) text += fmt::format("; {}: {}", topic, input.trouble);
  }
  if (health.newly_lost > 0) text += fmt::format("; {} measurements lost since the last report", health.newly_lost);
  return text;
}

std::uint8_t level_of(const NodeHealth& health) {
  if (health.status == TrackingStatus::Lost) return DiagnosticStatus::ERROR;
  const bool fine = health.status == TrackingStatus::Good && health.newly_lost == 0;
  return fine ? DiagnosticStatus::OK : DiagnosticStatus::WARN;
}

}  // namespace

std::size_t lost_measurements(const NodeHealth& health) {
  const IntakeCounters& intake = health.odometry.intake;
  const PacketizerCounters& packets = health.odometry.packets;
  std::size_t lost = intake.unknown_camera + intake.absurd_stamps + intake.far_ahead + intake.clocks_set_back +
                     intake.events_outside + intake.frames_unfit + intake.no_room + packets.packets_overflow +
                     packets.events_late + packets.frames_late + packets.imu_not_finite + packets.imu_late +
                     health.left_out.events + health.left_out.frames;
  for (const auto& [topic, input] : health.inputs) lost += input.unreadable + input.missed;
  return lost;
}

DiagnosticStatus diagnostics_message(const NodeHealth& health, const std::string& hardware) {
  DiagnosticStatus message;
  message.level = level_of(health);
  message.name = "edged: odometry";
  message.hardware_id = hardware;
  message.message = summary(health);
  const auto add = [&](const std::string& key, std::string value) {
    diagnostic_msgs::KeyValue pair;
    pair.key = key, pair.value = std::move(value);
    message.values.push_back(std::move(pair));
  };
  const auto count = [&](const std::string& key, std::size_t n) { add(key, std::to_string(n)); };
  for (const auto& [topic, input] : health.inputs) {
    count(topic + " messages", input.messages);
    if (input.events > 0) count(topic + " events", input.events);
    count(topic + " messages unreadable", input.unreadable);
    count(topic + " messages missed", input.missed);
  }
  if (health.age) add("newest step behind newest measurement [s]", fmt::format("{:.3f}", to_seconds(*health.age)));
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
  return message;
}

}  // namespace edged::ros1
