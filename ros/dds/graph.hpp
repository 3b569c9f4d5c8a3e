// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The topic that tells nodes of ROS 2 of each other (`ros2 node list`).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "dds/participant.hpp"

namespace edged::ros2 {

/// Bytes of a Gid in the messages of a distribution: "humble", "iron", "jazzy", "kilted", "lyrical" or "rolling".
/// Throws InputError that lists them.
std::size_t gid_bytes_of(const std::string& distribution);

/// rmw_dds_common/ParticipantEntitiesInfo. Nodes of Humble crash if the Gid has the size of a later distribution: only
/// the user knows which one runs.
class Graph {
 public:
  Graph(const Participant& participant, std::size_t gid_bytes, std::string name_space, std::string node);

  /// Publishes the endpoints of the node. From any thread.
  void update(const std::vector<Guid>& readers, const std::vector<Guid>& writers) const;

 private:
  const Guid participant_;
  const std::size_t gid_bytes_;
  const std::string name_space_, node_;
  Writer writer_;
};

}  // namespace edged::ros2
