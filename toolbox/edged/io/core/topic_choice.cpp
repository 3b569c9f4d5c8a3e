// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Assigns roles by types, and reports ambiguous topics.
#include "edged/io/core/topic_choice.hpp"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <tuple>

#include "edged/core/check.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/parse/text_parsing.hpp"

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

std::vector<std::size_t> topics_with(const std::vector<Topic>& topics, Role role) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < topics.size(); ++i)
    if (topics[i].count > 0 && role_of(topics[i].type) == role) found.push_back(i);
  return found;
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
  std::vector<std::size_t> found = topics_with(topics, role);
  // Ignores compressed copies of the same images.
  std::erase_if(found, [&](std::size_t i) {
    return std::ranges::any_of(found, [&](std::size_t j) { return topics[i].name == topics[j].name + "/compressed"; });
  });
  return found;
}

std::string listed(const std::vector<Topic>& topics, const std::vector<std::size_t>& which) {
  const auto name = [&topics](std::size_t i) { return topics[i].name; };
  return which.empty() ? "none" : fmt::format("{}", fmt::join(texts_of(which, name), ", "));
}

std::size_t wanted_topic(const std::vector<Topic>& topics, Role role, const std::string& name,
                         const std::string& file) {
  for (std::size_t i = 0; i < topics.size(); ++i)
    if (topics[i].name == name && can_take(topics[i].type, role)) return i;
  throw InputError::format("{}: no topic {} that could be {}; there are: {}", file, name,
                           kRoleNames[static_cast<std::size_t>(role)], listed(topics, candidates(topics, role)));
}

/// "events2", "frames3": the usual names of further cameras.
bool is_further_camera(const std::string& name, Modality modality) {
  constexpr std::size_t kMost = 9;
  for (std::size_t i = 1; i < kMost; ++i)
    if (name == usual_camera_name(modality, i)) return true;
  return false;
}

bool is_camera(const std::string& name, Modality modality, const Rig* rig) {
  if (is_further_camera(name, modality)) return true;
  return rig && std::ranges::any_of(rig->cameras, [&](const RigCamera& camera) {
           return camera.name == name && camera.modality == modality;
         });
}

void check_names(const TopicWishes& wishes) {
  for (const auto& [name, topic] : wishes.wanted) {
    const bool camera = is_camera(name, Modality::Events, wishes.rig) || is_camera(name, Modality::Frames, wishes.rig);
    if (camera || std::ranges::find(kRoleNames, name) != kRoleNames.end()) continue;
    std::vector<std::string> cameras = {"events2", "frames2"};
    if (wishes.rig && !wishes.rig->cameras.empty()) cameras = texts_of(wishes.rig->cameras, &RigCamera::name);
    throw InputError::format("--topic {}={}: the role must be one of {}, or the name of a camera: {}", name, topic,
                             fmt::join(kRoleNames, ", "), fmt::join(cameras, ", "));
  }
  for (auto one = wishes.wanted.begin(); one != wishes.wanted.end(); ++one)
    for (auto other = std::next(one); other != wishes.wanted.end(); ++other)
      if (one->second == other->second && one->second != "none" && !find_external_sensor(one->first) &&
          !find_external_sensor(other->first))
        throw InputError::format("--topic {}={}: the topic is that of {} already; give each its own", other->first,
                                 other->second, one->first);
}

[[noreturn]] void refuse_without_sensor(const std::vector<Topic>& topics, const std::string& file) {
  const auto described = [](const Topic& topic) { return fmt::format("{} ({})", topic.name, topic.type); };
  throw InputError::format("{}: no events, images or IMU among its topics: {}", file,
                           fmt::join(texts_of(topics, described), ", "));
}

/// dvs_msgs of 2015 has other fields under the same type name.
void refuse_old_events(const Topic& topic, const std::string& file) {
  if (topic.type == "dvs_msgs/EventArray" && topic.definition.find("uint64 time") != std::string::npos)
    throw InputError::format(
        "{}: {} holds dvs_msgs/EventArray of 2015, which lacks the size of the sensor and ROS stamps: take the text "
        "version of the data set, or give --topic events=none",
        file, topic.name);
}

std::string name_space(const std::string& topic) { return topic.substr(0, topic.rfind('/') + 1); }

/// Assigns the topics of one kind to cameras.
class CameraChooser {
 public:
  CameraChooser(const std::vector<Topic>& topics, const TopicWishes& wishes, const std::string& file, Modality modality)
      : topics_(topics), wishes_(wishes), file_(file), modality_(modality) {
    if (wishes.rig)
      for (const RigCamera& camera : wishes.rig->cameras)
        if (camera.modality == modality) rig_.push_back(camera.name);
  }

