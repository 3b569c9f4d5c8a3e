// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Finds the files of a bag in several, as folders of ROS 2 and `rosbag record --split` have, detects the container of
// each, decompresses what the recorder compressed, and joins them.
#include "edged/io/ros/bag/open_messages.hpp"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <set>
#include <tuple>

#include "edged/core/check.hpp"
#include "edged/io/archive/compression.hpp"
#include "edged/io/ros/ros.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kZstdMagic = "\x28\xB5\x2F\xFD";  // no message in CDR begins so

enum class Container { None, Bag, Mcap, Db3, Zstd };

Container container_of(ByteSpan head) {
  const std::string_view magic = as_text(head);
  if (magic.starts_with(kBagMagic)) return Container::Bag;
  if (magic.starts_with(kMcapMagic)) return Container::Mcap;
  if (magic.starts_with("SQLite format 3")) return Container::Db3;
  return magic.starts_with(kZstdMagic) ? Container::Zstd : Container::None;
}

/// A temporary folder, which the destructor removes with its content.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (fs::temp_directory_path() / "edged_XXXXXX").string();
    if (!::mkdtemp(pattern.data()))
      throw InputError::format("{}: cannot be made, to unpack a bag there: set TMPDIR", pattern);
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::unique_ptr<MessageSource> open_container(const BagFile& file, Repairs* repairs);

/// Decompresses a file into the folder of temporary files (TMPDIR) and opens it there. It is then unlinked, so it
/// disappears with the source.
std::unique_ptr<MessageSource> open_packed_file(const BagFile& file, Repairs* repairs) {
  const ScratchFolder scratch;
  const fs::path unpacked = scratch.path() / file.path.stem();
  if (!decompress_zstd_file(file.path, unpacked) && repairs)
    repairs->add("bag: cut", file.name + ": the compressed file is not whole");
  return open_container({unpacked, file.name}, repairs);
}

std::unique_ptr<MessageSource> open_container(const BagFile& file, Repairs* repairs) {
  constexpr std::size_t kContainerHeadBytes = 16;
  switch (container_of(BinaryFile(file.path).read(0, kContainerHeadBytes))) {
    case Container::Bag:
      return open_ros1_bag(file, repairs);
    case Container::Mcap:
      return open_mcap(file, repairs);
    case Container::Db3:
      return open_db3(file, repairs);
    case Container::Zstd:
      return open_packed_file(file, repairs);
    case Container::None:
      break;
  }
  throw InputError::format("{}: not a ROS bag, or its beginning is damaged", file.name);
}

std::unique_ptr<MessageSource> open_part(const fs::path& file, Repairs* repairs) {
  return open_container({file, file.string()}, repairs);
}

/// Nothing for a part of several that cannot be read.
std::unique_ptr<MessageSource> try_part(const fs::path& file, Repairs* repairs) try {
  return open_part(file, repairs);
} catch (const InputError& error) {
  if (repairs) repairs->add("bag: part unreadable", error.what());
  return nullptr;
}

/// The messages of several files, one file after the other. Messages that are compressed one by one are decompressed.
class BagMessages final : public MessageSource {
 public:
  explicit BagMessages(Repairs* repairs) : repairs_(repairs) {}

  void add(const fs::path& file, std::unique_ptr<MessageSource> source) {
    Part& part = parts_.emplace_back(file, std::move(source));
    for (const Topic& topic : part.source->topics()) {
      part.topics.push_back(topic_index(topics_, topic.name, topic.type, topic.definition));
      topics_[part.topics.back()].count += topic.count;
    }
    length_ += part.source->length();
  }

  Wire wire() const override { return parts_.front().source->wire(); }
  const std::vector<Topic>& topics() const override { return topics_; }
  Duration length() const override { return length_; }
  std::optional<Timestamp> begin_stamp() const override { return parts_.front().source->begin_stamp(); }

  std::optional<Message> read(std::optional<std::size_t> only) override {
    for (; current_ < parts_.size(); ++current_) {
      const auto& [file, source, topics] = parts_[current_];
      const auto own = only ? std::ranges::find(topics, *only) : topics.end();
      if (only && own == topics.end()) continue;
      const auto sought = only ? std::optional(static_cast<std::size_t>(own - topics.begin())) : std::nullopt;
      while (const auto message = source->read(sought))
        if (message->topic < topics.size())  // the index of a damaged file may lack topics that are found later
          if (const auto data = plain(file, message->data)) return Message{topics[message->topic], *data};
    }
    return std::nullopt;
  }

