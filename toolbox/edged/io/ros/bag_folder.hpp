// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Bags in several files that follow each other: folders of ROS 2, and the parts of `rosbag record --split`.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "edged/io/ros/message_source.hpp"

namespace edged {

/// The .db3 or .mcap files of a folder, also compressed as .zstd, in the order of their numbers; empty where there are
/// none. metadata.yaml, which crashed recorders do not write, says nothing that the files do not.
std::vector<std::filesystem::path> bag_parts(const std::filesystem::path& folder);

/// The files that make one bag with the first of them, NAME_0.bag, NAME_1.bag and so on, in this order; that file alone
/// where it is no first part.
std::vector<std::filesystem::path> split_bag_parts(const std::filesystem::path& first);

/// Names of the files that a bag in these parts lacks: as the metadata.yaml beside them lists them,
/// else by their numbers.
std::vector<std::string> missing_parts(const std::vector<std::filesystem::path>& parts);

/// The messages of one file after those of the other.
class BagFolder final : public MessageSource {
 public:
  explicit BagFolder(std::vector<std::unique_ptr<MessageSource>> parts);

  Wire wire() const override { return parts_.front().source->wire(); }
  const std::vector<Topic>& topics() const override { return topics_; }
  Duration length() const override;
  std::optional<Timestamp> begin_stamp() const override { return parts_.front().source->begin_stamp(); }
  std::optional<Message> next() override;
  std::optional<Message> next_of(std::size_t topic) override;

 private:
  struct Part {
    std::unique_ptr<MessageSource> source;
    std::vector<std::size_t> topics;  ///< its topics among those of all
  };
  std::vector<Part> parts_;
  std::vector<Topic> topics_;
  std::size_t current_ = 0;
};

}  // namespace edged
