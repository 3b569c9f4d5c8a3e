// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "dds/graph.hpp"

#include <algorithm>
#include <array>

#include "edged/core/check.hpp"
#include "edged/io/ros/messages/messages.hpp"

namespace edged::ros2 {
namespace {

constexpr const char* kTopic = "ros_discovery_info";  // without a slash: no topic of nodes
constexpr std::size_t kHumbleGid = 24, kLaterGid = 16;
constexpr std::array<std::string_view, 5> kLater = {"iron", "jazzy", "kilted", "lyrical", "rolling"};

void write_gid(WireWriter& out, const Guid& guid, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) out.number(i < guid.size() ? guid[i] : std::uint8_t{0});
}

void write_gids(WireWriter& out, const std::vector<Guid>& guids, std::size_t size) {
  out.number(static_cast<std::uint32_t>(guids.size()));
  for (const Guid& guid : guids) write_gid(out, guid, size);
}

}  // namespace

std::size_t gid_bytes_of(const std::string& distribution) {
  if (distribution == "humble") return kHumbleGid;
  if (std::ranges::find(kLater, distribution) != kLater.end()) return kLaterGid;
  throw InputError::format("--ros-distro {}: it must be humble, iron, jazzy, kilted, lyrical or rolling", distribution);
}

Graph::Graph(const Participant& participant, std::size_t gid_bytes, std::string name_space, std::string node)
    : participant_(participant.guid()),
      gid_bytes_(gid_bytes),
      name_space_(std::move(name_space)),
      node_(std::move(node)),
      writer_(participant, kTopic, "rmw_dds_common/ParticipantEntitiesInfo", {.latched = true, .depth = 1}) {}

void Graph::update(const std::vector<Guid>& readers, const std::vector<Guid>& writers) const {
  WireWriter out(Wire::Cdr);
  write_gid(out, participant_, gid_bytes_);
  out.number(std::uint32_t{1});
  out.text(name_space_);
  out.text(node_);
  write_gids(out, readers, gid_bytes_);
  write_gids(out, writers, gid_bytes_);
  writer_.write(out.message());
}

}  // namespace edged::ros2
