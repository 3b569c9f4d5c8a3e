// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which topic of a bag, or stream of another container, is which sensor: by type, or as the user says.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "edged/core/external_sensor.hpp"
#include "edged/measurement.hpp"

namespace edged {

struct Topic {
  std::string name;        ///< "/dvs/events"
  std::string type;        ///< "dvs_msgs/EventArray", in ROS 2 too
  std::string definition;  ///< of the type, as far as the container tells it
  std::size_t count = 0;   ///< of messages
};

enum class Role { Events, Frames, Imu, Truth, Height, Velocity };
inline constexpr std::array<const char*, 6> kRoleNames = {"events", "frames", "imu", "truth", "height", "velocity"};
static_assert(kRoleNames.size() == 4 + kExternalSensors, "a role for each");

/// The external sensor of a role; null for the other roles.
const ExternalSensor* external_sensor_of(Role role);

/// Of messages of that type ("dvs_msgs/EventArray"); nothing for what is of no use here.
std::optional<Role> role_of(const std::string& type);

/// Whether messages of that type can take the role: those whose role it is, and an Odometry for its twist.
bool can_take(const std::string& type, Role role);

/// Of the roles that are cameras.
constexpr std::optional<Modality> modality_of(Role role) {
  if (role == Role::Events) return Modality::Events;
  return role == Role::Frames ? std::optional(Modality::Frames) : std::nullopt;
}

/// Roles by name with the topic the user wants, or "none".
using WantedTopics = std::map<std::string, std::string>;

/// Index of the topic of each role.
struct TopicChoice {
  std::array<std::optional<std::size_t>, kRoleNames.size()> topics;
  std::optional<std::size_t> of(Role role) const { return topics[static_cast<std::size_t>(role)]; }
};

/// The only topic of a fitting type takes its role, but for velocity: a twist may be a command, and its axes are those
/// of whatever sensor it is, so that its topic has to be named (an Odometry, too). Throws InputError that lists them
/// where there are several, where the bag lacks a wanted one, where no sensor is left, and for the event messages of
/// 2015.
TopicChoice choose_topics(const std::vector<Topic>& topics, const WantedTopics& wanted, const std::string& file);

}  // namespace edged
