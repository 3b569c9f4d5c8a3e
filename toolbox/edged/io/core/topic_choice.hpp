// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Assigns the topics of a bag, or the streams of another container, to sensors: by type, or by the choice of the user.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "edged/core/measurements/external_sensor.hpp"
#include "edged/dataset.hpp"
#include "edged/io/recording.hpp"
#include "edged/measurement.hpp"

namespace edged {

struct Topic {
  std::string name;        ///< "/dvs/events"
  std::string type;        ///< "dvs_msgs/EventArray", also for ROS 2
  std::string definition;  ///< text of the type, if the container holds it
  std::size_t count = 0;   ///< number of messages
};

enum class Role { Events, Frames, Imu, Truth, Height, Velocity };
inline constexpr std::array<const char*, 6> kRoleNames = {"events", "frames", "imu", "truth", "height", "velocity"};
static_assert(kRoleNames.size() == 4 + kExternalSensors, "a role for each");

/// The role of a sensor of external_sensors() by its place there.
constexpr Role external_role(std::size_t place) {
  return static_cast<Role>(static_cast<std::size_t>(Role::Height) + place);
}

/// The external sensor of a role; null for the other roles.
const ExternalSensor* external_sensor_of(Role role);

/// The role of messages of that type ("dvs_msgs/EventArray"). Nothing for types that are not read.
std::optional<Role> role_of(const std::string& type);

/// The topics with messages whose type has the role.
std::vector<std::size_t> topics_with(const std::vector<Topic>& topics, Role role);

/// True if a topic of that type can have the role: by role_of(), or an Odometry for its twist.
bool can_take(const std::string& type, Role role);

/// The modality of a role that is a camera.
constexpr std::optional<Modality> modality_of(Role role) {
  if (role == Role::Events) return Modality::Events;
  return role == Role::Frames ? std::optional(Modality::Frames) : std::nullopt;
}

/// Names of roles or cameras, each with the topic that the user wants, or "none".
using WantedTopics = std::map<std::string, std::string>;

/// What is known of the topics beside their types.
struct TopicWishes {
  WantedTopics wanted = {};
  std::map<std::string, std::string> calibrated = {};  ///< names of cameras, each with its topic by the calibration
  const Rig* rig = nullptr;                            ///< that the user chose, if any
  std::vector<std::string> cameras = {};               ///< names of the cameras to read; empty: the first of each kind
  bool all_cameras = false;                            ///< reads all instead
};
TopicWishes wishes_of(const Rig* rig, const RecordingOptions& options);

/// The topic of a camera.
struct CameraTopic {
  std::string name;
  Modality modality = Modality::Frames;
  std::size_t topic = 0;
};

/// The index of the topic of each role.
struct TopicChoice {
  std::array<std::optional<std::size_t>, kRoleNames.size()> topics;  ///< for events and frames that of the first camera
  std::vector<CameraTopic> cameras;  ///< that are read: event cameras, then frame cameras, of each kind the first first
  std::vector<RecordedCamera> known;  ///< all cameras, also those that are not read
  std::optional<std::size_t> of(Role role) const { return topics[static_cast<std::size_t>(role)]; }
  /// The topics with their roles, as DatasetInfo lists them.
  std::vector<StreamInfo> streams(const std::vector<Topic>& of) const;
  /// As StreamedDataset needs them.
  std::vector<RecordedCamera> recorded(const std::vector<Topic>& of) const;
  /// The camera of that topic, and its place among those of its kind.
  struct Place {
    Modality modality = Modality::Frames;
    std::size_t camera = 0;
  };
  std::optional<Place> camera_of(std::size_t topic) const;
};

/// The only topic of a fitting type gets the role. The topic of the velocity must be named, because a twist may be a
/// command, and its axes are those of an unknown sensor (an Odometry, too). Several topics of events or images are
/// those of several cameras: by the user, else by the topics that the calibration names, else as name_streams() names
/// them in the order of their names. Throws InputError, with the topics, if several fit a role that is no camera, or
/// more than the cameras of the rig, if a topic is wanted twice, if the bag lacks a wanted one, if no sensor is left,
/// and for the event messages of 2015.
TopicChoice choose_topics(const std::vector<Topic>& topics, const TopicWishes& wishes, const std::string& file);

}  // namespace edged
