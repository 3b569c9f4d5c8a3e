// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The table IOHE with the xml text in it, and the tables EVTS, FRME and IMUS.
#include "edged/io/aedat/aedat4_dataset.hpp"

#include <spdlog/fmt/fmt.h>
#include <tinyxml2.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "edged/core/angles.hpp"
#include "edged/io/archive/compression.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

/// A stamp in microseconds. Throws Damage for a stamp out of range.
Timestamp stamp_of_us(std::int64_t us) {
  if (us < 0 || us > kMaxStampNs / 1000) throw Damage("a stamp out of range");
  return timestamp_from_ns(us * 1000);
}

/// The middle of the exposure if its begin and end are given, else the stamp of the frame.
Timestamp frame_stamp(const FlatTable& frame) {
  const auto begin = frame.number<std::int64_t>(aedat4::kExposureBegin),
             end = frame.number<std::int64_t>(aedat4::kExposureEnd);
  return stamp_of_us(begin > 0 && end >= begin ? begin + (end - begin) / 2
                                               : frame.number<std::int64_t>(aedat4::kStamp));
}

cv::Mat grey_image(const FlatTable& frame) {
  const int width = frame.number<std::int16_t>(aedat4::kWidth), height = frame.number<std::int16_t>(aedat4::kHeight);
  const int type = frame.number<std::int8_t>(aedat4::kType);  // OpenCV's own numbers
  const ByteSpan pixels = frame.bytes(aedat4::kPixels);
  if (width <= 0 || height <= 0 || (type != CV_8UC1 && type != CV_8UC3 && type != CV_8UC4) ||
      pixels.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * CV_ELEM_SIZE(type))
    throw Damage("an image of an invalid size or type");
  // cv::Mat wants a mutable pointer, but is only read from.
  const cv::Mat image(height, width, type, const_cast<std::uint8_t*>(pixels.data()));
  if (type == CV_8UC1) return image.clone();
  cv::Mat grey;
  cv::cvtColor(image, grey, type == CV_8UC3 ? cv::COLOR_BGR2GRAY : cv::COLOR_BGRA2GRAY);
  return grey;
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

std::vector<Aedat4Stream> parse_streams(const tinyxml2::XMLElement* dv) {
  const auto* list = child_named(dv, "node", "outInfo", "name");
  std::vector<Aedat4Stream> streams;
  for (const auto* s = list ? list->FirstChildElement("node") : nullptr; s; s = s->NextSiblingElement("node")) {
    const auto* info = child_named(s, "node", "info", "name");
    streams.push_back({s->IntAttribute("name", -1), attribute_text(s, "typeIdentifier"),
                       attribute_text(s, "originalOutputName"), attribute_text(info, "source"),
                       parse_geometry(attribute_text(info, "sizeX") + "x" + attribute_text(info, "sizeY"))});
  }
  return streams;
}

/// The streams as topics. Those of the same name are distinguished by their source, then by their number.
std::vector<Topic> topics_of(const std::vector<Aedat4Stream>& streams) {
  std::vector<Topic> topics;
  for (const Aedat4Stream& s : streams) {
    Topic& topic = topics.emplace_back();
    topic.name = s.name.empty() ? s.type : s.name;
    topic.type = s.type;
    topic.count = 1;
  }
  const auto distinguish = [&](const auto& addition) {
    std::vector<std::string> names;
    for (const Topic& topic : topics) names.push_back(topic.name);
    for (std::size_t i = 0; i < topics.size(); ++i)
      if (std::ranges::count(names, names[i]) > 1) topics[i].name += addition(streams[i]);
  };
  distinguish([](const Aedat4Stream& s) { return "@" + s.source; });
  distinguish([](const Aedat4Stream& s) { return fmt::format("#{}", s.number); });
  return topics;
}

}  // namespace

Aedat4Header parse_aedat4_header(ByteSpan buffer) {
  const FlatTable table(buffer);
  const std::string_view xml = as_text(table.bytes(aedat4::kXml));
  tinyxml2::XMLDocument document;
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS) throw Damage("its xml cannot be read");
  const tinyxml2::XMLElement* dv = document.FirstChildElement("dv");
  const auto number = static_cast<std::uint32_t>(table.number<std::int32_t>(aedat4::kCompression));
  if (number >= kAedat4Compressions.size()) throw Damage("unknown compression");
  Aedat4Header header{kAedat4Compressions[number].method, table.number<std::int64_t>(aedat4::kTableAt, -1),
                      parse_streams(dv)};
  if (const std::string frame = attribute_text(dv, kAedat4PoseFrame); !frame.empty()) header.pose_frame = frame;
  return header;
}