 private:
  struct Part {
    Part(fs::path of, std::unique_ptr<MessageSource> opened) : file(std::move(of)), source(std::move(opened)) {}
    fs::path file;
    std::unique_ptr<MessageSource> source;
    std::vector<std::size_t> topics;  ///< index of each of its topics among those of all parts
  };

  /// The data of a message. Nothing for a damaged one.
  std::optional<ByteSpan> plain(const fs::path& file, ByteSpan data) {
    constexpr std::size_t kLargestMessage = 1U << 28U;
    if (!as_text(data).starts_with(kZstdMagic) || wire() != Wire::Cdr) return data;
    Decompressed unpacked = decompress("zstd", data, kLargestMessage);
    message_ = std::move(unpacked.bytes);
    if (unpacked.whole) return message_;
    if (repairs_) repairs_->add("bag: message damaged", file.string() + ": a compressed message is not whole");
    return std::nullopt;
  }

  Repairs* repairs_;
  std::vector<Part> parts_;
  std::vector<Topic> topics_;
  Duration length_{0};
  std::size_t current_ = 0;
  Bytes message_;  ///< decompressed
};

/// Files that have only the names of parts were recorded at other times.
bool follows(const MessageSource& part, const MessageSource& before) {
  constexpr Duration kOverlap = std::chrono::seconds(5), kGap = std::chrono::seconds(10);
  if (!part.begin_stamp() || !before.begin_stamp()) return true;
  const Duration gap = *part.begin_stamp() - (*before.begin_stamp() + before.length());
  return gap > -kOverlap && gap < kGap;
}

/// Splits "NAME_12.bag" into "NAME_", 12 and ".bag".
struct PartName {
  std::string front, back;
  int number = 0;
};

std::optional<PartName> part_name(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::size_t dot = name.find('.', name.rfind('_') + 1), bar = name.rfind('_');
  if (bar == std::string::npos || dot == std::string::npos) return std::nullopt;
  PartName part{name.substr(0, bar + 1), name.substr(dot), 0};
  const char* const end = name.data() + dot;
  const auto [stop, error] = std::from_chars(name.data() + bar + 1, end, part.number);
  if (error != std::errc() || stop != end || part.number < 0) return std::nullopt;
  return part;
}

/// name_2 before name_10, compressed or not.
std::tuple<std::string, int, std::size_t, std::string> order_of_part(const fs::path& file) {
  const std::string name = (file.extension() == ".zstd" ? file.stem() : file.filename()).string();
  const PartName part = part_name(file).value_or(PartName());
  return {part.front, part.number, name.size(), name};
}

/// The files that a metadata.yaml lists: lines of `- NAME.db3`.
std::vector<std::string> listed_parts(const fs::path& metadata) {
  std::vector<std::string> names;
  std::ifstream in(metadata);
  for (std::string line; std::getline(in, line);) {
    const std::size_t begin = line.find_first_not_of(" -\"'\t"), dash = line.find('-');
    const std::size_t end = line.find_last_not_of(" \"'\t\r");
    if (begin == std::string::npos || dash >= begin) continue;
    const std::string name = line.substr(begin, end - begin + 1);
    for (const char* ending : {".db3", ".mcap", ".db3.zstd", ".mcap.zstd"})
      if (name.ends_with(ending) && name.find(':') == std::string::npos) names.push_back(name);
  }
  return names;
}

/// The .db3 or .mcap files of a folder, also compressed as .zstd, in the order of their numbers. Empty if there are
/// none. metadata.yaml is not needed: crashed recorders do not write it, and the files contain the same information.
std::vector<fs::path> bag_parts(const fs::path& folder) {
  std::vector<fs::path> parts;
  for (const auto& entry : fs::directory_iterator(folder)) {
    fs::path plain = entry.path();
    if (plain.extension() == ".zstd") {
      plain.replace_extension();
      if (fs::exists(plain)) continue;  // the recorder was stopped while it compressed
    }
    const auto extension = plain.extension();
    if (entry.is_regular_file() && (extension == ".db3" || extension == ".mcap")) parts.push_back(entry.path());
  }
  std::ranges::sort(parts, {}, order_of_part);
  return parts;
}

