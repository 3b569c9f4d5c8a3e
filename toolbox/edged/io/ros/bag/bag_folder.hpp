// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Bags in several consecutive files: folders of ROS 2, and the parts of `rosbag record --split`.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "edged/io/ros/bag/message_source.hpp"

namespace edged {

/// The .db3 or .mcap files of a folder, also compressed as .zstd, in the order of their numbers. Empty if there are
/// none. metadata.yaml is not needed: crashed recorders do not write it, and the files contain the same information.
std::vector<std::filesystem::path> bag_parts(const std::filesystem::path& folder);

/// The files of the bag whose first part is given, NAME_0.bag, NAME_1.bag and so on, in this order. Only the given file
/// if it is no first part.
std::vector<std::filesystem::path> split_bag_parts(const std::filesystem::path& first);

/// Names of the missing files of a bag in these parts, by the list in metadata.yaml, else by their numbers.
std::vector<std::string> missing_parts(const std::vector<std::filesystem::path>& parts);

/// Reads the messages of several files, one file after the other.
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
    std::vector<std::size_t> topics;  ///< index of each of its topics among those of all parts
  };
  std::vector<Part> parts_;
  std::vector<Topic> topics_;
  std::size_t current_ = 0;
};

}  // namespace edged
