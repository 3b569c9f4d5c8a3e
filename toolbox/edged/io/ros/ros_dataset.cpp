// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Converts messages to measurements.
#include "edged/io/ros/ros_dataset.hpp"

#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/core/geometry.hpp"
#include "edged/io/ros/bag/open_messages.hpp"
#include "edged/io/ros/bag_intrinsics.hpp"

namespace edged {
namespace {

constexpr std::string_view kPlainPoses = "geometry_msgs/PoseStamped";  // which does not name the frame whose pose it is

}  // namespace

RosDataset::RosDataset(const std::filesystem::path& path, TopicWishes wishes, std::optional<cv::Size> geometry)
    : StreamedDataset(path, "ros"), source_(open_messages(path, &repairs_)), geometry_(geometry) {
  const std::vector<Topic>& topics = source_->topics();
  imu_topics_ = choose_imu_topics(path, topics, wishes.wanted);
  wishes.wanted = with_imu_topic(wishes.wanted, topics, imu_topics_);
  choice_ = choose_topics(topics, wishes, name_);
  if (wishes.rig) rig_ = *wishes.rig;
  info_.format = source_->wire() == Wire::Ros1 ? "ros1" : "ros2";
  name_roles();
  good_.resize(topics.size());
  bad_.resize(topics.size());
  const std::vector<RecordedCamera> cameras = choice_.recorded(topics);
  events_.resize(static_cast<std::size_t>(std::ranges::count(cameras, Modality::Events, &RecordedCamera::modality)));
  begin(cameras, choice_.of(Role::Imu).has_value());
  info_.end = *info_.begin + source_->length();
  for (std::size_t role = 0; role < kRoleNames.size(); ++role)
    if (choice_.topics[role] && external_sensor_of(static_cast<Role>(role)))
      info_.external.emplace_back(kRoleNames[role]);
  info_.pose_frame = truth_frame();
}

void RosDataset::name_roles() {
  for (const Topic& topic : source_->topics()) info_.streams.push_back({topic.name, topic.type, topic.count, ""});
  for (std::size_t role = 0; role < kRoleNames.size(); ++role)
    if (const auto topic = choice_.topics[role]) info_.streams[*topic].role = kRoleNames[role];
  for (const CameraTopic& camera : choice_.cameras)
    if (std::ranges::count(choice_.cameras, camera.modality, &CameraTopic::modality) > 1)
      info_.streams[camera.topic].role = camera.name;
  if (imu_topics_.accel) info_.streams[*imu_topics_.accel].role = "imu";
}

/// The frame of the poses in the first message.
std::string RosDataset::truth_frame() const {
  const auto topic = choice_.of(Role::Truth);
  if (!topic || source_->topics()[*topic].type == kPlainPoses) return "body";
  const auto source = open_messages(name_, nullptr);
  while (const auto message = source->next_of(*topic)) {
    try {
      const NamedPose named = read_named_pose(WireReader(source->wire(), message->data));
      if (const auto camera = camera_by_usual_name(choice_.known, named.frame)) return *camera;
      const bool of_camera = named.frame.starts_with("events") || named.frame.starts_with("frames");
      return of_camera ? std::string(named.frame) : "body";
    } catch (const Damage&) {
      // Skips a damaged message: the next one is as good.
    }
  }
  return "body";
}

bool RosDataset::read_on() {
  const auto message = source_->next();
  if (message) feed(*message);
  return message.has_value();
}

void RosDataset::feed(const Message& message) {
  const bool accel = message.topic == imu_topics_.accel;
  const std::size_t topic = accel ? *choice_.of(Role::Imu) : message.topic;
  const auto camera = choice_.camera_of(topic);
  auto role = static_cast<Role>(std::ranges::find(choice_.topics, std::optional(topic)) - choice_.topics.begin());
  if (camera) role = camera->modality == Modality::Events ? Role::Events : Role::Frames;
  if (static_cast<std::size_t>(role) == choice_.topics.size() || !wants(modality_of(role))) return;
  const std::string& type = source_->topics()[message.topic].type;
  try {
    const WireReader reader(source_->wire(), message.data);
    switch (role) {
      case Role::Events:
        feed_events(camera->camera, type, reader);
        break;
      case Role::Frames:
        feed_frame(camera->camera, type, reader);
        break;
      case Role::Imu:
        feed_imu(message.topic, reader);
        break;
      case Role::Truth:
        break;  // read in a separate pass
      case Role::Height:
      case Role::Velocity:
        push_external(read_external(type, reader));
        break;
    }
    ++good_[topic];
  } catch (const Damage& damage) {
    judge(topic, role, damage.what());
  }
}

/// Counts a damaged message as a repair. Throws InputError if all messages of a topic so far are damaged, except for
/// external sensors.
void RosDataset::judge(std::size_t index, Role role, const std::string& reason) {
  constexpr std::size_t kTries = 10;
  const Topic& topic = source_->topics()[index];
  const std::string& name = info_.streams[index].role;
  const std::string detail = fmt::format("{}: {} ({}): {}", name_, topic.name, topic.type, reason);
  repairs_.add(fmt::format("{}: message unreadable", kRoleNames[static_cast<std::size_t>(role)]), detail);
  ++bad_[index];
  if (external_sensor_of(role)) return;  // the topic may have another meaning: a pressure in water is no air pressure
  if (good_[index] == 0 && bad_[index] >= std::min(kTries, std::max<std::size_t>(topic.count, 1)))
    throw InputError::format("{}; none of its first {} messages can be read: give --topic {}=NAME or none", detail,
                             bad_[index], name);
}

void RosDataset::feed_events(std::size_t camera, const std::string& type, WireReader message) {
  EventArray array = events_[camera].decode(type, message);
  const cv::Size size(static_cast<int>(array.width), static_cast<int>(array.height));
  if (sensor(camera).empty()) {
    const std::optional<cv::Size> said = size.empty() ? std::nullopt : std::optional(size);
    set_sensor(
        event_sensor_size(name_, geometry_ ? geometry_ : said, rig_ ? &*rig_ : nullptr, choice_.cameras[camera].name),
        camera);
  }
  push_events(array.events, camera);
}

void RosDataset::feed_imu(std::size_t topic, WireReader message) {
  if (!imu_topics_.accel) return push_imu(read_imu(message));
  const ImuMessage imu = read_imu_message(message);
  const bool accel = topic == *imu_topics_.accel;
  if (!(accel ? imu.accel : imu.gyro).allFinite()) throw Damage("not finite");
  const auto samples = accel ? imu_join_.add_accel(imu.t, imu.accel) : imu_join_.add_gyro(imu.t, imu.gyro);
  for (const ImuSample& sample : samples) push_imu(sample);
}

void RosDataset::feed_frame(std::size_t camera, const std::string& type, WireReader message) {
  GrayImage gray = read_frame(type, message);
  push_frame(gray.t, std::move(gray.image), camera);
}

std::optional<Calibration> RosDataset::intrinsics() const {
  const auto is_info = [](const Topic& topic) { return topic.type == "sensor_msgs/CameraInfo"; };
  if (std::ranges::none_of(source_->topics(), is_info)) return std::nullopt;
  auto calibration = read_bag_intrinsics(*open_messages(name_, nullptr), choice_);
  if (calibration) calibration->rig.name = info_.name;
  return calibration;
}

std::optional<GroundTruth> RosDataset::ground_truth() const {
  const auto topic = choice_.of(Role::Truth);
  if (!topic) return std::nullopt;
  const auto source = open_messages(name_, nullptr);
  const bool plain = source_->topics()[*topic].type == kPlainPoses;
  GroundTruth truth{{}, info_.pose_frame};
  Trajectory& poses = truth.trajectory;
  while (const auto message = source->next_of(*topic)) {
    try {
      const WireReader reader(source->wire(), message->data);
      if (plain) {
        poses.push_back(read_pose_stamped(reader));
        continue;
      }
      poses.push_back(read_named_pose(reader).pose);
    } catch (const Damage&) {
      // A missing pose does not matter: there are hundreds per second.
    }
  }
  std::ranges::stable_sort(poses, {}, &StampedPose::t);
  const auto same_stamp = [](const StampedPose& a, const StampedPose& b) { return a.t == b.t; };
  poses.erase(std::unique(poses.begin(), poses.end(), same_stamp), poses.end());
  return poses.empty() ? std::nullopt : std::optional(std::move(truth));
}

Recording open_bag(const std::filesystem::path& path, const Rig* rig, const RecordingOptions& options) {
  auto dataset = std::make_unique<RosDataset>(path, wishes_of(rig, options), options.geometry);
  std::optional<Calibration> calibration = dataset->intrinsics();
  if (calibration && rig)
    for (const RigCamera& camera : calibration->rig.cameras)
      warn_of_other_lens(path.string(), camera.model.mean_focal(), *rig, camera.modality, camera.name);
  return {std::move(dataset), std::move(calibration)};
}

}  // namespace edged
