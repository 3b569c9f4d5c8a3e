// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// From messages to measurements.
#include "edged/io/ros/ros_dataset.hpp"

#include <algorithm>

#include "edged/core/check.hpp"

namespace edged {
namespace {

Timestamp first_stamp(const Measurement& m) {
  if (const auto* batch = std::get_if<EventBatch>(&m)) return batch->events.front().t;
  if (const auto* frame = std::get_if<Frame>(&m)) return frame->t;
  return std::get<ImuSample>(m).t;
}

Merger::Streams streams_of(const TopicChoice& choice) {
  return {choice.of(Role::Events).has_value(), choice.of(Role::Frames).has_value(), choice.of(Role::Imu).has_value(),
          "events"};
}

}  // namespace

RosDataset::RosDataset(std::filesystem::path path, const WantedTopics& wanted, std::optional<cv::Size> sensor)
    : path_(std::move(path)),
      sensor_(sensor),
      source_(open_messages(path_, &repairs_)),
      choice_(choose_topics(source_->topics(), wanted, path_.string())),
      merger_(streams_of(choice_), repairs_) {
  info_.name = std::filesystem::absolute(path_ / ".").parent_path().stem().string();
  info_.format = source_->wire() == Wire::Ros1 ? "ros1" : "ros2";
  info_.has_events = choice_.of(Role::Events).has_value();
  info_.has_frames = choice_.of(Role::Frames).has_value();
  info_.has_imu = choice_.of(Role::Imu).has_value();
  first_ = merged();
  if (!first_)
    throw InputError::format("{}: nothing to read: none of its messages holds a measurement", path_.string());
  info_.begin = first_stamp(*first_);
  info_.end = *info_.begin + source_->length();
}

std::optional<Measurement> RosDataset::next() { return first_ ? std::exchange(first_, std::nullopt) : merged(); }

std::optional<Measurement> RosDataset::merged() {
  while (true) {
    if (auto measurement = merger_.pop()) return measurement;
    if (finished_) return std::nullopt;
    if (const auto message = source_->next()) {
      feed(*message);
    } else {
      finished_ = true;
      merger_.finish();
    }
  }
}

void RosDataset::feed(const Message& message) {
  const auto role = std::ranges::find(choice_.topics, std::optional(message.topic));
  if (role == choice_.topics.end()) return;
  const auto index = static_cast<std::size_t>(role - choice_.topics.begin());
  const std::string& type = source_->topics()[message.topic].type;
  try {
    const WireReader reader(source_->wire(), message.data);
    switch (static_cast<Role>(index)) {
      case Role::Events:
        feed_events(type, reader);
        break;
      case Role::Frames:
        feed_frame(type, reader);
        break;
      case Role::Imu:
        merger_.push(read_imu(reader));
        break;
      case Role::Truth:
        break;  // in a pass of its own
    }
    ++good_[index];
  } catch (const Damage& damage) {
    judge(index, damage.what());
  }
}

/// Some damaged messages are repairs; a topic that holds nothing else is no recording of that kind.
void RosDataset::judge(std::size_t role, const std::string& reason) {
  constexpr std::size_t kTries = 10;
  const Topic& topic = source_->topics()[*choice_.topics[role]];
  const std::string detail = fmt::format("{}: {} ({}): {}", path_.string(), topic.name, topic.type, reason);
  repairs_.add(fmt::format("{}: message unreadable", kRoleNames[role]), detail);
  ++bad_[role];
  if (good_[role] == 0 && bad_[role] >= std::min(kTries, std::max<std::size_t>(topic.count, 1)))
    throw InputError::format("{}; none of its first {} messages can be read: give --topic {}=NAME or none", detail,
                             bad_[role], kRoleNames[role]);
}

void RosDataset::feed_events(const std::string& type, WireReader message) {
  cv::Size size;
  std::vector<Event> events;
  if (type == "event_camera_msgs/EventPacket" || type == "event_array_msgs/EventArray") {
    const EventPacket packet = read_event_packet(message);
    size = cv::Size(static_cast<int>(packet.width), static_cast<int>(packet.height));
    events = packets_.decode(packet);
  } else {
    EventArray array = read_event_array(message);
    size = cv::Size(static_cast<int>(array.width), static_cast<int>(array.height));
    events = std::move(array.events);
  }
  if (!sensor_ && size.width > 0 && size.height > 0) sensor_ = size;
  if (sensor_) {
    const auto outside = [&](const Event& e) { return e.x >= sensor_->width || e.y >= sensor_->height; };
    for (std::size_t left = std::erase_if(events, outside); left > 0; --left)
      repairs_.add("events: pixel outside the sensor",
                   fmt::format("{}: events outside the {} x {} sensor: is this its calibration?", path_.string(),
                               sensor_->width, sensor_->height));
  }
  merger_.push(events);
}

void RosDataset::feed_frame(const std::string& type, WireReader message) {
  GrayImage gray = type == "sensor_msgs/Image" ? read_image(message) : read_compressed_image(message);
  if (image_size_.empty()) image_size_ = gray.image.size();
  if (gray.image.size() != image_size_) throw Damage("image of another size");
  merger_.push(Frame{gray.t, "frames", gray.image});
}

std::optional<GroundTruth> RosDataset::ground_truth() const {
  const auto topic = choice_.of(Role::Truth);
  if (!topic) return std::nullopt;
  const auto source = open_messages(path_, nullptr);
  const bool plain = source_->topics()[*topic].type == "geometry_msgs/PoseStamped";
  GroundTruth truth;
  Trajectory& poses = truth.trajectory;
  while (const auto message = source->next()) {
    if (message->topic != *topic) continue;
    try {
      const WireReader reader(source->wire(), message->data);
      poses.push_back(plain ? read_pose_stamped(reader) : read_child_pose(reader));
    } catch (const Damage&) {
      // A pose that is missing is no loss: there are hundreds a second.
    }
  }
  std::ranges::stable_sort(poses, {}, &StampedPose::t);
  const auto repeated = std::ranges::unique(poses, {}, &StampedPose::t);
  poses.erase(repeated.begin(), repeated.end());
  return poses.empty() ? std::nullopt : std::optional(std::move(truth));
}

}  // namespace edged
