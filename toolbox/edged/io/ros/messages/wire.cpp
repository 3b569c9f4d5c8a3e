// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Definitions differ between ROS 1 and ROS 2 in headers, times and the names of a few fields.
#include "edged/io/ros/messages/wire.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;

struct Fields {
  std::string_view type;
  std::string_view md5;  ///< only of types that are messages of a topic
  /// Types, each with the names of its fields, separated by "; ". `HEADER` is the field std_msgs/Header header, `time`
  /// the type of stamps.
  std::string_view fields;
};

constexpr std::array kFields = {
    Fields{"builtin_interfaces/Time", "", "int32 sec; uint32 nanosec"},
    Fields{"geometry_msgs/Quaternion", "", "float64 x y z w"},
    Fields{"geometry_msgs/Vector3", "", "float64 x y z"},
    Fields{"geometry_msgs/Transform", "", "geometry_msgs/Vector3 translation; geometry_msgs/Quaternion rotation"},
    Fields{"geometry_msgs/TransformStamped", "b5764a33bfeb3588febc2682852579b0",
           "HEADER; string child_frame_id; geometry_msgs/Transform transform"},
    Fields{"geometry_msgs/Point", "", "float64 x y z"},
    Fields{"geometry_msgs/Pose", "", "geometry_msgs/Point position; geometry_msgs/Quaternion orientation"},
    Fields{"geometry_msgs/PoseStamped", "", "HEADER; geometry_msgs/Pose pose"},
    Fields{"geometry_msgs/PoseWithCovariance", "", "geometry_msgs/Pose pose; float64[36] covariance"},
    Fields{"geometry_msgs/PoseWithCovarianceStamped", "953b798c0f514ff060a53a3498ce6246",
           "HEADER; geometry_msgs/PoseWithCovariance pose"},
    Fields{"geometry_msgs/Twist", "", "geometry_msgs/Vector3 linear angular"},
    Fields{"geometry_msgs/TwistWithCovariance", "", "geometry_msgs/Twist twist; float64[36] covariance"},
    Fields{"nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7",
           "HEADER; string child_frame_id; geometry_msgs/PoseWithCovariance pose; "
           "geometry_msgs/TwistWithCovariance twist"},
    Fields{"nav_msgs/MapMetaData", "",
           "time map_load_time; float32 resolution; uint32 width height; geometry_msgs/Pose origin"},
    Fields{"nav_msgs/OccupancyGrid", "3381f2d731d4076ec5c71b0759edbe4e",
           "HEADER; nav_msgs/MapMetaData info; int8[] data"},
    Fields{"octomap_msgs/Octomap", "9a45536b45c5e409cd49f04bb2d9999f",
           "HEADER; bool binary; string id; float64 resolution; int8[] data"},
    Fields{"nav_msgs/Path", "6227e2b7e9cce15051f669a5e197bbf7", "HEADER; geometry_msgs/PoseStamped[] poses"},
    Fields{"tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec", "geometry_msgs/TransformStamped[] transforms"},
    Fields{"diagnostic_msgs/KeyValue", "", "string key value"},
    Fields{"diagnostic_msgs/DiagnosticStatus", "",
           "byte OK=0 WARN=1 ERROR=2 STALE=3 level; string name message hardware_id; "
           "diagnostic_msgs/KeyValue[] values"},
    Fields{"diagnostic_msgs/DiagnosticArray", "60810da900de1dd6ddd437c3503511da",
           "HEADER; diagnostic_msgs/DiagnosticStatus[] status"},
    Fields{"sensor_msgs/PointField", "",
           "uint8 INT8=1 UINT8=2 INT16=3 UINT16=4 INT32=5 UINT32=6 FLOAT32=7 FLOAT64=8; string name; uint32 offset; "
           "uint8 datatype; uint32 count"},
    Fields{"sensor_msgs/PointCloud2", "1158d486dd51d683ce2f1be655c3c181",
           "HEADER; uint32 height width; sensor_msgs/PointField[] fields; bool is_bigendian; "
           "uint32 point_step row_step; uint8[] data; bool is_dense"},
    Fields{"dvs_msgs/Event", "", "uint16 x y; time ts; bool polarity"},
    Fields{"dvs_msgs/EventArray", "5e8beee5a6c107e504c2e78903c224b8",
           "HEADER; uint32 height width; dvs_msgs/Event[] events"},
    Fields{"prophesee_event_msgs/Event", "", "uint16 x y; time ts; bool polarity"},
    Fields{"prophesee_event_msgs/EventArray", "5e8beee5a6c107e504c2e78903c224b8",
           "HEADER; uint32 height width; prophesee_event_msgs/Event[] events"},
    Fields{"event_camera_msgs/EventPacket", "8a6101b351a64529ac77bd8b71074e52",
           "HEADER; uint32 height width; uint64 seq time_base; string encoding; bool is_bigendian; uint8[] events"},
    Fields{"sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743",
           "HEADER; uint32 height width; string encoding; uint8 is_bigendian; uint32 step; uint8[] data"},
    Fields{"sensor_msgs/Imu", "6a62c6daae103f4ff57a132d6f95cec2",
           "HEADER; geometry_msgs/Quaternion orientation; float64[9] orientation_covariance; "
           "geometry_msgs/Vector3 angular_velocity; float64[9] angular_velocity_covariance; "
           "geometry_msgs/Vector3 linear_acceleration; float64[9] linear_acceleration_covariance"},
    Fields{"sensor_msgs/RegionOfInterest", "", "uint32 x_offset y_offset height width; bool do_rectify"},
    Fields{"sensor_msgs/CameraInfo", "c9a58c1b0b154e0e6da7578cb991d214",
           "HEADER; uint32 height width; string distortion_model; float64[] D; float64[9] K R; float64[12] P; "
           "uint32 binning_x binning_y; sensor_msgs/RegionOfInterest roi"},
};

