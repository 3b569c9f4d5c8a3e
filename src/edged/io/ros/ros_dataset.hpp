// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A bag of ROS 1 or 2 as a recording.
#pragma once

#include <array>

#include "edged/core/dataset.hpp"
#include "edged/io/merger.hpp"
#include "edged/io/ros/event_packets.hpp"
#include "edged/io/ros/message_source.hpp"
#include "edged/io/ros/topic_choice.hpp"

namespace edged {

/// Cameras "events" and "frames"; poses of "body".
class RosDataset final : public Dataset {
 public:
  /// sensor: size of the event camera where the user's rig tells it, else that of the messages. Throws InputError where
  /// topics have to be chosen or nothing can be read.
  RosDataset(std::filesystem::path path, const WantedTopics& wanted, std::optional<cv::Size> sensor);

  const DatasetInfo& info() const override { return info_; }
  std::optional<Measurement> next() override;
  std::optional<GroundTruth> ground_truth() const override;
  std::map<std::string, std::size_t> repairs() const override { return repairs_.counts(); }

 private:
  std::optional<Measurement> merged();
  void feed(const Message& message);
  void feed_events(const std::string& type, WireReader message);
  void feed_frame(const std::string& type, WireReader message);
  void judge(std::size_t role, const std::string& reason);

  std::filesystem::path path_;
  std::optional<cv::Size> sensor_;
  Repairs repairs_;
  std::unique_ptr<MessageSource> source_;
  TopicChoice choice_;
  DatasetInfo info_;
  Merger merger_;
  EventPacketDecoder packets_;
  cv::Size image_size_;                                        ///< of the first image
  std::array<std::size_t, kRoleNames.size()> good_{}, bad_{};  ///< messages, by role
  bool finished_ = false;
  std::optional<Measurement> first_;  ///< read for the begin
};

}  // namespace edged