/// Names of the missing files of a bag in these parts, by the list in metadata.yaml, else by their numbers.
std::vector<std::string> missing_parts(const std::vector<fs::path>& parts) {
  std::set<std::string> missing;
  std::set<std::string> there;
  for (const fs::path& file : parts) {
    there.insert(file.filename().string());
    if (file.extension() == ".zstd") there.insert(file.stem().string());  // metadata.yaml lists either name
  }
  const auto is_there = [&there](const std::string& name) {
    return there.contains(name) || there.contains(fs::path(name).stem().string());
  };
  const std::vector<std::string> listed = listed_parts(parts.front().parent_path() / "metadata.yaml");
  if (std::ranges::any_of(listed, is_there)) {  // otherwise the files have been renamed
    for (const std::string& name : listed)
      if (!is_there(name)) missing.insert(name);
    return {missing.begin(), missing.end()};
  }
  if (const auto last = part_name(parts.back()); last && parts.size() > 1) {
    std::set<int> numbers;
    for (const fs::path& file : parts)
      if (const auto part = part_name(file); part && part->front == last->front) numbers.insert(part->number);
    for (int i = 0; numbers.size() == parts.size() && i < last->number; ++i)
      if (!numbers.contains(i)) missing.insert(last->front + std::to_string(i) + last->back);
  }
  return {missing.begin(), missing.end()};
}

}  // namespace

std::size_t topic_index(std::vector<Topic>& topics, std::string_view name, std::string_view type,
                        std::string_view definition) {
  std::string short_type(type);
  if (const std::size_t at = short_type.find("/msg/"); at != std::string::npos) short_type.erase(at, 4);
  const auto found =
      std::ranges::find_if(topics, [&](const Topic& topic) { return topic.name == name && topic.type == short_type; });
  if (found != topics.end()) return static_cast<std::size_t>(found - topics.begin());
  topics.push_back({std::string(name), short_type, std::string(definition), 0});
  return topics.size() - 1;
}

std::string ros2_type(std::string_view type) {
  std::string long_type(type);
  return long_type.insert(long_type.find('/'), "/msg");
}

bool is_bag(ByteSpan head) { return container_of(head) != Container::None; }

bool is_bag_folder(const fs::path& folder) { return !bag_parts(folder).empty(); }

std::vector<fs::path> split_bag_parts(const fs::path& first) {
  const auto own = part_name(first);
  if (!own || own->back != ".bag") return {first};
  std::vector<std::pair<int, fs::path>> parts;
  std::error_code ignored;
  const fs::path folder = first.has_parent_path() ? first.parent_path() : ".";
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const auto other = part_name(entry.path());
    if (other && other->front == own->front && other->back == own->back && entry.is_regular_file(ignored))
      parts.emplace_back(other->number, first.parent_path() / entry.path().filename());
  }
  std::ranges::sort(parts);
  if (parts.size() < 2 || parts.front().first != own->number) return {first};
  std::vector<fs::path> files;
  for (auto& part : parts) files.push_back(std::move(part.second));
  return files;
}

std::unique_ptr<MessageSource> open_messages(const fs::path& path, Repairs* repairs) {
  const bool folder = fs::is_directory(path);
  const std::vector<fs::path> files = folder ? bag_parts(path) : split_bag_parts(path);
  const std::vector<std::string> missing =
      folder || files.size() > 1 ? missing_parts(files) : std::vector<std::string>();
  std::vector<std::pair<fs::path, std::unique_ptr<MessageSource>>> parts;
  for (const fs::path& file : files) {
    auto part = files.size() > 1 ? try_part(file, repairs) : open_part(file, repairs);
    if (!part) continue;
    const bool apart = !folder && !parts.empty() && missing.empty() && !follows(*part, *parts.back().second);
    parts.emplace_back(file, std::move(part));
    if (!apart) continue;
    if (repairs)
      spdlog::warn(
          fmt::format("{}: does not follow the part before it: {} is read alone", file.string(), path.string()));
    parts.clear();
    parts.emplace_back(path, open_part(path, repairs));
    break;
  }
  if (parts.empty()) parts.emplace_back(files.front(), open_part(files.front(), repairs));  // throws the reason
  if (!missing.empty() && repairs)
    repairs->add("bag: part missing",
                 fmt::format("{}: lacks {}; the others are read", path.string(), fmt::join(missing, ", ")));
  auto messages = std::make_unique<BagMessages>(repairs);
  for (auto& [file, part] : parts) messages->add(file, std::move(part));
  return messages;
}

}  // namespace edged
