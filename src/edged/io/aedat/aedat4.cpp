// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The container (header, packets, table at the end) and what its packets hold.
#include "edged/io/aedat/aedat4.hpp"

#include <spdlog/spdlog.h>
#include <tinyxml2.h>

#include <algorithm>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "edged/core/check.hpp"
#include "edged/io/aedat/flat_table.hpp"
#include "edged/io/compression.hpp"
#include "edged/io/formats.hpp"
#include "edged/io/streamed_dataset.hpp"
#include "edged/io/text.hpp"

namespace edged {
namespace {

constexpr std::string_view kAedat4Magic = "#!AER-DAT4.0\r\n";
constexpr std::size_t kMostPacketBytes = std::size_t{1} << 28U;
constexpr double kStandardGravity = 9.80665;  // [m/s^2]: what the files call g

/// What the header says.
struct Aedat4Header {
  std::string_view compression;
  std::int64_t table_at = -1;                       ///< of the table at the end; -1: the recording did not end
  std::uint64_t packets_at = 0;                     ///< of the first packet
  std::optional<std::int32_t> events, frames, imu;  ///< numbers of the streams to read
  std::optional<cv::Size> geometry;                 ///< of the event sensor
};

std::string_view aedat4_compression(std::int32_t number) {
  switch (number) {
    case 0:
      return "none";
    case 1:
    case 2:
      return "lz4";
    case 3:
    case 4:
      return "zstd";
    default:
      throw Damage("compression of unknown number");
  }
}

const tinyxml2::XMLElement* child_named(const tinyxml2::XMLElement* parent, const char* kind, const char* name,
                                        const char* attribute) {
  for (const auto* e = parent ? parent->FirstChildElement(kind) : nullptr; e; e = e->NextSiblingElement(kind))
    if (e->Attribute(attribute, name)) return e;
  return nullptr;
}

/// The text of `<attr key="KEY">`; "" where there is none.
std::string attribute_text(const tinyxml2::XMLElement* node, const char* key) {
  const auto* e = child_named(node, "attr", key, "key");
  return e && e->GetText() ? e->GetText() : "";
}

/// Streams by type, the first of each, from the xml text of the header.
void read_streams(std::string_view xml, const std::string& file, Aedat4Header& header) {
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS) throw Damage("its xml cannot be read");
  const auto* streams = child_named(document.FirstChildElement("dv"), "node", "outInfo", "name");
  for (const auto* s = streams ? streams->FirstChildElement("node") : nullptr; s; s = s->NextSiblingElement("node")) {
    const std::string type = attribute_text(s, "typeIdentifier");
    std::optional<std::int32_t>* place = type == "EVTS"   ? &header.events
                                         : type == "FRME" ? &header.frames
                                         : type == "IMUS" ? &header.imu
                                                          : nullptr;
    if (!place) continue;
    if (*place) {
      spdlog::warn("{}: holds several streams of type {}; the first is read", file, type);
      continue;
    }
    *place = s->IntAttribute("name", -1);
    if (type != "EVTS") continue;
    const auto* info = child_named(s, "node", "info", "name");
    header.geometry = parse_geometry(attribute_text(info, "sizeX") + "x" + attribute_text(info, "sizeY"));
  }
}

Aedat4Header read_aedat4_header(BinaryFile& file, const std::string& name) try {
  Aedat4Header header;
  const Bytes length = file.read(kAedat4Magic.size(), 4);
  const auto bytes = number_at<std::uint32_t>(length, 0);
  if (bytes > kMostPacketBytes) throw Damage("ends too early");
  const Bytes buffer = file.read(kAedat4Magic.size() + 4, bytes);
  if (buffer.size() < bytes) throw Damage("ends too early");
  const FlatTable table{ByteSpan(buffer)};
  header.compression = aedat4_compression(table.number<std::int32_t>(0));
  header.table_at = table.number<std::int64_t>(1, -1);
  header.packets_at = kAedat4Magic.size() + 4 + bytes;
  read_streams(as_text(table.bytes(2)), name, header);
  if (!header.events && !header.frames && !header.imu)
    throw InputError::format("{}: nothing to read: its header names no events, frames or IMU", name);
  return header;
} catch (const Damage& damage) {
  throw InputError::format("{}: the header is damaged: {}", name, damage.what());
}

/// Of microseconds. Throws Damage for what no recording reaches.
Timestamp stamp_of_us(std::int64_t us) {
  if (us < 0 || us > kMaxStampNs / 1000) throw Damage("a stamp that cannot be");
  return timestamp_from_ns(us * 1000);
}

/// The middle of the exposure: said by its ends, else by the stamp of the frame.
Timestamp frame_stamp(const FlatTable& frame) {
  const auto begin = frame.number<std::int64_t>(3), end = frame.number<std::int64_t>(4);
  return stamp_of_us(begin > 0 && end >= begin ? begin + (end - begin) / 2 : frame.number<std::int64_t>(0));
}

cv::Mat grey_image(const FlatTable& frame) {
  const int width = frame.number<std::int16_t>(6), height = frame.number<std::int16_t>(7);
  const int type = frame.number<std::int8_t>(5);  // OpenCV's own numbers
  const ByteSpan pixels = frame.bytes(10);
  if (width <= 0 || height <= 0 || (type != CV_8UC1 && type != CV_8UC3 && type != CV_8UC4) ||
      pixels.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * CV_ELEM_SIZE(type))
    throw Damage("an image that cannot be");
  // cv::Mat wants a mutable pointer, but is only read from.
  const cv::Mat image(height, width, type, const_cast<std::uint8_t*>(pixels.data()));
  if (type == CV_8UC1) return image.clone();
  cv::Mat grey;
  cv::cvtColor(image, grey, type == CV_8UC3 ? cv::COLOR_BGR2GRAY : cv::COLOR_BGRA2GRAY);
  return grey;
}

class Aedat4Dataset final : public StreamedDataset {
 public:
  Aedat4Dataset(const std::filesystem::path& file, BinaryFile bytes, const Aedat4Header& header, cv::Size geometry)
      : StreamedDataset(file, "aedat4"),
        file_(std::move(bytes)),
        header_(header),
        at_(header.packets_at),
        end_(file_.size()) {
    set_sensor(geometry);
    read_table();
    begin({header.events.has_value(), header.frames.has_value(), header.imu.has_value()});
  }

