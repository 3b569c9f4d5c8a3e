// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// ROS 2 bags in SQLite files: the tables.
#include <sqlite3.h>

#include <algorithm>
#include <map>

#include "edged/core/check.hpp"
#include "edged/io/ros/bag/open_messages.hpp"

namespace edged {
namespace {

std::string_view column_text(sqlite3_stmt* statement, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return text ? std::string_view(text) : std::string_view();
}

/// True if the file ends before the last page that its first page states. SQLite reads the missing pages as zeros.
bool is_cut(const std::filesystem::path& file) {
  BinaryFile bytes(file);
  const Bytes head = bytes.read(0, 100);
  const auto big_endian = [&head](std::size_t at, std::size_t count) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i) value = value << 8U | head[at + i];
    return value;
  };
  if (head.size() < 100) return true;
  const std::uint64_t stated = big_endian(16, 2), page_bytes = stated == 1 ? 65536 : stated;
  const bool page_count_valid = big_endian(24, 4) == big_endian(92, 4);
  return page_count_valid && big_endian(28, 4) * page_bytes > bytes.size();
}

class Db3 final : public MessageSource {
 public:
  Db3(const std::filesystem::path& file, std::string name, Repairs* repairs)
      : name_(std::move(name)), repairs_(repairs) {
    open(file);
    if (repairs_ && is_cut(file))
      repairs_->add("bag: cut", name_ + ": the file ends before its last page: messages there may be damaged");
    find_topics();
    count_messages();
    messages_ = prepare("SELECT topic_id, data FROM messages ORDER BY id");
  }

  Wire wire() const override { return Wire::Cdr; }
  const std::vector<Topic>& topics() const override { return topics_; }
  Duration length() const override { return length_; }

  std::optional<Message> read(std::optional<std::size_t> only) override {
    while (step(messages_.get())) {
      const auto topic = topic_of_id_.find(sqlite3_column_int64(messages_.get(), 0));
      if (topic == topic_of_id_.end() || (only && topic->second != *only)) continue;
      const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(messages_.get(), 1));
      const auto size = static_cast<std::size_t>(sqlite3_column_bytes(messages_.get(), 1));
      if (data) return Message{topic->second, ByteSpan(data, size)};
    }
    return std::nullopt;
  }

 private:
  struct Close {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
    void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Close>;

  /// Changes nothing, also in a read-only folder. The log of a recorder that was killed is read without the file that
  /// its readers share; without a log none is begun.
  void open(const std::filesystem::path& file) {
    const std::filesystem::path whole = std::filesystem::absolute(file);
    std::string uri = "file:";
    for (const char c : whole.string())
      uri += c == '?' || c == '#' || c == '%' ? fmt::format("%{:02x}", c) : std::string(1, c);
    std::error_code none;
    const std::uintmax_t log_bytes = std::filesystem::file_size(whole.string() + "-wal", none);
    uri += !none && log_bytes > 0 ? "?vfs=unix-none" : "?immutable=1";
    sqlite3* opened = nullptr;
    const int result = sqlite3_open_v2(uri.c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(opened);
    if (result != SQLITE_OK) throw InputError::format("{}: cannot be opened as SQLite file", name_);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    // A file that ends before its last page is read as far as it goes only with a writable schema.
    for (const char* pragma : {"PRAGMA locking_mode=EXCLUSIVE", "PRAGMA writable_schema=ON"})
      sqlite3_exec(opened, pragma, nullptr, nullptr, nullptr);
  }

  void find_topics() {
    // A view may have rows without end.
    const Statement tables =
        prepare("SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('topics', 'messages')");
    if (!step(tables.get()) || sqlite3_column_int(tables.get(), 0) != 2)
      throw InputError::format("{}: not a ROS 2 bag: it lacks the tables `topics` and `messages`", name_);
    const Statement topics = prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    while (step(topics.get())) {
      if (column_text(topics.get(), 3) != "cdr") continue;
      const std::string name(column_text(topics.get(), 1));
      topic_of_id_[sqlite3_column_int64(topics.get(), 0)] = topic_index(topics_, name, column_text(topics.get(), 2));
    }
    if (topics_.empty()) throw InputError::format("{}: no topics in this bag: record it again", name_);
  }

  /// Row by row, as a damaged table has no totals.
  void count_messages() {
    const Statement rows = prepare("SELECT topic_id, timestamp FROM messages ORDER BY id");
    std::int64_t first = INT64_MAX, last = 0;
    while (step(rows.get())) {
      const auto topic = topic_of_id_.find(sqlite3_column_int64(rows.get(), 0));
      if (topic == topic_of_id_.end()) continue;
      ++topics_[topic->second].count;
      const std::int64_t stamp = std::max<std::int64_t>(sqlite3_column_int64(rows.get(), 1), 0);
      first = std::min(first, stamp);
      last = std::max(last, stamp);
    }
    if (last > first) length_ = Duration(last - first);
  }

  Statement prepare(const char* query) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database_.get(), query, -1, &statement, nullptr) != SQLITE_OK)
      throw InputError::format("{}: not a ROS 2 bag, or damaged ({})", name_, sqlite3_errmsg(database_.get()));
    return Statement(statement);
  }

  /// False at the end, or after damage, which is counted.
  bool step(sqlite3_stmt* statement) {
    if (!statement) return false;
    const int result = sqlite3_step(statement);
    if (result == SQLITE_ROW) return true;
    if (result != SQLITE_DONE) {
      if (repairs_)
        repairs_->add("bag: database damaged", fmt::format("{}: {}", name_, sqlite3_errmsg(database_.get())));
      if (statement == messages_.get()) messages_.reset();
    }
    return false;
  }

  std::string name_;
  Repairs* repairs_;
  std::unique_ptr<sqlite3, Close> database_;
  std::vector<Topic> topics_;
  std::map<std::int64_t, std::size_t> topic_of_id_;
  Duration length_{0};
  Statement messages_;
};

}  // namespace

std::unique_ptr<MessageSource> open_db3(const BagFile& file, Repairs* repairs) {
  return std::make_unique<Db3>(file.path, file.name, repairs);
}

}  // namespace edged
