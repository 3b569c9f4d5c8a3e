// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// ROS 1 bags of version 2.0, read without ROS.
#pragma once

#include <map>

#include "edged/io/ros/bag/record_source.hpp"

namespace edged {

/// A record has a header with named fields, and data.
class Bag final : public RecordSource {
 public:
  /// Throws InputError for a bag without messages.
  Bag(const std::filesystem::path& path, Repairs* repairs);

  Wire wire() const override { return Wire::Ros1; }

 private:
  void read_index() override;
  void forget() override { topic_of_connection_.clear(); }
  bool load_record() override;
  std::optional<Message> take_message() override;
  void add_connection(const class BagFields& header, ByteSpan data);
  void add_chunk_info(const class BagFields& header, ByteSpan data);

  std::map<std::uint32_t, std::size_t> topic_of_connection_;
};

}  // namespace edged
