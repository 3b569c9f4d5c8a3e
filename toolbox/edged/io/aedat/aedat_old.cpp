// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The header lines of AEDAT 2.0 and 3.1 files, and AEDAT 3.1: packets of items of one kind, little-endian.
#include "edged/io/aedat/aedat_old.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <vector>

#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/io/aedat/aedat.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/core/streamed_dataset.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr std::string_view kOldAedatMagic = "#!AER-DAT";
constexpr std::string_view kHeaderEnd = "#!END-HEADER";
constexpr std::size_t kMostOldHeaderBytes = std::size_t{8} << 20U;  // jAER writes all its preferences into the header

struct ChipSize {
  std::string_view name;  ///< first letters of the name, in lower case
  int width, height;
};
constexpr std::array kChips = {ChipSize{"davis128", 128, 128}, ChipSize{"davis208", 208, 192},
                               ChipSize{"davis240", 240, 180}, ChipSize{"davis346", 346, 260},
                               ChipSize{"davis640", 640, 480}, ChipSize{"dvs128", 128, 128}};

/// The text line that starts at `at`. Nothing if the data begin there.
std::optional<std::string_view> text_line(std::string_view text, std::size_t at) {
  const std::size_t end = text.find('\n', at);
  if (at >= text.size() || text[at] != '#' || end == std::string_view::npos) return std::nullopt;
  const std::string_view line = text.substr(at, end - at);
  const bool printable = std::ranges::all_of(line, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x20 || c == '\t' || c == '\r';
  });
  return printable ? std::optional(line) : std::nullopt;
}

/// The number at the end of `key="ImuGyroScale" value="GyroFullScaleDegPerSec1000"`.
std::optional<double> full_scale(std::string_view line, std::string_view key) {
  if (line.find(key) == std::string_view::npos) return std::nullopt;
  const std::size_t end = line.rfind('"');
  if (end == std::string_view::npos) return std::nullopt;
  const std::size_t before = line.substr(0, end).find_last_not_of("0123456789");
  return parse_number(line.substr(before + 1, end - before - 1));
}

void take_chip(std::string_view name, OldAedatHeader& header) {
  header.chip = FieldReader(name.substr(name.rfind('.') + 1)).next();  // without the package of the class
  const std::string lower = lower_case(header.chip);
  for (const ChipSize& chip : kChips)
    if (lower.starts_with(chip.name)) header.sensor = cv::Size(chip.width, chip.height);
}

/// head: the first bytes of a file. Throws Damage if they contain no line end.
OldAedatHeader parse_old_aedat_header(ByteSpan head) {
  const std::string_view text = as_text(head);
  OldAedatHeader header;
  while (const auto line = text_line(text, header.bytes)) {
    header.bytes += line->size() + 1;
    if (header.version.empty()) header.version = FieldReader(line->substr(kOldAedatMagic.size())).next();
    if (line->starts_with(kHeaderEnd)) break;
    constexpr std::string_view kChip = "AEChip:", kSource = "#Source ";
    if (const std::size_t at = line->find(kChip); at != std::string_view::npos && header.chip.empty())
      take_chip(line->substr(at + kChip.size()), header);
    if (const std::size_t at = line->find(':'); line->starts_with(kSource) && at != std::string_view::npos)
      if (header.chip.empty()) take_chip(line->substr(at + 1), header);
    // Sensitivities of InvenSense's data sheets: 131 LSB per deg/s at 250 deg/s, 16384 LSB per g at 2 g.
    if (const auto dps = full_scale(*line, "\"ImuGyroScale\""); dps && *dps > 0)
      header.gyro_lsb_per_dps = 131.0 * 250.0 / *dps;
    if (const auto g = full_scale(*line, "\"ImuAccelScale\""); g && *g > 0) header.accel_lsb_per_g = 32768.0 / *g;
  }
  if (header.bytes == 0) throw Damage("ends in its first line");
  return header;
}

constexpr std::size_t kPacketHead = 28;
constexpr std::uint64_t kMostBody = std::uint64_t{1} << 28U;

enum Aedat3Kind : std::int16_t { kPolarity = 1, kFrame = 2, kImu6 = 3, kImu9 = 4 };

