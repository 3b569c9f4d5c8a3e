// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes ROS 2 messages to an MCAP file.
#pragma once

#include "edged/io/ros/bag/mcap_writer.hpp"
#include "edged/io/ros/bag/message_sink.hpp"

namespace edged {

class McapSink final : public MessageSink {
 public:
  explicit McapSink(const std::filesystem::path& file, const ChunkOptions& options = {"zstd"})
      : file_(file, "ros2", options) {}

  Wire wire() const override { return Wire::Cdr; }
  std::size_t add_topic(std::string_view name, std::string_view type, const MessageDefinition& definition) override;
  void write(std::size_t topic, Timestamp t, std::string_view message) override { file_.write(topic, t, message); }
  void finish() override { file_.finish(); }

 private:
  McapWriter file_;
};

}  // namespace edged
