// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Header lines `% key value`, and blocks of the file through the decoder.
#include "edged/io/prophesee/raw.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <map>

#include "edged/core/check.hpp"
#include "edged/io/formats.hpp"
#include "edged/io/merger.hpp"

namespace edged {
namespace {

constexpr std::size_t kHeaderBytes = 65536;       // no header is longer
constexpr std::size_t kEventBlockBytes = 262144;  // a multiple of every word

using HeaderFields = std::map<std::string, std::string, std::less<>>;

std::string_view field_or_empty(const HeaderFields& fields, std::string_view key) {
  const auto found = fields.find(key);
  return found == fields.end() ? std::string_view() : found->second;
}

/// `key value` or `key=value`.
void add_field(HeaderFields& fields, std::string_view text, char separator) {
  const std::size_t cut = std::min(text.find(separator), text.size());
  fields.emplace(text.substr(0, cut), cut < text.size() ? text.substr(cut + 1) : "");
}

/// Lines that begin with "% ", up to `% end` or the first other line; then `bytes` is where they end. Old files have no
/// `% end`: events that happen to begin like a line are told by characters no line has.
HeaderFields header_fields(std::string_view head, std::size_t& bytes) {
  HeaderFields fields;
  for (bytes = 0; head.substr(bytes).starts_with("% ");) {
    const std::size_t line_end = head.find('\n', bytes);
    if (line_end == std::string_view::npos) break;
    std::string_view line = head.substr(bytes + 2, line_end - bytes - 2);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (std::any_of(line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; })) break;
    bytes = line_end + 1;
    if (line == "end") break;
    add_field(fields, line, ' ');
  }
  return fields;
}

/// `EVT3;height=720;width=1280`: the parts behind the first join the fields.
void split_format(HeaderFields& fields) {
  const std::string whole(field_or_empty(fields, "format"));
  for (std::size_t begin = whole.find(';'); begin != std::string::npos; begin = whole.find(';', begin + 1))
    add_field(fields, std::string_view(whole).substr(begin + 1, whole.find(';', begin + 1) - begin - 1), '=');
  if (!whole.empty()) fields["format"] = whole.substr(0, whole.find(';'));
}

/// The encoding as the header names it, or "DAT".
std::string_view encoding_name(const HeaderFields& fields) {
  if (const auto format = field_or_empty(fields, "format"); !format.empty()) return format;
  const std::string_view evt = field_or_empty(fields, "evt");
  if (evt == "2.0") return "EVT2";
  if (evt == "2.1") return "EVT21";
  if (evt == "3.0") return "EVT3";
  return fields.contains("Data") || fields.contains("Version") ? "DAT" : evt;
}

std::optional<cv::Size> header_geometry(const HeaderFields& fields) {
  for (const auto& [w, h] : {std::pair("width", "height"), std::pair("Width", "Height")}) {
    const auto said = parse_geometry(fmt::format("{}x{}", field_or_empty(fields, w), field_or_empty(fields, h)));
    if (said) return said;
  }
  if (const auto size = parse_geometry(field_or_empty(fields, "geometry"))) return size;
  struct Known {
    std::string_view key, part;
    cv::Size size;
  };
  static const std::array<Known, 7> kKnown{{{"plugin_name", "genx320", {320, 320}},
                                            {"sensor_name", "GenX320", {320, 320}},
                                            {"plugin_name", "gen4", {1280, 720}},
                                            {"plugin_name", "imx636", {1280, 720}},
                                            {"sensor_name", "IMX636", {1280, 720}},
                                            {"plugin_name", "gen31", {640, 480}},
                                            {"plugin_name", "gen3", {640, 480}}}};
  for (const Known& known : kKnown)
    if (field_or_empty(fields, known.key).find(known.part) != std::string_view::npos) return known.size;
  return std::nullopt;
}

/// Events alone, block by block.
class PropheseeDataset final : public Dataset {
 public:
  PropheseeDataset(const std::filesystem::path& file, const PropheseeHeader& header, cv::Size geometry)
      : file_(file),
        name_(file.string()),
        at_(header.bytes),
        decoder_(header.format, geometry.width, geometry.height),
        merger_({.events = true}, repairs_) {
    info_.name = file.stem().string();
    info_.format = header.format == EvtFormat::Dat ? "prophesee dat" : "prophesee raw";
    info_.has_events = true;
    while (block_.empty() && read_block()) {
    }
    if (block_.empty()) throw InputError::format("{}: nothing to read: holds no events", name_);
    info_.begin = block_.front().t;
    info_.end = last_stamp_of(header, geometry);
    merger_.push(block_);
  }

  const DatasetInfo& info() const override { return info_; }