/// The first word, which is removed from the text.
std::string_view take_word(std::string_view& text) {
  const std::string_view word = text.substr(0, text.find(' '));
  text.remove_prefix(std::min(text.size(), word.size() + 1));
  return word;
}

const Fields& fields_of(std::string_view type) {
  const auto* const found = std::ranges::find(kFields, type, &Fields::type);
  EDGED_CHECK(found != kFields.end(), "no definition of {}", type);
  return *found;
}

/// The definition: a line for each field.
std::string text_of(std::string_view type, Wire wire) {
  std::string_view rest;
  if (type == "std_msgs/Header") {
    rest = wire == Wire::Ros1 ? "uint32 seq; time stamp; string frame_id" : "time stamp; string frame_id";
  } else {
    rest = fields_of(type).fields;
  }
  std::string text;
  while (!rest.empty()) {
    std::string_view names = rest.substr(0, rest.find("; "));
    rest.remove_prefix(std::min(rest.size(), names.size() + 2));
    std::string_view of = take_word(names);
    if (of == "HEADER") of = "std_msgs/Header", names = "header";
    if (of == "time" && wire == Wire::Cdr) of = "builtin_interfaces/Time";
    while (!names.empty()) {
      std::string name(take_word(names));
      if (name.size() == 1 && wire == Wire::Cdr) name = lower_case(name);  // the matrices of CameraInfo
      text += fmt::format("{} {}\n", of, name);
    }
  }
  return text;
}

/// Types of the fields that are messages themselves, recursively, in the order of their occurrence.
void add_inner_types(std::string_view text, Wire wire, std::vector<std::string>& types) {
  for (std::size_t begin = 0; begin < text.size(); begin = text.find('\n', begin) + 1) {
    const std::string_view type = text.substr(begin, text.find_first_of(" [", begin) - begin);
    if (type.find('/') == std::string_view::npos || std::ranges::find(types, type) != types.end()) continue;
    types.emplace_back(type);
    add_inner_types(text_of(type, wire), wire, types);
  }
}

}  // namespace