 private:
  /// The end of the recording and of its packets. An interrupted recording has no table and is read to its end.
  void read_table() try {
    if (header_.table_at < 0 || static_cast<std::uint64_t>(header_.table_at) >= file_.size())
      throw Damage("is missing: the recording was interrupted");
    end_ = static_cast<std::uint64_t>(header_.table_at);
    if (file_.size() - end_ > kMostPacketBytes) throw Damage("is too long");
    const Bytes packed = file_.read(end_, static_cast<std::size_t>(file_.size() - end_));
    const Decompressed table = decompress(header_.compression, packed, kMostPacketBytes);
    const FlatTable root(without_length(table.bytes, "FTAB"));
    const FlatVector packets = root.vector(0, 4);
    std::int64_t last_us = 0;
    for (std::size_t i = 0; i < packets.count; ++i)
      last_us = std::max(last_us, root.table(packets, i).number<std::int64_t>(4));
    if (last_us > 0) info_.end = stamp_of_us(last_us);
  } catch (const Damage& damage) {
    repairs_.add("file: no table", fmt::format("{}: the table at its end {}; read without it", name_, damage.what()));
  }

  /// False at the end of the file, or where what follows is no packet.
  bool read_on() override {
    if (at_ >= end_) return false;
    const Bytes head = file_.read(at_, 8);
    const auto cut = [this] {
      repairs_.add("file: cut", fmt::format("{}: no whole packet at byte {}; what follows is not read", name_, at_));
      return false;
    };
    if (head.size() < 8) return cut();
    const auto stream = number_at<std::int32_t>(head, 0), bytes = number_at<std::int32_t>(head, 4);
    if (bytes < 0 || static_cast<std::uint64_t>(bytes) > end_ - at_ - 8) return cut();
    const std::uint64_t begin = at_ + 8;
    at_ = begin + static_cast<std::uint64_t>(bytes);
    if (stream != header_.events && stream != header_.frames && stream != header_.imu) return true;
    try {
      const Decompressed body =
          decompress(header_.compression, file_.read(begin, static_cast<std::size_t>(bytes)), kMostPacketBytes);
      if (!body.whole) throw Damage("cannot be unpacked");
      if (stream == header_.events) take_events(without_length(body.bytes, "EVTS"));
      if (stream == header_.frames) {
        const FlatTable frame(without_length(body.bytes, "FRME"));
        push_frame(frame_stamp(frame), grey_image(frame));
      }
      if (stream == header_.imu) take_imu(FlatTable(without_length(body.bytes, "IMUS")));
    } catch (const Damage& damage) {
      repairs_.add("file: packet unreadable", fmt::format("{}: packet at byte {}: {}", name_, begin, damage.what()));
    }
    return true;
  }