  std::optional<Measurement> next() override {
    while (true) {
      if (auto measurement = merger_.pop()) return measurement;
      if (at_end_) return std::nullopt;
      at_end_ = !read_block();
      merger_.push(block_);
      if (at_end_) merger_.finish();
    }
  }

  std::map<std::string, std::size_t> repairs() const override {
    std::map<std::string, std::size_t> all = repairs_.counts();
    const auto add = [&all](const char* kind, std::size_t count) {
      if (count > 0) all[kind] += count;
    };
    add("events: pixel outside the sensor", decoder_.counts().outside);
    add("events: before the first time", decoder_.counts().untimed);
    add("events: unknown word", decoder_.counts().unknown);
    return all;
  }

 private:
  /// Fills block_; false at the end of the file.
  bool read_block() {
    block_.clear();
    const Bytes bytes = file_.read(at_, kEventBlockBytes);
    at_ += bytes.size();
    decoder_.decode(bytes, block_);
    good_ += block_.size();
    refuse_nonsense();
    return !bytes.empty();
  }

  void refuse_nonsense() const {
    const EvtDecoder::Counts& counts = decoder_.counts();
    const auto many = [this](std::size_t count) { return count > 1000 && count > good_ / 100; };
    if (many(counts.outside))
      throw InputError::format("{}: {} of {} events lie outside the sensor; give its size with --geometry WIDTHxHEIGHT",
                               name_, counts.outside, counts.outside + good_);
    if (many(counts.unknown))
      throw InputError::format(
          "{}: {} words are of no known type: the file is damaged or not of the encoding that its "
          "header names",
          name_, counts.unknown);
  }

  /// From the last block; nothing for EVT 3, whose time wraps every 17 s.
  std::optional<Timestamp> last_stamp_of(const PropheseeHeader& header, cv::Size geometry) {
    if (header.format == EvtFormat::Evt3) return std::nullopt;
    const std::uint64_t blocks = (file_.size() - header.bytes) / kEventBlockBytes;
    std::vector<Event> events;
    EvtDecoder(header.format, geometry.width, geometry.height)
        .decode(file_.read(header.bytes + blocks * kEventBlockBytes, kEventBlockBytes), events);
    return events.empty() ? std::nullopt : std::optional(events.back().t);
  }

  BinaryFile file_;
  std::string name_;
  std::uint64_t at_;
  DatasetInfo info_;
  Repairs repairs_;
  EvtDecoder decoder_;
  Merger merger_;
  std::vector<Event> block_;
  std::size_t good_ = 0;
  bool at_end_ = false;
};

}  // namespace

bool is_prophesee_file(ByteSpan head) { return head.size() > 2 && head[0] == '%' && head[1] == ' '; }

PropheseeHeader read_prophesee_header(ByteSpan head, const std::string& file) {
  PropheseeHeader header;
  HeaderFields fields = header_fields(as_text(head), header.bytes);
  split_format(fields);
  header.geometry = header_geometry(fields);
  const std::string_view name = encoding_name(fields);
  if (name == "EVT2") {
    header.format = EvtFormat::Evt2;
  } else if (name == "EVT21" || name == "EVT21ME") {
    // Cameras that send whole words say so.
    const bool little = name == "EVT21" && field_or_empty(fields, "endianness") == "little";
    header.format = little ? EvtFormat::Evt21 : EvtFormat::Evt21Legacy;
  } else if (name == "EVT3") {
    header.format = EvtFormat::Evt3;
  } else if (name == "DAT") {
    header.format = EvtFormat::Dat;
    constexpr int kEvent2d = 0x00, kEventCd = 0x0C, kRecordBytes = 8;
    if (head.size() < header.bytes + 2) throw InputError::format("{}: nothing to read: ends in its header", file);
    const int type = head[header.bytes], size = head[header.bytes + 1];
    if ((type != kEvent2d && type != kEventCd) || size != kRecordBytes)
      throw InputError::format(
          "{}: holds records of type {} and {} bytes; only change events (types 0 and 12) of 8 "
          "bytes can be read",
          file, type, size);
    header.bytes += 2;
  } else {
    throw InputError::format("{}: encoding `{}` cannot be read; EVT2, EVT21, EVT3 and DAT can", file, name);
  }
  return header;
}

Recording open_prophesee(const std::filesystem::path& file, const Rig* rig, std::optional<cv::Size> geometry) {
  const PropheseeHeader header = read_prophesee_header(BinaryFile(file).read(0, kHeaderBytes), file.string());
  return {std::make_unique<PropheseeDataset>(file, header,
                                             event_sensor_size(file, geometry ? geometry : header.geometry, rig)),
          std::nullopt};
}

}  // namespace edged