  /// ties: is extended by the topics that fit one camera.
  std::vector<CameraTopic> choose(std::string& ties) {
    free_ = candidates(topics_, role());
    take_wanted();
    if (!wishes_.wanted.contains(kind_name(modality_))) {
      const std::size_t by_user = chosen_.size();
      take_calibrated();
      if (chosen_.size() == by_user) take_by_names(ties);
    }
    std::ranges::stable_sort(chosen_, {}, [this](const CameraTopic& camera) { return rank(camera.name); });
    return chosen_;
  }

  /// The chosen cameras that are read.
  std::vector<CameraTopic> to_read() const {
    std::vector<CameraTopic> read;
    for (const std::size_t i :
         cameras_to_read(texts_of(chosen_, &CameraTopic::name), wishes_.cameras, wishes_.all_cameras))
      read.push_back(chosen_[i]);
    return read;
  }

 private:
  Role role() const { return modality_ == Modality::Events ? Role::Events : Role::Frames; }

  /// In the order of the rig, other names after them in their own order.
  std::tuple<std::size_t, std::size_t, std::string> rank(const std::string& name) const {
    const auto place = std::ranges::find(rig_, name);
    return {static_cast<std::size_t>(place - rig_.begin()), name.size(), name};
  }

  void take(const std::string& name, std::size_t topic) {
    chosen_.push_back({name, modality_, topic});
    std::erase(free_, topic);
  }

  bool has_topic(const std::string& name) const {
    return std::ranges::find(chosen_, name, &CameraTopic::name) != chosen_.end();
  }

  void take_wanted() {
    for (const auto& [name, topic] : wishes_.wanted) {
      const bool whole_kind = name == kind_name(modality_);
      if (!whole_kind) std::erase_if(free_, [this, &topic = topic](std::size_t i) { return topics_[i].name == topic; });
      if (topic == "none" || (!whole_kind && !is_camera(name, modality_, wishes_.rig))) continue;
      const std::string camera = whole_kind ? name_by_calibration(topic).value_or(name) : name;
      if (has_topic(camera))
        throw InputError::format("--topic {}={}: camera {} has a topic already; give each camera once", name, topic,
                                 camera);
      take(camera, wanted_topic(topics_, role(), topic, file_));
    }
  }

  std::optional<std::string> name_by_calibration(const std::string& topic) const {
    if (rig_.size() < 2) return std::nullopt;
    for (const auto& [camera, its_topic] : wishes_.calibrated)
      if (its_topic == topic && std::ranges::find(rig_, camera) != rig_.end()) return camera;
    return std::nullopt;
  }

  /// The topics that the calibration names, then those of the right type in the same name space: Kalibr calibrates an
  /// event camera with images.
  void take_calibrated() {
    const auto named = [&](const std::string& topic) {
      return std::ranges::find_if(
          free_, [&](std::size_t i) { return topics_[i].name == topic || topics_[i].name == topic + "/compressed"; });
    };
    const auto in_name_space = [&](const std::string& topic) {
      const std::string space = name_space(topic);
      const auto fits = [&](std::size_t i) { return name_space(topics_[i].name) == space; };
      const auto shares = [&](const std::string& camera) {
        const auto other = wishes_.calibrated.find(camera);
        return other != wishes_.calibrated.end() && name_space(other->second) == space;
      };
      const bool unique =
          space.size() > 1 && std::ranges::count_if(free_, fits) == 1 && std::ranges::count_if(rig_, shares) == 1;
      return unique ? std::ranges::find_if(free_, fits) : free_.end();
    };
    check_calibrated();
    const auto take_all = [&](const auto& find_topic) {
      for (const std::string& camera : rig_) {
        const auto topic = wishes_.calibrated.find(camera);
        if (topic == wishes_.calibrated.end() || has_topic(camera) || wishes_.wanted.contains(camera)) continue;
        const auto found = find_topic(topic->second);
        if (found != free_.end()) take(name_of(camera), *found);
      }
    };
    take_all(named);
    take_all(in_name_space);
  }

  /// The only camera of its kind has the usual name, unless the user calls it by its own.
  std::string name_of(const std::string& camera) const {
    const bool own = rig_.size() > 1 || std::ranges::find(wishes_.cameras, camera) != wishes_.cameras.end();
    return own ? camera : kind_name(modality_);
  }

  void check_calibrated() const {
    for (auto one = rig_.begin(); one != rig_.end(); ++one)
      for (auto other = std::next(one); other != rig_.end(); ++other) {
        const auto a = wishes_.calibrated.find(*one), b = wishes_.calibrated.find(*other);
        if (a != wishes_.calibrated.end() && b != wishes_.calibrated.end() && a->second == b->second)
          throw InputError::format(
              "rig '{}': topic {} is that of two cameras, {} and {}: correct the topic (rostopic) of one of them",
              wishes_.rig->name, a->second, *one, *other);
      }
  }

