// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "dds/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "edged/core/check.hpp"

namespace edged::ros2 {
namespace {

// ros/dds/tests/type_hash_test.py computes the hashes from the definitions in ros/dds/tests/messages.idl.
constexpr std::array kTypes = {
    MessageType{"diagnostic_msgs/DiagnosticArray", "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"},
    MessageType{"event_camera_msgs/EventPacket", "d6fa176260b1f37e5a40845305315e150a0f18191241eb64f407442aa29844aa"},
    MessageType{"geometry_msgs/PoseWithCovarianceStamped",
                "26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e"},
    MessageType{"geometry_msgs/TwistStamped", "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64"},
    MessageType{"geometry_msgs/TwistWithCovarianceStamped",
                "77b67434531e6529b7a0091357b186b6ebdb17fd9ffd3e0c7ce9d3fb11a44563"},
    MessageType{"nav_msgs/OccupancyGrid", "8d348150c12913a31ee0ec170fbf25089e4745d17035792a1ba94d6f0bc0cfc7"},
    MessageType{"nav_msgs/Odometry", "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"},
    MessageType{"nav_msgs/Path", "1957a5bb3cee5da65c4e52e52b65a93df227efce4c20f8458b36e73066ca334b"},
    MessageType{"octomap_msgs/Octomap", "9891a19a05b70ec20aa8f45db3f8300b9ab80afff32c61c549d25087da9625b0"},
    MessageType{"px4_msgs/VehicleOdometry", "4295b96ad312084aa35c84bdcec65ba2f57eb4f6a293d57d52d95acbe99ff817"},
    MessageType{"rmw_dds_common/ParticipantEntitiesInfo",
                "91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e"},
    MessageType{"rosgraph_msgs/Clock", "692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564"},
    MessageType{"sensor_msgs/CompressedImage", "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a"},
    MessageType{"sensor_msgs/FluidPressure", "22dfb2b145a0bd5a31a1ac3882a1b32148b51d9b2f3bab250290d66f3595bc32"},
    MessageType{"sensor_msgs/Image", "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"},
    MessageType{"sensor_msgs/Imu", "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b"},
    MessageType{"sensor_msgs/PointCloud2", "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"},
    MessageType{"sensor_msgs/Range", "b42b62562e93cbfe9d42b82fe5994dfa3d63d7d5c90a317981703f7388adff3a"},
    MessageType{"std_msgs/Empty", "20b625256f32d5dbc0d04fee44f43c41e51c70d3502f84b4a08e7a9c26a96312"},
    MessageType{"std_msgs/String", "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"},
    MessageType{"tf2_msgs/TFMessage", "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
};

constexpr std::string_view kModule = "::msg::dds_::";

/// Words of letters, digits and underscores between slashes; no word begins with a digit.
bool is_name(std::string_view name) {
  char before = '/';
  for (const char c : name) {
    if (c != '/' && c != '_' && std::isalnum(static_cast<unsigned char>(c)) == 0) return false;
    if (before == '/' && (c == '/' || std::isdigit(static_cast<unsigned char>(c)) != 0)) return false;
    before = c;
  }
  return !name.empty() && before != '/';
}

void check_topic(const std::string& name, const std::string& remapping) {
  std::string_view rest = name;
  if (rest.starts_with("~/")) {
    rest.remove_prefix(2);
  } else if (rest.starts_with('/')) {
    rest.remove_prefix(1);
  }
  if (!is_name(rest)) throw InputError::format("remapping '{}': '{}' is not the name of a topic", remapping, name);
}

}  // namespace

std::span<const MessageType> message_types() { return kTypes; }

std::string dds_type(std::string_view type) {
  const std::size_t slash = type.find('/');
  EDGED_CHECK(slash != std::string_view::npos, "type {}", type);
  return fmt::format("{}{}{}_", type.substr(0, slash), kModule, type.substr(slash + 1));
}

std::string ros_type(std::string_view dds_type) {
  const std::size_t module = dds_type.find(kModule);
  if (module == std::string_view::npos || !dds_type.ends_with('_')) return "";
  std::string_view name = dds_type.substr(module + kModule.size());
  name.remove_suffix(1);
  return fmt::format("{}/{}", dds_type.substr(0, module), name);
}

std::string dds_topic(std::string_view topic) {
  return topic.starts_with('/') ? fmt::format("rt{}", topic) : std::string(topic);
}

std::string type_hash_data(std::string_view type) {
  const auto* const found = std::ranges::find(kTypes, type, &MessageType::name);
  return found == kTypes.end() ? "" : fmt::format("typehash=RIHS01_{};", found->hash);
}

Names::Names(std::string name_space, std::string node, const std::vector<std::string>& remappings)
    : name_space_(std::move(name_space)), node_(std::move(node)) {
  std::vector<std::pair<std::string, std::string>> topics;
  for (const std::string& remapping : remappings) {
    const std::size_t sign = remapping.find(":=");
    if (sign == std::string::npos || sign == 0)
      throw InputError::format("remapping '{}': write it as from:=to, such as events:=/event_camera/events", remapping);
    const std::string from = remapping.substr(0, sign), to = remapping.substr(sign + 2);
    if (from == "__ns") {
      name_space_ = to;
    } else if (from == "__node" || from == "__name") {
      node_ = to;
    } else {
      check_topic(from, remapping);
      check_topic(to, remapping);
      topics.emplace_back(from, to);
    }
  }
  if (!name_space_.starts_with('/')) name_space_.insert(name_space_.begin(), '/');
  if (name_space_ != "/" && !is_name(std::string_view(name_space_).substr(1)))
    throw InputError::format("'{}' is not a namespace: use letters, digits and underscores", name_space_);
  if (!is_name(node_) || node_.find('/') != std::string::npos)
    throw InputError::format("'{}' is not the name of a node: use letters, digits and underscores", node_);
  for (const auto& [from, to] : topics) remapped_.emplace(expand(from), expand(to));
}

std::string Names::full_name(const std::string& topic) const {
  std::string name = expand(topic);
  asked_for_.insert(name);
  const auto remapped = remapped_.find(name);
  return remapped == remapped_.end() ? name : remapped->second;
}

void Names::check_remappings() const {
  for (const auto& [from, to] : remapped_)
    if (!asked_for_.contains(from))
      throw InputError::format("remapping {}:={}: there is no topic {}, but {}", from, to, from,
                               fmt::join(asked_for_, ", "));
}

std::string Names::expand(const std::string& topic) const {
  if (topic.starts_with('/')) return topic;
  const std::string space = name_space_ == "/" ? "/" : name_space_ + "/";
  return topic.starts_with("~/") ? space + node_ + topic.substr(1) : space + topic;
}

}  // namespace edged::ros2
