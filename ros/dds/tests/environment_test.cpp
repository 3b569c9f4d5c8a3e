// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "dds/environment.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include <map>

#include "edged/core/check.hpp"

namespace edged::ros2 {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

Discovery discovery_with(const std::map<std::string, std::string>& variables) {
  return discovery_of([&](const char* name) {
    const auto found = variables.find(name);
    return found == variables.end() ? std::nullopt : std::optional(found->second);
  });
}

TEST(Ros2Environment, WithoutVariablesIsDomain0OnTheSubnet) {
  const Discovery discovery = discovery_with({});
  EXPECT_EQ(discovery.domain, 0U);
  EXPECT_EQ(discovery.range, DiscoveryRange::Subnet);
  EXPECT_THAT(cyclone_config(discovery), Not(HasSubstr("AllowMulticast")));
}

TEST(Ros2Environment, LocalhostAsksThisMachineWithoutMulticast) {
  const std::string config = cyclone_config(discovery_with({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}}));
  for (const char* part : {"<AllowMulticast>false</AllowMulticast>", "<ParticipantIndex>auto</ParticipantIndex>",
                           "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>", "<Peer address=\"localhost\"/>"})
    EXPECT_THAT(config, HasSubstr(part));
  EXPECT_THAT(config, HasSubstr("<NetworkInterface name=\"lo\"/>"));
  EXPECT_EQ(config, cyclone_config(discovery_with({{"ROS_LOCALHOST_ONLY", "1"}, {"ROS_STATIC_PEERS", "10.0.0.1"}})));
}

TEST(Ros2Environment, PeersAreAskedBesideTheSubnetAndNotWithoutDiscovery) {
  const Discovery discovery = discovery_with({{"ROS_DOMAIN_ID", "42"}, {"ROS_STATIC_PEERS", "10.0.0.1;;robot.local"}});
  EXPECT_EQ(discovery.domain, 42U);
  EXPECT_THAT(discovery.peers, ElementsAre("10.0.0.1", "robot.local"));
  EXPECT_THAT(cyclone_config(discovery), HasSubstr("<Peer address=\"10.0.0.1\"/><Peer address=\"robot.local\"/>"));
  const auto without_peers = [](const char* range) {
    return cyclone_config(discovery_with({{"ROS_AUTOMATIC_DISCOVERY_RANGE", range}, {"ROS_STATIC_PEERS", "10.0.0.1"}}));
  };
  EXPECT_THAT(without_peers("OFF"), HasSubstr("<AllowMulticast>false</AllowMulticast>"));
  EXPECT_THAT(without_peers("OFF"), Not(HasSubstr("Peer ")));
  EXPECT_THAT(without_peers("SYSTEM_DEFAULT"), Not(HasSubstr("Peer ")));
}

TEST(Ros2Environment, TheUsersOwnConfigurationComesLast) {
  EXPECT_THAT(cyclone_config(discovery_with({{"CYCLONEDDS_URI", "file:///tmp/mine.xml"}})),
              ::testing::EndsWith(",file:///tmp/mine.xml"));
}

TEST(Ros2Environment, InterfacesAreThoseThatTheUserHasChosen) {
  const auto with = [](const std::string& uri) {
    return cyclone_config(discovery_with({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}, {"CYCLONEDDS_URI", uri}}));
  };
  const std::string chosen = "<General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces></General>";
  EXPECT_THAT(with("<Tracing/>"), HasSubstr("<Interfaces>"));
  EXPECT_EQ(with(chosen).find("<Interfaces>"), with(chosen).rfind("<Interfaces>")) << "those of the user alone";
  const std::string file = ::testing::TempDir() + "/edged_cyclone.xml";
  std::ofstream(file) << chosen;
  EXPECT_THAT(with("file://" + file), Not(HasSubstr("<Interfaces>")));
  EXPECT_THAT(with(file), Not(HasSubstr("<Interfaces>")));
}

TEST(Ros2Environment, AValueThatRosDoesNotKnowIsNamed) {
  const auto message = [](const std::string& text) { return ThrowsMessage<InputError>(HasSubstr(text)); };
  EXPECT_THAT([] { discovery_with({{"ROS_DOMAIN_ID", "233"}}); }, message("ROS_DOMAIN_ID=233"));
  EXPECT_THAT([] { discovery_with({{"ROS_DOMAIN_ID", "1x"}}); }, message("ROS_DOMAIN_ID=1x"));
  EXPECT_THAT([] { discovery_with({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCAL"}}); }, message("SUBNET, LOCALHOST"));
}

}  // namespace
}  // namespace edged::ros2
