// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The tables EVTS, FRME and IMUS.
#include "edged/io/aedat/aedat4_dataset.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "edged/core/angles.hpp"
#include "edged/io/aedat/flat_table.hpp"
#include "edged/io/archive/compression.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/core/geometry.hpp"
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

}  // namespace

void Aedat4Dataset::choose(const std::vector<Aedat4Stream>& streams, const Rig* rig, const RecordingOptions& options) {
  const std::vector<Topic> topics = topics_of(streams);
  choice_ = choose_topics(topics, wishes_of(rig, options), name_);
  cameras_ = choice_.recorded(topics);
  for (std::size_t i = 0; i < topics.size(); ++i) info_.streams.push_back({topics[i].name, topics[i].type, 0, ""});
  if (const auto imu = choice_.of(Role::Imu)) info_.streams[*imu].role = "imu";
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    RecordedCamera& camera = cameras_[i];
    const std::size_t stream = choice_.cameras[i].topic;
    const bool several = std::ranges::count(cameras_, camera.modality, &RecordedCamera::modality) > 1;
    info_.streams[stream].role = several ? camera.name : kind_name(camera.modality);
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
