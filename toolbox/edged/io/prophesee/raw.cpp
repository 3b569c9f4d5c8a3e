// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads the header lines `% key value` and decodes the file in blocks.
#include "edged/io/prophesee/raw.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <string>

#include "edged/core/check.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/core/streamed_dataset.hpp"
#include "edged/io/parse/evt.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr std::size_t kHeaderBytes = 65536;       // no header is longer
constexpr std::size_t kEventBlockBytes = 262144;  // a multiple of every word
constexpr std::size_t kBytesPerWrong = 50;        // with more wrong words, bytes may be missing

/// Key of a header line that only this program knows: microseconds to be added to all stamps, as the counters of EVT 3
/// (16.8 s) and DAT (71 min) cannot hold a time of day. Other programs ignore it and read stamps that begin at zero.
constexpr std::string_view kTimeOffsetKey = "edged_time_offset_us";

/// The content of the text lines at the beginning of a file.
struct PropheseeHeader {
  EvtFormat format = EvtFormat::Evt2;
  std::optional<cv::Size> geometry;  ///< sensor [px], from the header or by the name of the camera
  Duration time_offset{0};           ///< to be added to all stamps; only in files of this program
  std::size_t bytes = 0;             ///< offset of the events
};

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

/// Reads lines that begin with "% ", up to `% end` or the first other line. `bytes` is the offset of their end. Old
/// files have no `% end`: events that begin like a line are recognised by characters that no line has.
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

/// `EVT3;height=720;width=1280`: adds the parts after the first to the fields.
void split_format(HeaderFields& fields) {
  const std::string whole(field_or_empty(fields, "format"));
  for (std::size_t begin = whole.find(';'); begin != std::string::npos; begin = whole.find(';', begin + 1))
    add_field(fields, std::string_view(whole).substr(begin + 1, whole.find(';', begin + 1) - begin - 1), '=');
  if (!whole.empty()) fields["format"] = whole.substr(0, whole.find(';'));
}