  void take_by_names(std::string& ties) {
    Rig rest = wishes_.rig ? *wishes_.rig : Rig{};
    std::erase_if(rest.cameras, [&](const RigCamera& camera) { return has_topic(camera.name); });
    const auto left = std::ranges::count(rest.cameras, modality_, &RigCamera::modality);
    std::ranges::stable_sort(free_, {}, [this](std::size_t i) { return topics_[i].name; });
    if (free_.size() > 1 && !rig_.empty() && free_.size() > static_cast<std::size_t>(left)) {
      ties += fmt::format("; {}: {}", kind_name(modality_), listed(topics_, free_));
      return;
    }
    std::vector<std::string> streams;
    for (const std::size_t i : free_) streams.push_back(topics_[i].name);
    NamedStreams named = name_streams(&rest, modality_, streams, wishes_.cameras, file_);
    std::vector<std::string> used;
    for (std::string& name : named.names) {  // two cameras of one name are none
      const auto taken = [&] { return has_topic(name) || std::ranges::find(used, name) != used.end(); };
      for (std::size_t i = 0; taken(); ++i) name = usual_camera_name(modality_, i);
      used.push_back(name);
    }
    if (!named.said.empty()) spdlog::warn(fmt::format("{}; --topic CAMERA=NAME assigns others", named.said));
    if (named.said.empty() && streams.size() > 1)
      spdlog::warn(
          fmt::format("{}: topics of {} are the cameras {} in the order {}; --topic CAMERA=NAME assigns others", file_,
                      kind_name(modality_), fmt::join(named.names, ", "), fmt::join(streams, ", ")));
    const std::vector<std::size_t> all = free_;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (!wishes_.wanted.contains(named.names[i])) take(named.names[i], all[i]);  // else the user leaves it out
  }

  const std::vector<Topic>& topics_;
  const TopicWishes& wishes_;
  const std::string& file_;
  Modality modality_;
  std::vector<std::string> rig_;   ///< cameras of the kind
  std::vector<std::size_t> free_;  ///< fitting topics that are not assigned
  std::vector<CameraTopic> chosen_;
};

}  // namespace

TopicWishes wishes_of(const Rig* rig, const RecordingOptions& options) {
  return {options.topics, options.camera_topics, rig, options.cameras, options.all_cameras};
}

std::vector<StreamInfo> TopicChoice::streams(const std::vector<Topic>& of) const {
  std::vector<StreamInfo> streams;
  for (const Topic& topic : of) streams.push_back({topic.name, topic.type, topic.count, ""});
  for (std::size_t role = 0; role < kRoleNames.size(); ++role)
    if (topics[role]) streams[*topics[role]].role = kRoleNames[role];
  for (const CameraTopic& camera : cameras)
    if (std::ranges::count(cameras, camera.modality, &CameraTopic::modality) > 1)
      streams[camera.topic].role = camera.name;
  return streams;
}

std::vector<RecordedCamera> TopicChoice::recorded(const std::vector<Topic>& of) const {
  std::vector<RecordedCamera> out;
  for (const CameraTopic& camera : cameras) out.push_back({camera.name, camera.modality, of[camera.topic].name});
  return out;
}

std::optional<TopicChoice::Place> TopicChoice::camera_of(std::size_t topic) const {
  const auto found = std::ranges::find(cameras, topic, &CameraTopic::topic);
  if (found == cameras.end()) return std::nullopt;
  const auto before = std::ranges::count(cameras.begin(), found, found->modality, &CameraTopic::modality);
  return Place{found->modality, static_cast<std::size_t>(before)};
}

TopicChoice choose_topics(const std::vector<Topic>& topics, const TopicWishes& wishes, const std::string& file) {
  check_names(wishes);
  const WantedTopics& wanted = wishes.wanted;
  TopicChoice choice;
  std::string ties;
  for (std::size_t r = 0; r < kRoleNames.size(); ++r) {
    const auto role = static_cast<Role>(r);
    if (const auto modality = modality_of(role)) {
      CameraChooser chooser(topics, wishes, file, *modality);
      for (const CameraTopic& camera : chooser.choose(ties))
        choice.known.push_back({camera.name, camera.modality, topics[camera.topic].name});
      const std::vector<CameraTopic> cameras = chooser.to_read();
      if (!cameras.empty()) choice.topics[r] = cameras.front().topic;
      choice.cameras.insert(choice.cameras.end(), cameras.begin(), cameras.end());
      continue;
    }
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
    throw InputError::format(
        "{}: several topics for one role, choose with --topic ROLE=NAME (or ROLE=none, CAMERA=NAME){}", file, ties);
  for (const CameraTopic& camera : choice.cameras) refuse_old_events(topics[camera.topic], file);
  if (!choice.of(Role::Events) && !choice.of(Role::Frames) && !choice.of(Role::Imu))
    refuse_without_sensor(topics, file);
  return choice;
}

}  // namespace edged