struct Aedat3Packet {
  std::int16_t kind = 0, source = 0;
  std::int32_t item_bytes = 0, overflows = 0, count = 0;
  std::uint64_t body_bytes() const {
    return static_cast<std::uint64_t>(item_bytes) * static_cast<std::uint64_t>(count);
  }
};

/// Throws Damage for a header that no packet has.
Aedat3Packet packet_head(ByteSpan bytes) {
  ByteReader reader(bytes);
  Aedat3Packet head;
  head.kind = reader.number<std::int16_t>();
  head.source = reader.number<std::int16_t>();
  head.item_bytes = reader.number<std::int32_t>();
  reader.number<std::int32_t>();  // offset of the stamp in an item: given by the kind
  head.overflows = reader.number<std::int32_t>();
  reader.number<std::int32_t>();  // capacity in memory
  head.count = reader.number<std::int32_t>();
  const auto valid = reader.number<std::int32_t>();
  if (head.kind < 0 || head.item_bytes <= 0 || head.overflows < 0 || head.count < 0 || valid < 0 ||
      valid > head.count || head.body_bytes() > kMostBody)
    throw Damage("not a valid packet header");
  return head;
}

class Aedat3File final : public StreamedDataset {
 public:
  Aedat3File(const std::filesystem::path& file, const OldAedatHeader& header, cv::Size sensor)
      : StreamedDataset(file, "aedat3"), file_(file), at_(header.bytes) {
    set_sensor(sensor);
    begin(streams_there(header.bytes));
  }

 private:
  /// Determined from the first packet headers. The first source with events is read.
  OneOfEach streams_there(std::uint64_t at) try {
    constexpr int kFirstHeads = 1000;
    OneOfEach streams;
    for (int i = 0; i < kFirstHeads && at < file_.size(); ++i) {
      const Aedat3Packet head = packet_head(file_.read(at, kPacketHead));
      at += kPacketHead + head.body_bytes();
      if (!source_ && head.kind == kPolarity) source_ = head.source;
      streams.events = streams.events || head.kind == kPolarity;
      streams.frames = streams.frames || head.kind == kFrame;
      streams.imu = streams.imu || head.kind == kImu6 || head.kind == kImu9;
    }
    return streams;
  } catch (const Damage&) {
    return {true, true, true};  // read_on() counts the damage
  }

  bool read_on() override {
    if (at_ >= file_.size()) return false;
    try {
      const Aedat3Packet head = packet_head(file_.read(at_, kPacketHead));
      const Bytes body = file_.read(at_ + kPacketHead, static_cast<std::size_t>(head.body_bytes()));
      at_ += kPacketHead + head.body_bytes();
      if (body.size() < head.body_bytes()) repairs_.add("file: cut", name_ + ": the file ends within a packet");
      take(head, body);
      return true;
    } catch (const Damage& damage) {
      repairs_.add("file: cut", fmt::format("{}: byte {}: {}; the rest is not read", name_, at_, damage.what()));
      return false;
    }
  }

  void take(const Aedat3Packet& head, ByteSpan body) {
    if (source_ && head.source != *source_)
      return repairs_.add("file: packet of another camera", name_ + ": has several cameras; the first is read");
    const auto bytes = static_cast<std::size_t>(head.item_bytes);
    std::vector<Event> events;
    for (; body.size() >= bytes; body = body.subspan(bytes)) {
      try {
        ByteReader item(body.first(bytes));
        if (head.kind == kPolarity) take_event(item, head.overflows, events);
        if (head.kind == kFrame && wants(Modality::Frames)) take_frame(item, head.overflows);
        if (head.kind == kImu6 || head.kind == kImu9) take_imu(item, head.overflows);
      } catch (const Damage& damage) {
        repairs_.add("file: packet unreadable", fmt::format("{}: before byte {}: {}", name_, at_, damage.what()));
      }
    }
    push_events(events);
  }

  /// Microseconds of 31 bits, and the number of their overflows.
  static Timestamp stamp_of(std::int32_t overflows, std::int32_t us) {
    const std::int64_t all_us = (std::int64_t{overflows} << 31U) + us;
    if (us < 0 || all_us > kMaxStampNs / 1000) throw Damage("a stamp out of range");
    return timestamp_from_ns(all_us * 1000);
  }

