// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The environment variables of ROS 2 as a configuration of Cyclone DDS.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace edged::ros2 {

/// Which hosts are discovered (ROS_AUTOMATIC_DISCOVERY_RANGE).
enum class DiscoveryRange { Subnet, Localhost, Off, SystemDefault };

struct Discovery {
  std::uint32_t domain = 0;
  DiscoveryRange range = DiscoveryRange::Subnet;
  std::vector<std::string> peers;  ///< addresses that are asked beside (ROS_STATIC_PEERS)
  bool network = true;             ///< whether an interface beside the loopback is up
  std::string cyclone_uri;         ///< the user's own configuration (CYCLONEDDS_URI), which has the last word
};

/// The value of a variable; nothing if it is not set.
using Environment = std::function<std::optional<std::string>(const char*)>;
std::optional<std::string> variable(const char* name);  ///< by the environment of this process

/// ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS (ignored with a warning where the range is Off or
/// SystemDefault), ROS_LOCALHOST_ONLY (of Humble; where it is 1 it wins) and CYCLONEDDS_URI. Throws InputError that
/// names a variable with a value that ROS 2 does not know.
Discovery discovery_of(const Environment& environment = variable);

/// For dds_create_domain.
std::string cyclone_config(const Discovery& discovery);

/// Bytes that a socket may ask for (net.core.rmem_max), if they are too few for large messages.
std::optional<std::int64_t> small_receive_buffer();

}  // namespace edged::ros2