std::string_view ros1_md5_of(std::string_view type) {
  const auto* const found = std::ranges::find(kFields, type, &Fields::type);
  return found == kFields.end() ? std::string_view() : found->md5;
}

MessageDefinition definition_of(std::string_view type, Wire wire) {
  MessageDefinition definition{text_of(type, wire), wire == Wire::Ros1 ? std::string(fields_of(type).md5) : ""};
  std::vector<std::string> inner;
  add_inner_types(definition.text, wire, inner);
  for (const std::string& name : inner)
    definition.text += fmt::format("{:=<80}\nMSG: {}\n{}", "", name, text_of(name, wire));
  return definition;
}

WireReader::WireReader(Wire wire, ByteSpan message) : wire_(wire), reader_(message) {
  if (wire == Wire::Ros1) return;
  ByteReader kind(message);
  kind.take(1);
  if (kind.number<std::uint8_t>() != 1) throw Damage("not plain little-endian CDR");
  kind.take(2);
  reader_ = ByteReader(message.subspan(4));
}

std::string_view WireReader::text() {
  const std::string_view value = reader_.text(number<std::uint32_t>());
  return wire_ == Wire::Cdr && value.ends_with('\0') ? value.substr(0, value.size() - 1) : value;
}

ByteSpan WireReader::bytes() { return reader_.take(number<std::uint32_t>()); }

Timestamp WireReader::time() {
  const std::int64_t s = wire_ == Wire::Cdr ? number<std::int32_t>() : std::int64_t{number<std::uint32_t>()};
  const std::int64_t ns = s * kSecondNs + number<std::uint32_t>();
  if (ns < 0 || ns > kMaxStampNs) throw Damage("stamp out of range");
  return timestamp_from_ns(ns);
}

Timestamp WireReader::header(std::string_view* frame_id) {
  if (wire_ == Wire::Ros1) number<std::uint32_t>();  // seq
  const Timestamp stamp = time();
  const std::string_view frame = text();
  if (frame_id != nullptr) *frame_id = frame;
  return stamp;
}

std::uint32_t WireReader::list(std::size_t item_bytes) {
  const auto length = number<std::uint32_t>();
  if (length > reader_.left() / item_bytes) throw Damage("list longer than its message");
  return length;
}

WireWriter::WireWriter(Wire wire) : wire_(wire) {
  if (wire == Wire::Cdr) out_.assign({0, 1, 0, 0});  // plain, little-endian
}

void WireWriter::numbers(std::span<const double> values) {
  for (const double value : values) number(value);
}

void WireWriter::text(std::string_view value) {
  const std::size_t terminator = wire_ == Wire::Cdr ? 1 : 0;
  number(static_cast<std::uint32_t>(value.size() + terminator));
  out_ += value;
  out_.append(terminator, '\0');
}

void WireWriter::bytes(ByteSpan value) {
  number(static_cast<std::uint32_t>(value.size()));
  out_ += as_text(value);
}

Timestamp latest_stamp(Wire wire) {
  const std::int64_t s = wire == Wire::Cdr ? std::numeric_limits<std::int32_t>::max()
                                           : std::int64_t{std::numeric_limits<std::uint32_t>::max()};
  return timestamp_from_ns(s * kSecondNs + kSecondNs - 1);
}

void WireWriter::time(Timestamp t) {
  EDGED_CHECK(to_ns(t) >= 0 && t <= latest_stamp(wire_), "stamp {} ns", to_ns(t));
  number(static_cast<std::uint32_t>(to_ns(t) / kSecondNs));
  number(static_cast<std::uint32_t>(to_ns(t) % kSecondNs));
}

void WireWriter::header(Timestamp stamp, std::string_view frame_id) {
  if (wire_ == Wire::Ros1) number(std::uint32_t{0});  // seq
  time(stamp);
  text(frame_id);
}

}  // namespace edged