  /// Bit 0 is set for a valid item.
  static void take_event(ByteReader& item, std::int32_t overflows, std::vector<Event>& events) {
    const auto data = item.number<std::uint32_t>();
    const Timestamp t = stamp_of(overflows, item.number<std::int32_t>());
    if ((data & 1U) != 0)
      events.push_back({t, static_cast<std::uint16_t>(data >> 17U), static_cast<std::uint16_t>(data >> 2U & 0x7FFFU),
                        (data >> 1U & 1U) != 0});
  }

  void take_imu(ByteReader& item, std::int32_t overflows) {
    const bool valid = (item.number<std::uint32_t>() & 1U) != 0;
    const Timestamp t = stamp_of(overflows, item.number<std::int32_t>());
    std::array<float, 6> v{};
    for (float& x : v) x = item.number<float>();
    const Eigen::Vector3d accel(v[0], v[1], v[2]), gyro(v[3], v[4], v[5]);
    if (!accel.allFinite() || !gyro.allFinite()) throw Damage("an IMU sample that is not finite");
    if (valid) push_imu({t, gyro * kDegree, accel * kStandardGravity});
  }

  /// Uses the upper 8 of 16 bits of each pixel. The stamp is the middle of the exposure.
  void take_frame(ByteReader& item, std::int32_t overflows) {
    const auto info = item.number<std::uint32_t>();
    item.take(8);  // begin and end of the frame
    const auto begin = item.number<std::int32_t>(), end = item.number<std::int32_t>();
    const auto width = item.number<std::int32_t>(), height = item.number<std::int32_t>();
    item.take(8);  // position of the frame on the sensor
    const unsigned channels = info >> 1U & 7U;
    if ((info & 1U) == 0) return;
    if (width <= 0 || height <= 0 || width > 65535 || height > 65535 ||
        (channels != 1 && channels != 3 && channels != 4))
      throw Damage("an image of an invalid size");
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    const ByteSpan levels = item.take(2 * channels * pixels);
    cv::Mat image(height, width, CV_8UC1);
    for (std::size_t i = 0; i < pixels; ++i) {
      unsigned sum = 0;  // of the colours, without transparency
      const unsigned colours = std::min(channels, 3U);
      for (std::size_t c = 0; c < colours; ++c) sum += levels[2 * (channels * i + c) + 1];
      image.data[i] = static_cast<std::uint8_t>(sum / colours);
    }
    push_frame(stamp_of(overflows, begin + (end - begin) / 2), std::move(image));
  }

  BinaryFile file_;
  std::uint64_t at_;
  std::optional<std::int16_t> source_;
};

Recording open_aedat3(const std::filesystem::path& file, const OldAedatHeader& header, cv::Size sensor) {
  return {std::make_unique<Aedat3File>(file, header, sensor), std::nullopt};
}

}  // namespace

bool is_old_aedat(ByteSpan head) {
  const std::string_view text = as_text(head);
  return text.starts_with(kOldAedatMagic) && !text.starts_with("#!AER-DAT4");
}

Recording open_old_aedat(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options) try {
  const OldAedatHeader header = parse_old_aedat_header(BinaryFile(file).read(0, kMostOldHeaderBytes));
  const bool two = header.version == "2.0", three = header.version == "3.1";
  if (!two && !three)
    throw InputError::format("{}: AEDAT {} is not read; 2.0, 3.1 and 4 are: convert it with DV", file.string(),
                             header.version);
  if (two && !lower_case(header.chip).starts_with("davis"))
    throw InputError::format("{}: AEDAT 2.0 of the camera `{}` is not read, only of a DAVIS: convert it with DV",
                             file.string(), header.chip.empty() ? "(not named)" : header.chip);
  const cv::Size sensor = event_sensor_size(file, options.geometry ? options.geometry : header.sensor, rig);
  return two ? open_aedat2(file, header, sensor) : open_aedat3(file, header, sensor);
} catch (const Damage& damage) {
  throw InputError::format("{}: the header is damaged: {}", file.string(), damage.what());
}

}  // namespace edged