Aedat4PacketHead parse_packet_head(ByteSpan head, const std::vector<Aedat4Stream>& streams) {
  Aedat4PacketHead packet{number_at<std::int32_t>(head, 0), number_at<std::int32_t>(head, 4), std::nullopt};
  const auto known = std::ranges::find(streams, packet.number, &Aedat4Stream::number);
  if (known != streams.end() && packet.bytes > 0) packet.stream = static_cast<std::size_t>(known - streams.begin());
  return packet;
}

void Aedat4Dataset::choose(const std::vector<Aedat4Stream>& streams, const Rig* rig, const RecordingOptions& options) {
  const std::vector<Topic> topics = topics_of(streams);
  choice_ = choose_topics(topics, wishes_of(rig, options), name_);
  cameras_ = choice_.recorded(topics);
  info_.streams = choice_.streams(topics);
  for (StreamInfo& stream : info_.streams) stream.count = 0;  // unknown
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    RecordedCamera& camera = cameras_[i];
    const std::size_t stream = choice_.cameras[i].topic;
    if (camera.modality != Modality::Events) continue;
    const auto stated = options.geometry ? options.geometry : streams[stream].geometry;
    camera.sensor = event_sensor_size(name_, stated, rig, camera.name);
    if (choice_.camera_of(stream)->camera == 0) set_sensor(camera.sensor);
  }
}

void Aedat4Dataset::set_pose_frame(const std::string& name) {
  info_.pose_frame = camera_by_usual_name(choice_.known, name).value_or(name);
}

bool Aedat4Dataset::reads(std::size_t stream) const {
  if (const auto camera = choice_.camera_of(stream)) return wants(camera->modality);
  return choice_.of(Role::Imu) == stream;
}

void Aedat4Dataset::take_packet(std::size_t stream, std::string_view compression, ByteSpan packed,
                                const std::string& place) {
  try {
    const Decompressed body = decompress(compression, packed, kMostPacketBytes);
    if (!body.whole) throw Damage("cannot be unpacked");
    const auto camera = choice_.camera_of(stream);
    if (!camera) return take_imu(flat_buffer(body.bytes, "IMUS"));
    if (camera->modality == Modality::Events) return take_events(camera->camera, flat_buffer(body.bytes, "EVTS"));
    take_frame(camera->camera, flat_buffer(body.bytes, "FRME"));
  } catch (const Damage& damage) {
    repairs_.add("file: packet unreadable", fmt::format("{}: packet {}: {}", name_, place, damage.what()));
  }
}

void Aedat4Dataset::take_events(std::size_t camera, ByteSpan buffer) {
  constexpr std::size_t kEventBytes = 16;
  const FlatVector list = FlatTable(buffer).vector(aedat4::kItems, kEventBytes);
  std::vector<Event> events;
  events.reserve(list.count);
  for (ByteReader reader(buffer.subspan(list.at, list.count * kEventBytes)); reader.left() > 0;) {
    const Timestamp t = stamp_of_us(reader.number<std::int64_t>());
    const auto x = reader.number<std::int16_t>(), y = reader.number<std::int16_t>();
    const bool on = reader.number<std::uint8_t>() != 0;
    reader.take(3);
    // Negative coordinates become large, which lies outside any sensor.
    events.push_back({t, static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), on});
  }
  push_events(events, camera);
}

void Aedat4Dataset::take_frame(std::size_t camera, ByteSpan buffer) {
  const FlatTable frame(buffer);
  push_frame(frame_stamp(frame), grey_image(frame), camera);
}

void Aedat4Dataset::take_imu(ByteSpan buffer) {
  const FlatTable packet(buffer);
  const FlatVector list = packet.vector(aedat4::kItems, 4);
  for (std::size_t i = 0; i < list.count; ++i) {
    const FlatTable sample = packet.table(list, i);
    const auto three = [&sample](unsigned first) {
      const Eigen::Vector3d v(sample.number<float>(first), sample.number<float>(first + 1),
                              sample.number<float>(first + 2));
      if (!v.allFinite()) throw Damage("an IMU sample that is not finite");
      return v;
    };
    push_imu({stamp_of_us(sample.number<std::int64_t>(aedat4::kImuStamp)), three(aedat4::kGyro) * kDegree,
              three(aedat4::kAccel) * kStandardGravity});
  }
}

}  // namespace edged
