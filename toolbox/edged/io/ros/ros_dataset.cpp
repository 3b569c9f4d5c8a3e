// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/spdlog.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "edged/core/check.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/core/imu_interpolator.hpp"
#include "edged/io/core/streamed_dataset.hpp"
#include "edged/io/ros/bag/open_messages.hpp"
#include "edged/io/ros/messages/event_packets.hpp"
#include "edged/io/ros/ros.hpp"

namespace edged {
namespace {

/// The topics of sensor_msgs/Imu. Some drivers send gyro and accelerometer in separate topics, each with the other
/// sensor left empty.
struct ImuTopics {
  std::optional<std::size_t> imu;    ///< nothing: choose_topics decides
  std::optional<std::size_t> accel;  ///< the topic of the accelerometer, if `imu` has the gyro only
};

struct Filled {
  bool gyro = false, accel = false;
};

Filled filled_in(const std::filesystem::path& bag, std::size_t topic) {
  constexpr int kFirstMessages = 20;
  const auto source = open_messages(bag, nullptr);
  Filled filled;
  for (int i = 0; i < kFirstMessages; ++i) {
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

/// Chooses by the content of the first messages of each topic: the only topic with both sensors, else the only one with
/// a gyro and the only one with an accelerometer. Nothing if the user has chosen, or if the choice is not unique.
ImuTopics choose_imu_topics(const std::filesystem::path& bag, const std::vector<Topic>& topics,
                            const WantedTopics& wanted) {
  if (wanted.contains("imu")) return {};
  const std::vector<std::size_t> all = topics_with(topics, Role::Imu);
  if (all.size() < 2) return {};
  std::vector<std::size_t> both, gyro, accel;
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

/// "/dvs/camera_info" for "/dvs/image_raw" and for "/dvs/image_raw/compressed".
std::string info_topic_of(std::string name) {
  if (name.ends_with("/compressed")) name.erase(name.rfind('/'));
  return name.substr(0, name.rfind('/') + 1) + "camera_info";
}

/// The first CameraInfo of each of these topics; nothing of one whose intrinsics cannot be used. Reads up to the last
/// of them, so source must be at its beginning.
std::map<std::size_t, CameraModel> read_camera_infos(MessageSource& source, std::set<std::size_t> missing) {
  std::map<std::size_t, CameraModel> models;
  while (!missing.empty()) {
    const auto message = source.next();
    if (!message) break;
    if (missing.erase(message->topic) == 0) continue;
    try {
      models.emplace(message->topic, read_camera_info(WireReader(source.wire(), message->data)));
    } catch (const Damage& damage) {
      spdlog::warn(fmt::format("{}: intrinsics not used: {}", source.topics()[message->topic].name, damage.what()));
    }
  }
  return models;
}

/// The intrinsics of the cameras of a bag, from the CameraInfo in the namespace of their topics (/dvs/camera_info of
/// /dvs/events). Nothing without usable ones. source: at its beginning.
std::optional<Calibration> read_bag_intrinsics(MessageSource& source, const TopicChoice& choice) {
  std::set<std::size_t> infos;
  std::vector<std::optional<std::size_t>> topic_of_camera(choice.cameras.size());
  const std::vector<Topic>& topics = source.topics();
  for (std::size_t c = 0; c < choice.cameras.size(); ++c) {
    const std::string wanted = info_topic_of(topics[choice.cameras[c].topic].name);
    for (std::size_t i = 0; i < topics.size(); ++i)
      if (topics[i].name == wanted && topics[i].type == "sensor_msgs/CameraInfo" && topics[i].count > 0)
        infos.insert(i), topic_of_camera[c] = i;
  }
  const std::map<std::size_t, CameraModel> models = read_camera_infos(source, infos);
  Calibration calibration;
  calibration.has_extrinsics = calibration.has_imu_noise = false;
  for (std::size_t c = 0; c < choice.cameras.size(); ++c) {
    const auto model = topic_of_camera[c] ? models.find(*topic_of_camera[c]) : models.end();
    if (model != models.end())
      calibration.rig.cameras.push_back(
          {choice.cameras[c].name, choice.cameras[c].modality, model->second, SE3(), Duration(0)});
  }
  return calibration.rig.cameras.empty() ? std::nullopt : std::optional(std::move(calibration));
}

class RosDataset final : public StreamedDataset {
 public:
  RosDataset(const std::filesystem::path& path, TopicWishes wishes, std::optional<cv::Size> geometry)
      : StreamedDataset(path, "ros"), source_(open_messages(path, &repairs_)), geometry_(geometry) {
    const std::vector<Topic>& topics = source_->topics();
    imu_topics_ = choose_imu_topics(path, topics, wishes.wanted);
    if (imu_topics_.imu) wishes.wanted["imu"] = topics[*imu_topics_.imu].name;
    choice_ = choose_topics(topics, wishes, name_);
    if (wishes.rig) rig_ = *wishes.rig;
    info_.format = source_->wire() == Wire::Ros1 ? "ros1" : "ros2";
    info_.streams = choice_.streams(topics);
    if (imu_topics_.accel) info_.streams[*imu_topics_.accel].role = "imu";
    readable_.resize(topics.size());
    unreadable_.resize(topics.size());
    const std::vector<RecordedCamera> cameras = choice_.recorded(topics);
    events_.resize(static_cast<std::size_t>(std::ranges::count(cameras, Modality::Events, &RecordedCamera::modality)));
    begin(cameras, choice_.of(Role::Imu).has_value());
    info_.end = *info_.begin + source_->length();
    for (std::size_t role = 0; role < kRoleNames.size(); ++role)
      if (choice_.topics[role] && external_sensor_of(static_cast<Role>(role)))
        info_.external.emplace_back(kRoleNames[role]);
    info_.pose_frame = truth_frame();
  }

  std::optional<GroundTruth> ground_truth() const override {
    GroundTruth truth{{}, info_.pose_frame};
    Trajectory& poses = truth.trajectory;
    read_poses([&](const NamedPose& named) {
      poses.push_back(named.pose);
      return true;
    });
    std::ranges::stable_sort(poses, {}, &StampedPose::t);
    const auto same_stamp = [](const StampedPose& a, const StampedPose& b) { return a.t == b.t; };
    poses.erase(std::unique(poses.begin(), poses.end(), same_stamp), poses.end());
    return poses.empty() ? std::nullopt : std::optional(std::move(truth));
  }

  /// Intrinsics of its cameras, if the bag holds them.
  std::optional<Calibration> intrinsics() const {
    const auto is_info = [](const Topic& topic) { return topic.type == "sensor_msgs/CameraInfo"; };
    if (std::ranges::none_of(source_->topics(), is_info)) return std::nullopt;
    auto calibration = read_bag_intrinsics(*open_messages(name_, nullptr), choice_);
    if (calibration) calibration->rig.name = info_.name;
    return calibration;
  }

 private:
  /// Calls `take` for each readable pose of the ground truth until it returns false.
  void read_poses(const std::function<bool(const NamedPose&)>& take) const {
    const auto topic = choice_.of(Role::Truth);
    if (!topic) return;
    const auto source = open_messages(name_, nullptr);
    while (const auto message = source->next_of(*topic)) {
      try {
        const std::string& type = source_->topics()[*topic].type;
        if (!take(read_pose(type, WireReader(source->wire(), message->data)))) return;
      } catch (const Damage&) {
        // A missing pose does not matter: there are hundreds per second.
      }
    }
  }

  /// The frame of the poses, by the first one.
  std::string truth_frame() const {
    std::string frame = "body";
    read_poses([&](const NamedPose& named) {
      const bool of_camera = named.frame.starts_with("events") || named.frame.starts_with("frames");
      frame = camera_by_usual_name(choice_.known, named.frame).value_or(of_camera ? std::string(named.frame) : "body");
      return false;
    });
    return frame;
  }

  bool read_on() override {
    const auto message = source_->next();
    if (message) feed(*message);
    return message.has_value();
  }

  void feed(const Message& message) {
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
        default:  // an external sensor
          push_external(read_external(type, reader));
          break;
      }
      ++readable_[topic];
    } catch (const Damage& damage) {
      count_unreadable(topic, role, damage.what());
    }
  }

  /// Counts a damaged message as a repair. Throws InputError if all messages of a topic so far are damaged, except for
  /// external sensors.
  void count_unreadable(std::size_t index, Role role, const std::string& reason) {
    constexpr std::size_t kTries = 10;
    const Topic& topic = source_->topics()[index];
    const std::string& name = info_.streams[index].role;
    const std::string detail = fmt::format("{}: {} ({}): {}", name_, topic.name, topic.type, reason);
    repairs_.add(fmt::format("{}: message unreadable", kRoleNames[static_cast<std::size_t>(role)]), detail);
    ++unreadable_[index];
    if (external_sensor_of(role)) return;  // the topic may have another meaning: a pressure in water is no air pressure
    if (readable_[index] == 0 && unreadable_[index] >= std::min(kTries, std::max<std::size_t>(topic.count, 1)))
      throw InputError::format("{}; none of its first {} messages can be read: give --topic {}=NAME or none", detail,
                               unreadable_[index], name);
  }

  void feed_events(std::size_t camera, const std::string& type, WireReader message) {
    EventArray array = events_[camera].decode(type, message);
    const cv::Size size(static_cast<int>(array.width), static_cast<int>(array.height));
    if (sensor(camera).empty()) {
      const std::optional<cv::Size> stated = size.empty() ? std::nullopt : std::optional(size);
      set_sensor(event_sensor_size(name_, geometry_ ? geometry_ : stated, rig_ ? &*rig_ : nullptr,
                                   choice_.cameras[camera].name),
                 camera);
    }
    push_events(array.events, camera);
  }

  void feed_frame(std::size_t camera, const std::string& type, WireReader message) {
    GrayImage gray = read_frame(type, message);
    push_frame(gray.t, std::move(gray.image), camera);
  }

  void feed_imu(std::size_t topic, WireReader message) {
    if (!imu_topics_.accel) return push_imu(read_imu(message));
    const ImuMessage imu = read_imu_message(message);
    const bool accel = topic == *imu_topics_.accel;
    if (!(accel ? imu.accel : imu.gyro).allFinite()) throw Damage("not finite");
    const auto samples =
        accel ? imu_interpolator_.add_accel(imu.t, imu.accel) : imu_interpolator_.add_gyro(imu.t, imu.gyro);
    for (const ImuSample& sample : samples) push_imu(sample);
  }

  std::unique_ptr<MessageSource> source_;
  ImuTopics imu_topics_;
  ImuInterpolator imu_interpolator_;
  TopicChoice choice_;
  std::optional<Rig> rig_;
  std::optional<cv::Size> geometry_;
  std::vector<EventMessageDecoder> events_;         ///< one for each event camera
  std::vector<std::size_t> readable_, unreadable_;  ///< messages, by topic; those of the accelerometer with the gyro's
};

}  // namespace

Recording open_bag(const std::filesystem::path& path, const Rig* rig, const RecordingOptions& options) {
  auto dataset = std::make_unique<RosDataset>(path, wishes_of(rig, options), options.geometry);
  std::optional<Calibration> calibration = dataset->intrinsics();
  if (calibration && rig)
    for (const RigCamera& camera : calibration->rig.cameras)
      warn_of_other_lens(path.string(), camera.model.mean_focal(), *rig, camera.modality, camera.name);
  return {std::move(dataset), std::move(calibration)};
}

}  // namespace edged
