// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Fields of messages. ROS 1 and ROS 2 differ in headers, times and the names of a few fields.
#include "edged/io/ros/messages/definitions.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <vector>

#include "edged/core/check.hpp"

namespace edged {
namespace {

/// `TIME` is replaced by the type of stamps in ROS 1 or ROS 2.
struct Fields {
  std::string_view type;
  std::string_view md5;  ///< of types that are messages of a topic
  std::string_view text;
};

constexpr std::string_view kHeader1 = "uint32 seq\ntime stamp\nstring frame_id\n";
constexpr std::string_view kHeader2 = "builtin_interfaces/Time stamp\nstring frame_id\n";

constexpr std::string_view kEvent = "uint16 x\nuint16 y\nTIME ts\nbool polarity\n";
constexpr std::string_view kCameraInfo =
    "std_msgs/Header header\n"
    "uint32 height\n"
    "uint32 width\n"
    "string distortion_model\n"
    "float64[] D\n"
    "float64[9] K\n"
    "float64[9] R\n"
    "float64[12] P\n"
    "uint32 binning_x\n"
    "uint32 binning_y\n"
    "sensor_msgs/RegionOfInterest roi\n";

constexpr std::array kFields = {
    Fields{"builtin_interfaces/Time", "", "int32 sec\nuint32 nanosec\n"},
    Fields{"geometry_msgs/Quaternion", "", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    Fields{"geometry_msgs/Vector3", "", "float64 x\nfloat64 y\nfloat64 z\n"},
    Fields{"geometry_msgs/Transform", "",
           "geometry_msgs/Vector3 translation\n"
           "geometry_msgs/Quaternion rotation\n"},
    Fields{"geometry_msgs/TransformStamped", "b5764a33bfeb3588febc2682852579b0",
           "std_msgs/Header header\n"
           "string child_frame_id\n"
           "geometry_msgs/Transform transform\n"},
    Fields{"geometry_msgs/Point", "", "float64 x\nfloat64 y\nfloat64 z\n"},
    Fields{"geometry_msgs/Pose", "",
           "geometry_msgs/Point position\n"
           "geometry_msgs/Quaternion orientation\n"},
    Fields{"geometry_msgs/PoseStamped", "",
           "std_msgs/Header header\n"
           "geometry_msgs/Pose pose\n"},
    Fields{"geometry_msgs/PoseWithCovariance", "",
           "geometry_msgs/Pose pose\n"
           "float64[36] covariance\n"},
    Fields{"geometry_msgs/PoseWithCovarianceStamped", "953b798c0f514ff060a53a3498ce6246",
           "std_msgs/Header header\n"
           "geometry_msgs/PoseWithCovariance pose\n"},
    Fields{"geometry_msgs/Twist", "",
           "geometry_msgs/Vector3 linear\n"
           "geometry_msgs/Vector3 angular\n"},
    Fields{"geometry_msgs/TwistWithCovariance", "",
           "geometry_msgs/Twist twist\n"
           "float64[36] covariance\n"},
    Fields{"nav_msgs/Odometry", "cd5e73d190d741a2f92e81eda573aca7",
           "std_msgs/Header header\n"
           "string child_frame_id\n"
           "geometry_msgs/PoseWithCovariance pose\n"
           "geometry_msgs/TwistWithCovariance twist\n"},
    Fields{"nav_msgs/MapMetaData", "",
           "TIME map_load_time\n"
           "float32 resolution\n"
           "uint32 width\n"
           "uint32 height\n"
           "geometry_msgs/Pose origin\n"},
    Fields{"nav_msgs/OccupancyGrid", "3381f2d731d4076ec5c71b0759edbe4e",
           "std_msgs/Header header\n"
           "nav_msgs/MapMetaData info\n"
           "int8[] data\n"},
    Fields{"octomap_msgs/Octomap", "9a45536b45c5e409cd49f04bb2d9999f",
           "std_msgs/Header header\n"
           "bool binary\n"
           "string id\n"
           "float64 resolution\n"
           "int8[] data\n"},
    Fields{"nav_msgs/Path", "6227e2b7e9cce15051f669a5e197bbf7",
           "std_msgs/Header header\n"
           "geometry_msgs/PoseStamped[] poses\n"},
    Fields{"tf2_msgs/TFMessage", "94810edda583a504dfda3829e70d7eec", "geometry_msgs/TransformStamped[] transforms\n"},
    Fields{"diagnostic_msgs/KeyValue", "", "string key\nstring value\n"},
    Fields{"diagnostic_msgs/DiagnosticStatus", "",
           "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\n"
           "byte level\n"
           "string name\n"
           "string message\n"
           "string hardware_id\n"
           "diagnostic_msgs/KeyValue[] values\n"},
    Fields{"diagnostic_msgs/DiagnosticArray", "60810da900de1dd6ddd437c3503511da",
           "std_msgs/Header header\n"
           "diagnostic_msgs/DiagnosticStatus[] status\n"},
    Fields{"sensor_msgs/PointField", "",
           "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\n"
           "uint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\n"
           "string name\n"
           "uint32 offset\n"
           "uint8 datatype\n"
           "uint32 count\n"},
    Fields{"sensor_msgs/PointCloud2", "1158d486dd51d683ce2f1be655c3c181",
           "std_msgs/Header header\n"
           "uint32 height\n"
           "uint32 width\n"
           "sensor_msgs/PointField[] fields\n"
           "bool is_bigendian\n"
           "uint32 point_step\n"
           "uint32 row_step\n"
           "uint8[] data\n"
           "bool is_dense\n"},
    Fields{"dvs_msgs/Event", "", kEvent},
    Fields{"dvs_msgs/EventArray", "5e8beee5a6c107e504c2e78903c224b8",
           "std_msgs/Header header\n"
           "uint32 height\n"
           "uint32 width\n"
           "dvs_msgs/Event[] events\n"},
    Fields{"prophesee_event_msgs/Event", "", kEvent},
    Fields{"prophesee_event_msgs/EventArray", "5e8beee5a6c107e504c2e78903c224b8",
           "std_msgs/Header header\n"
           "uint32 height\n"
           "uint32 width\n"
           "prophesee_event_msgs/Event[] events\n"},
    Fields{"event_camera_msgs/EventPacket", "8a6101b351a64529ac77bd8b71074e52",
           "std_msgs/Header header\n"
           "uint32 height\n"
           "uint32 width\n"
           "uint64 seq\n"
           "uint64 time_base\n"
           "string encoding\n"
           "bool is_bigendian\n"
           "uint8[] events\n"},
    Fields{"sensor_msgs/Image", "060021388200f6f0f447d0fcd9c64743",
           "std_msgs/Header header\n"
           "uint32 height\n"
           "uint32 width\n"
           "string encoding\n"
           "uint8 is_bigendian\n"
           "uint32 step\n"
           "uint8[] data\n"},
    Fields{"sensor_msgs/Imu", "6a62c6daae103f4ff57a132d6f95cec2",
           "std_msgs/Header header\n"
           "geometry_msgs/Quaternion orientation\n"
           "float64[9] orientation_covariance\n"
           "geometry_msgs/Vector3 angular_velocity\n"
           "float64[9] angular_velocity_covariance\n"
           "geometry_msgs/Vector3 linear_acceleration\n"
           "float64[9] linear_acceleration_covariance\n"},
    Fields{"sensor_msgs/RegionOfInterest", "",
           "uint32 x_offset\n"
           "uint32 y_offset\n"
           "uint32 height\n"
           "uint32 width\n"
           "bool do_rectify\n"},
    Fields{"sensor_msgs/CameraInfo", "c9a58c1b0b154e0e6da7578cb991d214", kCameraInfo},
};

const Fields& fields_of(std::string_view type) {
  const auto* const found = std::ranges::find(kFields, type, &Fields::type);
  EDGED_CHECK(found != kFields.end(), "no definition of {}", type);
  return *found;
}

std::string text_of(std::string_view type, Wire wire) {
  if (type == "std_msgs/Header") return std::string(wire == Wire::Ros1 ? kHeader1 : kHeader2);
  std::string text(fields_of(type).text);
  if (const std::size_t at = text.find("TIME "); at != std::string::npos)
    text.replace(at, 4, wire == Wire::Ros1 ? "time" : "builtin_interfaces/Time");
  if (type == "sensor_msgs/CameraInfo" && wire == Wire::Cdr)
    for (std::size_t at = text.find("] "); at != std::string::npos; at = text.find("] ", at + 1))
      text[at + 2] = static_cast<char>(text[at + 2] - 'A' + 'a');
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

}  // namespace edged
