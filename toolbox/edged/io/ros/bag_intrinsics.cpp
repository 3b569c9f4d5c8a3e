// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Assigns CameraInfo topics to cameras.
#include "edged/io/ros/bag_intrinsics.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <vector>

#include "edged/io/ros/messages/messages.hpp"

namespace edged {
namespace {

/// "/dvs/camera_info" for "/dvs/image_raw" and for "/dvs/image_raw/compressed".
std::string info_topic_of(std::string name) {
  if (name.ends_with("/compressed")) name.erase(name.rfind('/'));
  return name.substr(0, name.rfind('/') + 1) + "camera_info";
}

}  // namespace

std::optional<Calibration> read_bag_intrinsics(MessageSource& source, const TopicChoice& choice) {
  std::map<std::size_t, std::optional<CameraModel>> models;  // by topic
  std::vector<std::optional<std::size_t>> topic_of_camera(choice.cameras.size());
  const std::vector<Topic>& topics = source.topics();
  for (std::size_t c = 0; c < choice.cameras.size(); ++c) {
    const std::string wanted = info_topic_of(topics[choice.cameras[c].topic].name);
    for (std::size_t i = 0; i < topics.size(); ++i)
      if (topics[i].name == wanted && topics[i].type == "sensor_msgs/CameraInfo" && topics[i].count > 0)
        models[i].reset(), topic_of_camera[c] = i;
  }
  for (std::size_t missing = models.size(); missing > 0;) {
    const auto message = source.next();
    if (!message) break;
    const auto model = models.find(message->topic);
    if (model == models.end() || model->second) continue;
    --missing;
    try {
      model->second = read_camera_info(WireReader(source.wire(), message->data));
    } catch (const Damage& damage) {
      spdlog::warn(fmt::format("{}: intrinsics not used: {}", topics[message->topic].name, damage.what()));
      models.erase(model);
    }
  }

  Calibration calibration;
  calibration.has_extrinsics = calibration.has_imu_noise = false;
  for (std::size_t c = 0; c < choice.cameras.size(); ++c) {
    const auto model = topic_of_camera[c] ? models.find(*topic_of_camera[c]) : models.end();
    if (model != models.end() && model->second)
      calibration.rig.cameras.push_back(
          {choice.cameras[c].name, choice.cameras[c].modality, *model->second, SE3(), Duration(0)});
  }
  return calibration.rig.cameras.empty() ? std::nullopt : std::optional(std::move(calibration));
}

}  // namespace edged
