// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "dds/environment.hpp"

#include <ifaddrs.h>
#include <net/if.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <charconv>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>

#include "edged/core/check.hpp"

namespace edged::ros2 {
namespace {

constexpr std::uint32_t kMostDomains = 232;       // beyond it the ports of RTPS end
constexpr std::int64_t kReceiveBuffer = 4 << 20;  // [bytes]: 64 kB messages at 100 MB/s (docs/decisions: 042)
// A writer is deleted at once, though a subscriber that was killed has not confirmed its last messages.
constexpr const char* kInternal =
    "<Internal><SocketReceiveBufferSize max=\"8 MiB\"/>"
    "<WriterLingerDuration>100 ms</WriterLingerDuration></Internal>";

std::uint32_t domain_of(const std::string& text) {
  std::uint32_t domain = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), domain);
  if (error != std::errc() || end != text.data() + text.size() || domain > kMostDomains)
    throw InputError::format("ROS_DOMAIN_ID={}: it must be a number from 0 to {}", text, kMostDomains);
  return domain;
}

DiscoveryRange range_of(const std::string& text) {
  if (text == "SUBNET") return DiscoveryRange::Subnet;
  if (text == "LOCALHOST") return DiscoveryRange::Localhost;
  if (text == "OFF") return DiscoveryRange::Off;
  if (text == "SYSTEM_DEFAULT") return DiscoveryRange::SystemDefault;
  throw InputError::format("ROS_AUTOMATIC_DISCOVERY_RANGE={}: it must be SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT",
                           text);
}

std::vector<std::string> peers_of(const std::string& text) {
  std::vector<std::string> peers;
  std::istringstream list(text);
  for (std::string peer; std::getline(list, peer, ';');) {
    if (peer.find_first_of("<>\"&") != std::string::npos)
      throw InputError::format("ROS_STATIC_PEERS: '{}' is not an address", peer);
    if (!peer.empty()) peers.push_back(peer);
  }
  return peers;
}

bool has_network() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return true;
  bool found = false;
  for (const ifaddrs* i = first; i; i = i->ifa_next)
    found = found || ((i->ifa_flags & IFF_UP) != 0 && (i->ifa_flags & IFF_LOOPBACK) == 0 && i->ifa_addr &&
                      i->ifa_addr->sa_family == AF_INET);
  freeifaddrs(first);
  return found;
}

/// Peers on this machine use the loopback alone (ROS_LOCALHOST_ONLY) or all interfaces (later distributions): both are
/// wanted.
std::string local_interfaces(bool network) {
  const std::string other = network ? "<NetworkInterface autodetermine=\"true\"/>" : "";
  return "<Interfaces>" + other + "<NetworkInterface name=\"lo\"/></Interfaces>";
}

/// The user's configuration, a text or the name of a file, chooses interfaces: DDS refuses to select one twice.
bool chooses_interfaces(const std::string& uri) {
  constexpr std::string_view kFile = "file://";
  std::string text = uri;
  if (!uri.starts_with('<')) {
    std::ifstream file(uri.starts_with(kFile) ? uri.substr(kFile.size()) : uri);
    text.assign(std::istreambuf_iterator<char>(file), {});
  }
  return text.find("NetworkInterface") != std::string::npos;
}

}  // namespace

std::optional<std::string> variable(const char* name) {
  const char* value = std::getenv(name);
  return value && *value ? std::optional<std::string>(value) : std::nullopt;
}

Discovery discovery_of(const Environment& environment) {
  Discovery discovery;
  if (const auto domain = environment("ROS_DOMAIN_ID")) discovery.domain = domain_of(*domain);
  if (const auto range = environment("ROS_AUTOMATIC_DISCOVERY_RANGE")) discovery.range = range_of(*range);
  if (const auto peers = environment("ROS_STATIC_PEERS")) discovery.peers = peers_of(*peers);
  if (environment("ROS_LOCALHOST_ONLY") == "1") {
    discovery.range = DiscoveryRange::Localhost;
    discovery.peers.clear();
  }
  const bool takes_peers = discovery.range == DiscoveryRange::Subnet || discovery.range == DiscoveryRange::Localhost;
  if (!takes_peers && !discovery.peers.empty()) {
    spdlog::warn("ROS_STATIC_PEERS is ignored, as ROS_AUTOMATIC_DISCOVERY_RANGE is OFF or SYSTEM_DEFAULT");
    discovery.peers.clear();
  }
  discovery.network = has_network();
  discovery.cyclone_uri = environment("CYCLONEDDS_URI").value_or("");
  return discovery;
}

/// Peers that are asked one by one must have ports that can be known: participants number themselves then.
std::string cyclone_config(const Discovery& discovery) {
  const bool localhost = discovery.range == DiscoveryRange::Localhost, off = discovery.range == DiscoveryRange::Off;
  std::vector<std::string> peers = discovery.peers;
  if (localhost) peers.insert(peers.begin(), "localhost");
  std::string parts = kInternal;
  if (localhost || off) {
    const bool chosen = chooses_interfaces(discovery.cyclone_uri);
    const std::string interfaces = localhost && !chosen ? local_interfaces(discovery.network) : "";
    parts += "<General>" + interfaces + "<AllowMulticast>false</AllowMulticast></General>";
  }
  if (off) parts += "<Discovery><ParticipantIndex>none</ParticipantIndex></Discovery>";
  if (!peers.empty()) {
    parts +=
        "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
        "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex><Peers>";
    for (const std::string& peer : peers) parts += fmt::format("<Peer address=\"{}\"/>", peer);
    parts += "</Peers></Discovery>";
  }
  const std::string config = fmt::format("<CycloneDDS><Domain id=\"any\">{}</Domain></CycloneDDS>", parts);
  return discovery.cyclone_uri.empty() ? config : config + "," + discovery.cyclone_uri;
}

std::optional<std::int64_t> small_receive_buffer() {
  std::ifstream file("/proc/sys/net/core/rmem_max");
  std::int64_t bytes = 0;
  return file >> bytes && bytes < kReceiveBuffer ? std::optional(bytes) : std::nullopt;
}

}  // namespace edged::ros2
