// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/node.hpp"

#include <gmock/gmock.h>

#include <stdexcept>

#include "edged/core/check.hpp"
#include "node/node_test_support.hpp"

namespace edged::node {
namespace {

using ::testing::ThrowsMessage;

NodeConfig davis_config() {
  NodeConfig config;
  config.rig = "davis240c_ecd";
  return config;
}

TEST(Node, TwoSensorsOnOneTopicAreRefused) {
  KeptTransport transport(Wire::Cdr);
  transport.remapped = {{"imu", "/all"}, {"velocity", "/all"}};
  EXPECT_THAT([&] { Node(davis_config(), load_node_rig(davis_config()), transport); },
              ThrowsMessage<InputError>("/all is to be both imu and velocity: remap one of them"));
}

TEST(Node, AMapThatCannotBeUsedIsRefused) {
  KeptTransport transport(Wire::Cdr);
  NodeConfig config = davis_config();
  config.options.map.localize_only = true;
  EXPECT_THAT([&] { Node(config, load_node_rig(config), transport); },
              ThrowsMessage<InputError>("map.localize_only needs the map to localize in: set map_file, too"));
  config.map_file = "/nowhere/lab.map";
  EXPECT_THAT([&] { Node(config, load_node_rig(config), transport); },
              ThrowsMessage<InputError>("map_file /nowhere/lab.map: cannot be read"));
}

TEST(Node, StopsTheTransportWhenItFails) {
  KeptTransport transport(Wire::Cdr);
  Node node(davis_config(), load_node_rig(davis_config()), transport);
  const auto fails = [&]() -> bool {
    EXPECT_TRUE(transport.runs);
    throw std::runtime_error("broken");
  };
  EXPECT_THROW(node.run(fails), std::runtime_error);
  EXPECT_FALSE(transport.runs);
}

}  // namespace
}  // namespace edged::node