  /// The buffer behind its length. Throws Damage when it is not of this type.
  static ByteSpan without_length(const Bytes& bytes, std::string_view type) {
    ByteReader reader(bytes);
    const auto length = reader.number<std::uint32_t>();
    const ByteSpan buffer = reader.take(length);
    if (flat_identifier(buffer) != type) throw Damage("is not of the type of its stream");
    return buffer;
  }

  void take_events(ByteSpan buffer) {
    constexpr std::size_t kEventBytes = 16;
    const FlatVector list = FlatTable(buffer).vector(0, kEventBytes);
    std::vector<Event> events;
    events.reserve(list.count);
    for (ByteReader reader(buffer.subspan(list.at, list.count * kEventBytes)); reader.left() > 0;) {
      const Timestamp t = stamp_of_us(reader.number<std::int64_t>());
      const auto x = reader.number<std::int16_t>(), y = reader.number<std::int16_t>();
      const bool on = reader.number<std::uint8_t>() != 0;
      reader.take(3);
      // Negative ones become large, and so lie outside of any sensor.
      events.push_back({t, static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), on});
    }
    push_events(std::move(events));
  }

  void take_imu(const FlatTable& packet) {
    constexpr double kRadPerDeg = std::numbers::pi / 180;
    const FlatVector list = packet.vector(0, 4);
    for (std::size_t i = 0; i < list.count; ++i) {
      const FlatTable sample = packet.table(list, i);
      const auto three = [&sample](unsigned first) {
        const Eigen::Vector3d v(sample.number<float>(first), sample.number<float>(first + 1),
                                sample.number<float>(first + 2));
        if (!v.allFinite()) throw Damage("an IMU sample that is no number");
        return v;
      };
      push_imu({stamp_of_us(sample.number<std::int64_t>(0)), three(5) * kRadPerDeg, three(2) * kStandardGravity});
    }
  }

  BinaryFile file_;
  Aedat4Header header_;
  std::uint64_t at_, end_;  ///< of the next packet; behind the last
};

}  // namespace

bool is_aedat4(ByteSpan head) { return as_text(head).starts_with(kAedat4Magic); }

Recording open_aedat4(const std::filesystem::path& file, const Rig* rig, std::optional<cv::Size> geometry) {
  BinaryFile bytes(file);
  const Aedat4Header header = read_aedat4_header(bytes, file.string());
  cv::Size size;
  if (header.events) size = event_sensor_size(file, geometry ? geometry : header.geometry, rig);
  return {std::make_unique<Aedat4Dataset>(file, std::move(bytes), header, size), std::nullopt};
}

}  // namespace edged