/// The name of the encoding in the header, or "DAT".
std::string_view encoding_name(const HeaderFields& fields) {
  if (const auto format = field_or_empty(fields, "format"); !format.empty()) return format;
  const std::string_view evt = field_or_empty(fields, "evt");
  if (evt == "2.0") return "EVT2";
  if (evt == "2.1") return "EVT21";
  if (evt == "3.0") return "EVT3";
  if (evt == "4.0") return "EVT4";
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

Duration header_time_offset(const HeaderFields& fields) {
  const std::string_view text = field_or_empty(fields, kTimeOffsetKey);
  std::int64_t us = 0;
  std::from_chars(text.data(), text.data() + text.size(), us);
  return std::chrono::microseconds(std::clamp(us, -kMaxStampNs / 1000, kMaxStampNs / 1000));
}

/// Parses the first bytes of a file. Throws InputError, with `file`, if it has no events of a known encoding.
PropheseeHeader read_prophesee_header(ByteSpan head, const std::string& file) {
  PropheseeHeader header;
  HeaderFields fields = header_fields(as_text(head), header.bytes);
  split_format(fields);
  header.geometry = header_geometry(fields);
  header.time_offset = header_time_offset(fields);
  const std::string_view name = encoding_name(fields);
  if (name == "EVT2") {
    header.format = EvtFormat::Evt2;
  } else if (name == "EVT21" || name == "EVT21ME") {
    // Cameras that send whole words state it in the header.
    const bool little = name == "EVT21" && field_or_empty(fields, "endianness") == "little";
    header.format = little ? EvtFormat::Evt21 : EvtFormat::Evt21Legacy;
  } else if (name == "EVT3") {
    header.format = EvtFormat::Evt3;
  } else if (name == "EVT4") {
    header.format = EvtFormat::Evt4;
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
    throw InputError::format(
        "{}: encoding `{}` cannot be read; EVT2, EVT21, EVT3, EVT4 and DAT can: convert it with "
        "metavision_file_to_hdf5",
        file, name);
  }
  return header;
}

/// Reads events only, block by block.
class PropheseeDataset final : public StreamedDataset {
 public:
  PropheseeDataset(const std::filesystem::path& file, const PropheseeHeader& header, cv::Size geometry)
      : StreamedDataset(file, header.format == EvtFormat::Dat ? "prophesee dat" : "prophesee raw"),
        file_(file),
        at_(header.bytes),
        time_offset_(header.time_offset),
        decoder_(header.format, geometry.width, geometry.height) {
    set_sensor(geometry);
    info_.end = last_stamp_of(header, geometry);
    begin(OneOfEach{.events = true});
  }

 private:
  bool read_on() override {
    const Bytes bytes = file_.read(at_, kEventBlockBytes);
    at_ += bytes.size();
    const EvtDecoder before_block = decoder_;
    const EvtDecoder::Counts before = decoder_.counts();
    events_.clear();
    decoder_.decode(bytes, events_);
    if (wrong(decoder_) - wrong(before_block) > bytes.size() / kBytesPerWrong) {
      decoder_ = before_block;
      events_.clear();
      decode_in_pieces(bytes);
    }
    for (Event& event : events_) event.t += time_offset_;
    decoded_ += events_.size();
    push_events(events_);
    count_left_out(before, decoder_.counts());
    list_triggers();
    return !bytes.empty();
  }

  /// Words that no healthy stream has.
  static std::size_t wrong(const EvtDecoder& decoder) { return decoder.counts().unknown + decoder.counts().outside; }

  /// Where bytes are missing, words begin at another place. Of each piece it takes the beginning that has fewest wrong
  /// words by far.
  void decode_in_pieces(ByteSpan bytes) {
    constexpr std::size_t kPiece = 1024, kLongestWord = 8, kByFar = 4;
    while (!bytes.empty()) {
      const ByteSpan piece = bytes.first(std::min(kPiece, bytes.size()));
      bytes = bytes.subspan(piece.size());
      EvtDecoder best = decoder_;
      std::vector<Event> best_events;
      best.decode(piece, best_events);
      std::size_t skipped = 0;
      for (std::size_t skip = 1; skip < std::min(kLongestWord, piece.size()); ++skip) {
        if (wrong(best) - wrong(decoder_) <= piece.size() / kBytesPerWrong) break;
        EvtDecoder trial = decoder_;
        std::vector<Event> events;
        trial.decode(piece.subspan(skip), events);
        if (kByFar * (wrong(trial) - wrong(decoder_)) > wrong(best) - wrong(decoder_)) continue;
        best = trial;
        best_events = std::move(events);
        skipped = skip;
      }
      // The place of the gap: its times may be wrong by whole turns of the counter.
      if (best.counts().unknown - decoder_.counts().unknown > piece.size() / kBytesPerWrong) {
        best.return_to(decoder_);
        best_events.clear();
      }
      if (skipped > 0) repairs_.add("file: bytes missing", fmt::format("{}: before byte {}", name_, at_));
      decoder_ = best;
      events_.insert(events_.end(), best_events.begin(), best_events.end());
    }
  }

  void count_left_out(const EvtDecoder::Counts& before, const EvtDecoder::Counts& now) {
    count_outside(now.outside - before.outside);
    repairs_.add("events: before the first time", name_ + ": events before the first time of the stream",
                 now.untimed - before.untimed);
    repairs_.add("events: unknown word", name_ + ": words of no known type", now.unknown - before.unknown);
    if (now.unknown > 1000 && now.unknown > decoded_ / 100)
      throw InputError::format(
          "{}: {} words are of no known type: the file is damaged or not of the encoding that its header names", name_,
          now.unknown);
  }

  /// As streams, in which a pulse counts once, with their mean period.
  void list_triggers() {
    info_.streams.clear();
    for (const auto& [channel, edges] : decoder_.triggers()) {
      const EvtDecoder::Edges& pulses = edges[edges[1].count >= edges[0].count ? 1 : 0];
      const double span_ms = 1e-3 * static_cast<double>(pulses.last_us - pulses.first_us);
      const std::string period =
          pulses.count > 1 ? fmt::format(", every {:.3f} ms", span_ms / static_cast<double>(pulses.count - 1)) : "";
      info_.streams.push_back({fmt::format("trigger {}", channel), "pulses" + period, pulses.count, ""});
    }
  }

  /// The end by the last block. Nothing if the counter may have wrapped before it (EVT 3: 17 s, DAT: 72 min).
  std::optional<Timestamp> last_stamp_of(const PropheseeHeader& header, cv::Size geometry) {
    if (header.format == EvtFormat::Evt3 || header.format == EvtFormat::Dat) return std::nullopt;
    const std::uint64_t blocks = (file_.size() - header.bytes) / kEventBlockBytes;
    std::vector<Event> events;
    EvtDecoder(header.format, geometry.width, geometry.height)
        .decode(file_.read(header.bytes + blocks * kEventBlockBytes, kEventBlockBytes), events);
    return events.empty() ? std::nullopt : std::optional(events.back().t + time_offset_);
  }

  BinaryFile file_;
  std::uint64_t at_;
  Duration time_offset_;
  EvtDecoder decoder_;
  std::vector<Event> events_;  // of the last block
  std::size_t decoded_ = 0;
};

/// Writes the header and the words of RAW and DAT files.
class EvtFileWriter final : public RecordingWriter {
 public:
  EvtFileWriter(const WriterSetup& setup, EvtFormat format)
      : name_(setup.path.string()),
        sensor_(setup.event_sensor()),
        format_(format),
        encoder_(format),
        file_(setup.path) {
    const int most = format == EvtFormat::Dat ? 1 << 14 : 1 << 11;
    if (sensor_.width > most || sensor_.height > most)
      throw InputError::format("{}: the format holds sensors of up to {} x {} px, this one has {} x {}", name_, most,
                               most, sensor_.width, sensor_.height);
  }

  void write(const EventBatch& batch) override {
    if (batch.events.empty()) return;
    if (file_.size() == 0) write_header(batch.events.front().t);
    if (format_ == EvtFormat::Dat) refuse_long_silence(batch.events);
    shifted_ = batch.events;
    for (Event& event : shifted_) event.t -= offset_;
    file_.write(encoder_.encode(shifted_));
  }

  void finish() override {
    if (file_.size() == 0) write_header(Timestamp());
    file_.flush();
  }

 private:
  void write_header(Timestamp first) {
    const unsigned counter_bits = format_ == EvtFormat::Dat ? 32 : 24;
    const std::int64_t offset_us = (to_ns(first) / 1000) >> counter_bits << counter_bits;
    offset_ = std::chrono::microseconds(offset_us);
    std::string text = format_ == EvtFormat::Dat
                           ? fmt::format("% Data file containing CD events.\n% Version 2\n% Height {}\n% Width {}\n",
                                         sensor_.height, sensor_.width)
                           : fmt::format("% evt 3.0\n% format EVT3;height={0};width={1}\n% geometry {1}x{0}\n",
                                         sensor_.height, sensor_.width);
    if (offset_us != 0) text += fmt::format("% {} {}\n", kTimeOffsetKey, offset_us);
    text += format_ == EvtFormat::Dat ? std::string("\x0c\x08") : std::string("% end\n");
    file_.write(text);
  }

  /// A step of more than half the range of the counter would decode as a step backwards.
  void refuse_long_silence(std::span<const Event> events) {
    constexpr Duration kLongest = std::chrono::microseconds(std::int64_t{7} << 28);
    for (const Event& event : events) {
      if (last_ && event.t - *last_ > kLongest)
        throw InputError::format(
            "{}: no events from {} to {} s: DAT cannot hold a gap of more than {:.0f} minutes; take raw", name_,
            format_seconds(*last_), format_seconds(event.t), to_seconds(kLongest) / 60);
      last_ = event.t;
    }
  }

  std::string name_;
  cv::Size sensor_;
  EvtFormat format_;
  EvtEncoder encoder_;
  OutputFile file_;
  Duration offset_{0};
  std::optional<Timestamp> last_;
  std::vector<Event> shifted_;
};

}  // namespace

bool is_prophesee_file(ByteSpan head) { return head.size() > 2 && head[0] == '%' && head[1] == ' '; }

Recording open_prophesee(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options) {
  const PropheseeHeader header = read_prophesee_header(BinaryFile(file).read(0, kHeaderBytes), file.string());
  return {std::make_unique<PropheseeDataset>(
              file, header, event_sensor_size(file, options.geometry ? options.geometry : header.geometry, rig)),
          std::nullopt};
}

std::unique_ptr<RecordingWriter> write_raw(const WriterSetup& setup) {
  return std::make_unique<EvtFileWriter>(setup, EvtFormat::Evt3);
}

std::unique_ptr<RecordingWriter> write_dat(const WriterSetup& setup) {
  return std::make_unique<EvtFileWriter>(setup, EvtFormat::Dat);
}

}  // namespace edged
