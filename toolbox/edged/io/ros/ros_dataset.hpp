// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads a bag of ROS 1 or 2 as a recording.
#pragma once

#include <array>

#include "edged/io/core/imu_join.hpp"
#include "edged/io/core/streamed_dataset.hpp"
#include "edged/io/core/topic_choice.hpp"
#include "edged/io/recording.hpp"
#include "edged/io/ros/bag/message_source.hpp"
#include "edged/io/ros/imu_topics.hpp"
#include "edged/io/ros/messages/sensor_messages.hpp"

namespace edged {

/// The cameras are those of choose_topics(). The poses are those of "body", or of the camera that the messages name.
class RosDataset final : public StreamedDataset {
 public:
  /// The size of an event camera is that of the rig, else `geometry`, else that of its messages. Throws InputError if
  /// the user has to choose topics or nothing is readable.
  RosDataset(const std::filesystem::path& path, TopicWishes wishes, std::optional<cv::Size> geometry);

  std::optional<GroundTruth> ground_truth() const override;

  /// Intrinsics of its cameras, if it holds them.
  std::optional<Calibration> intrinsics() const;

 private:
  bool read_on() override;
  void feed(const Message& message);
  void feed_events(std::size_t camera, const std::string& type, WireReader message);
  void feed_imu(std::size_t topic, WireReader message);
  void feed_frame(std::size_t camera, const std::string& type, WireReader message);
  void name_roles();
  std::string truth_frame() const;
  void judge(std::size_t topic, Role role, const std::string& reason);

  std::unique_ptr<MessageSource> source_;
  ImuTopics imu_topics_;
  ImuJoin imu_join_;
  TopicChoice choice_;
  std::optional<Rig> rig_;
  std::optional<cv::Size> geometry_;
  std::vector<EventMessageDecoder> events_;  ///< of each event camera
  std::vector<std::size_t> good_, bad_;      ///< messages, by topic; those of the accelerometer with the gyro's
};

Recording open_bag(const std::filesystem::path& path, const Rig* rig, const RecordingOptions& options);

}  // namespace edged
