// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/ros/imu_topics.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "edged/io/ros/bag/open_messages.hpp"
#include "edged/io/ros/messages/messages.hpp"

namespace edged {
namespace {

constexpr int kLookedAt = 20;  // messages

struct Filled {
  bool gyro = false, accel = false;
};

Filled filled_in(const std::filesystem::path& bag, std::size_t topic) {
  const auto source = open_messages(bag, nullptr);
  Filled filled;
  for (int i = 0; i < kLookedAt; ++i) {
    const auto message = source->next_of(topic);
    if (!message) break;
    try {
      const ImuMessage imu = read_imu_message(WireReader(source->wire(), message->data));
      filled.gyro |= imu.has_gyro;
      filled.accel |= imu.has_accel;
    } catch (const Damage&) {
      // Skips a damaged message: the next one is as good.
    }
  }
  return filled;
}

}  // namespace

ImuTopics choose_imu_topics(const std::filesystem::path& bag, const std::vector<Topic>& topics,
                            const WantedTopics& wanted) {
  if (wanted.contains("imu")) return {};
  std::vector<std::size_t> all, both, gyro, accel;
  for (std::size_t i = 0; i < topics.size(); ++i)
    if (topics[i].count > 0 && role_of(topics[i].type) == Role::Imu) all.push_back(i);
  if (all.size() < 2) return {};
  for (const std::size_t i : all) {
    const Filled filled = filled_in(bag, i);
    if (filled.gyro && filled.accel) both.push_back(i);
    if (filled.gyro && !filled.accel) gyro.push_back(i);
    if (filled.accel && !filled.gyro) accel.push_back(i);
  }
  if (both.size() == 1) {
    spdlog::warn("{}: the IMU is that of {}, the only one of {} topics with gyro and accelerometer", bag.string(),
                 topics[both.front()].name, all.size());
    return {both.front(), std::nullopt};
  }
  if (!both.empty() || gyro.size() != 1 || accel.size() != 1) return {};
  spdlog::warn(
      "{}: the IMU is merged from the gyro of {} and the accelerometer of {}, interpolated to the gyro's stamps",
      bag.string(), topics[gyro.front()].name, topics[accel.front()].name);
  return {gyro.front(), accel.front()};
}

WantedTopics with_imu_topic(WantedTopics wanted, const std::vector<Topic>& topics, const ImuTopics& chosen) {
  if (chosen.imu) wanted["imu"] = topics[*chosen.imu].name;
  return wanted;
}

}  // namespace edged
