// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Assigns roles by types, and reports ambiguous topics.
#include "edged/io/topic_choice.hpp"

#include <algorithm>

#include "edged/core/check.hpp"

namespace edged {

std::optional<Role> role_of(const std::string& type) {
  static const std::map<std::string, Role> roles = {
      {"dvs_msgs/EventArray", Role::Events},
      {"prophesee_event_msgs/EventArray", Role::Events},
      {"dv_ros_msgs/EventArray", Role::Events},
      {"event_camera_msgs/EventPacket", Role::Events},
      {"event_array_msgs/EventArray", Role::Events},
      {"sensor_msgs/Image", Role::Frames},
      {"sensor_msgs/CompressedImage", Role::Frames},
      {"sensor_msgs/Imu", Role::Imu},
      {"geometry_msgs/PoseStamped", Role::Truth},
      {"geometry_msgs/TransformStamped", Role::Truth},
      {"nav_msgs/Odometry", Role::Truth},
      {"sensor_msgs/FluidPressure", Role::Height},
      {"sensor_msgs/Range", Role::Height},
      {"geometry_msgs/TwistStamped", Role::Velocity},
      {"geometry_msgs/TwistWithCovarianceStamped", Role::Velocity},
      // Streams of AEDAT4.
      {"EVTS", Role::Events},
      {"FRME", Role::Frames},
      {"IMUS", Role::Imu},
  };
  const auto found = roles.find(type);
  return found == roles.end() ? std::nullopt : std::optional(found->second);
}

const ExternalSensor* external_sensor_of(Role role) {
  return find_external_sensor(kRoleNames[static_cast<std::size_t>(role)]);
}

bool can_take(const std::string& type, Role role) {
  return role_of(type) == role || (role == Role::Velocity && type == "nav_msgs/Odometry");
}

namespace {

/// Roles that are assigned without --topic. A bag may hold several barometers, and twists that are commands.
bool is_chosen_by_itself(Role role, std::size_t fitting) { return fitting == 1 && role != Role::Velocity; }

std::vector<std::size_t> candidates(const std::vector<Topic>& topics, Role role) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < topics.size(); ++i)
    if (topics[i].count > 0 && role_of(topics[i].type) == role) found.push_back(i);
  // Ignores compressed copies of the same images.
  std::erase_if(found, [&](std::size_t i) {
    return std::ranges::any_of(found, [&](std::size_t j) { return topics[i].name == topics[j].name + "/compressed"; });
  });
  return found;
}

std::string listed(const std::vector<Topic>& topics, const std::vector<std::size_t>& which) {
  std::string list;
  for (const std::size_t i : which) list += (list.empty() ? "" : ", ") + topics[i].name;
  return list.empty() ? "none" : list;
}

std::size_t wanted_topic(const std::vector<Topic>& topics, Role role, const std::string& name,
                         const std::string& file) {
  for (std::size_t i = 0; i < topics.size(); ++i)
    if (topics[i].name == name && can_take(topics[i].type, role)) return i;
  throw InputError::format("{}: no topic {} that could be {}; there are: {}", file, name,
                           kRoleNames[static_cast<std::size_t>(role)], listed(topics, candidates(topics, role)));
}

void check_role_names(const WantedTopics& wanted) {
  for (const auto& [role, name] : wanted)
    if (std::ranges::find(kRoleNames, role) == kRoleNames.end())
      throw InputError::format("--topic {}={}: the role must be one of {}", role, name, fmt::join(kRoleNames, ", "));
}

[[noreturn]] void refuse_without_sensor(const std::vector<Topic>& topics, const std::string& file) {
  std::string types;
  for (const Topic& topic : topics)
    types += fmt::format("{}{} ({})", types.empty() ? "" : ", ", topic.name, topic.type);
  throw InputError::format("{}: no events, images or IMU among its topics: {}", file, types);
}

/// dvs_msgs of 2015 has other fields under the same type name.
void refuse_old_events(const Topic& topic, const std::string& file) {
  if (topic.type == "dvs_msgs/EventArray" && topic.definition.find("uint64 time") != std::string::npos)
    throw InputError::format(
        "{}: {} holds dvs_msgs/EventArray of 2015, which lacks the size of the sensor and ROS stamps: take the text "
        "version of the data set, or give --topic events=none",
        file, topic.name);
}

}  // namespace

TopicChoice choose_topics(const std::vector<Topic>& topics, const WantedTopics& wanted, const std::string& file) {
  check_role_names(wanted);
  TopicChoice choice;
  std::string ties;
  for (std::size_t r = 0; r < kRoleNames.size(); ++r) {
    const auto role = static_cast<Role>(r);
    if (const auto name = wanted.find(kRoleNames[r]); name != wanted.end()) {
      if (name->second != "none") choice.topics[r] = wanted_topic(topics, role, name->second, file);
      continue;
    }
    std::vector<std::size_t> fitting = candidates(topics, role);
    std::erase_if(fitting, [&](std::size_t i) {  // chosen for another role
      return std::ranges::any_of(wanted, [&](const auto& other) { return other.second == topics[i].name; });
    });
    if (is_chosen_by_itself(role, fitting.size())) choice.topics[r] = fitting.front();
    if (fitting.size() > 1 && !external_sensor_of(role))
      ties += fmt::format("; {}: {}", kRoleNames[r], listed(topics, fitting));
  }
  if (!ties.empty())
    throw InputError::format("{}: several topics for one role, choose with --topic ROLE=NAME (or ROLE=none){}", file,
                             ties);
  if (choice.of(Role::Events)) refuse_old_events(topics[*choice.of(Role::Events)], file);
  if (!choice.of(Role::Events) && !choice.of(Role::Frames) && !choice.of(Role::Imu))
    refuse_without_sensor(topics, file);
  return choice;
}

}  // namespace edged
