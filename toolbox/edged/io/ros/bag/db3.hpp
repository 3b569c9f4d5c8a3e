// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// ROS 2 bags in SQLite files.
#pragma once

#include <filesystem>
#include <map>

#include "edged/io/parse/repairs.hpp"
#include "edged/io/ros/bag/message_source.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace edged {

class Db3 final : public MessageSource {
 public:
  /// Throws InputError without a readable table of messages.
  Db3(const std::filesystem::path& file, Repairs* repairs);

  Wire wire() const override { return Wire::Cdr; }
  const std::vector<Topic>& topics() const override { return topics_; }
  Duration length() const override { return length_; }
  std::optional<Message> next() override;

 private:
  struct Close {
    void operator()(sqlite3* database) const;
    void operator()(sqlite3_stmt* statement) const;
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Close>;

  Statement prepare(const char* query);
  /// False at the end, or after damage, which is counted.
  bool step(sqlite3_stmt* statement);

  std::string name_;
  Repairs* repairs_;
  std::unique_ptr<sqlite3, Close> database_;
  std::vector<Topic> topics_;
  std::map<std::int64_t, std::size_t> topic_of_id_;
  Duration length_{0};
  Statement messages_;
};

}  // namespace edged
