// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// ROS 1 bags of version 2.0, read without ROS.
#pragma once

#include <map>

#include "edged/io/ros/message_source.hpp"

namespace edged {

/// Records of a header with named fields and data; most are in chunks, which may be compressed. The index at the end
/// tells topics and counts; where it is missing or damaged (a recorder that crashed), the file is read through once.
class Bag final : public MessageSource {
 public:
  /// Throws InputError when there is nothing to read.
  Bag(const std::filesystem::path& file, Repairs* repairs);

  Wire wire() const override { return Wire::Ros1; }
  const std::vector<Topic>& topics() const override { return topics_; }
  Duration length() const override { return last_ > first_ ? last_ - first_ : Duration(0); }
  std::optional<Message> next() override;

 private:
  bool read_index();
  void read_through();
  bool load_next_record();
  std::optional<Message> take_message();
  void add_connection(const class BagFields& header, ByteSpan data);
  void extend(Timestamp t);
  void rewind();
  void repair(const std::string& kind, const std::string& detail);

  std::string name_;
  BinaryFile file_;
  Repairs* repairs_;
  std::vector<Topic> topics_;
  std::map<std::uint32_t, std::size_t> topic_of_connection_;
  std::vector<std::uint64_t> chunk_places_;  ///< of the index, rising: where reading goes on after damage
  Timestamp first_ = Timestamp::max(), last_ = Timestamp::min();
  std::uint64_t at_ = 0;  ///< next record of the file
  Bytes records_;         ///< those of the chunk being read
  ByteReader reader_{ByteSpan()};
};

}  // namespace edged
