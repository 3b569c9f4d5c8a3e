// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The occupancy map that the node publishes, as a grid and as voxels; the other topics are tested with their messages.
#include "node/outputs.hpp"

#include <gmock/gmock.h>
#include <octomap/OcTree.h>

#include <sstream>

#include "edged/core/check.hpp"
#include "edged/io/ros/messages/messages.hpp"
#include "node/node_test_support.hpp"

namespace edged::node {
namespace {

using ::testing::Contains;
using ::testing::Not;
using ::testing::ThrowsMessage;

NodeConfig with_grid() {
  NodeConfig config;
  config.occupancy.voxel_m = 0.1;
  return config;
}

/// Its keyframe at the height z faces x, and has a landmark 2 m ahead.
Step step_with_keyframe(double z) {
  Eigen::Matrix3d R_W_C;
  R_W_C << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Step step;
  step.t = timestamp_from_seconds(7);
  step.status = TrackingStatus::Good;
  KeyframeRecord keyframe{timestamp_from_seconds(6), SE3(Eigen::Quaterniond(R_W_C), {0.05, 0.05, z}), {}};
  keyframe.views.push_back({"frames", SE3(), {{1, {0.0, 0.0}, 0.5, 1e-3}}});
  step.marginalized_keyframes.push_back(keyframe);
  return step;
}

/// The last message of a latched topic, once the thread that makes it has ended.
std::string last_of(const std::string& topic, const std::string& type, const NodeConfig& config, Wire wire) {
  KeptTransport transport(wire);
  Outputs(transport, config, std::nullopt).publish(step_with_keyframe(1.05), Estimate(), SE3());
  EXPECT_THAT(transport.topics, Contains(topic + " " + type));
  EXPECT_THAT(transport.latched, Contains(topic));
  return transport.last[topic];
}

std::string grid_of(const NodeConfig& config, Wire wire) {
  return last_of("~/occupancy", "nav_msgs/OccupancyGrid", config, wire);
}

class OccupancyTopics : public ::testing::TestWithParam<Wire> {};
INSTANTIATE_TEST_SUITE_P(Wires, OccupancyTopics, ::testing::Values(Wire::Ros1, Wire::Cdr));

TEST_P(OccupancyTopics, TheVoxelsAreReadByOctoMap) {
  const std::string message = last_of("~/octomap", "octomap_msgs/Octomap", with_grid(), GetParam());
  WireReader map(GetParam(), as_bytes(message));
  EXPECT_EQ(map.header(), timestamp_from_seconds(6));
  EXPECT_EQ(map.number<std::uint8_t>(), 1) << "binary";
  EXPECT_EQ(map.text(), "OcTree");
  octomap::OcTree tree(map.number<double>());
  EXPECT_EQ(tree.getResolution(), 0.1);
  const ByteSpan data = map.bytes();
  std::istringstream voxels(std::string(reinterpret_cast<const char*>(data.data()), data.size()));
  tree.readBinaryData(voxels);
  const octomap::OcTreeNode* landmark = tree.search(2.05, 0.05, 1.05);
  const octomap::OcTreeNode* before = tree.search(1.05, 0.05, 1.05);
  ASSERT_NE(landmark, nullptr);
  ASSERT_NE(before, nullptr);
  EXPECT_TRUE(tree.isNodeOccupied(landmark));
  EXPECT_FALSE(tree.isNodeOccupied(before));
  EXPECT_EQ(tree.search(2.55, 0.05, 1.05), nullptr) << "unknown behind it";
}

TEST_P(OccupancyTopics, TheGridHasFreeCellsUpToTheOccupiedOneAtTheHeightOfThePath) {
  const std::string message = grid_of(with_grid(), GetParam());
  WireReader grid(GetParam(), as_bytes(message));
  EXPECT_EQ(grid.header(), timestamp_from_seconds(6));
  EXPECT_EQ(grid.time(), timestamp_from_seconds(6));
  EXPECT_EQ(grid.number<float>(), 0.1F);
  const auto width = grid.number<std::uint32_t>(), height = grid.number<std::uint32_t>();
  EXPECT_EQ(width, 21U) << "from 0 to 2.1 m";
  EXPECT_EQ(height, 1U);
  const Eigen::Matrix<double, 7, 1> origin = grid.vector<7>();
  EXPECT_NEAR(origin.head<3>().norm(), 0.0, 1e-9);
  EXPECT_EQ(origin[6], 1.0);
  const ByteSpan cells = grid.bytes();
  ASSERT_EQ(cells.size(), 21U);
  EXPECT_EQ(static_cast<int>(static_cast<std::int8_t>(cells[0])), 0);
  EXPECT_EQ(static_cast<int>(static_cast<std::int8_t>(cells[10])), 0);
  EXPECT_EQ(static_cast<int>(static_cast<std::int8_t>(cells[19])), -1);
  EXPECT_EQ(static_cast<int>(static_cast<std::int8_t>(cells[20])), 100);
}

TEST(OccupancyGrid, ShowsTheChosenHeights) {
  NodeConfig config = with_grid();
  config.occupancy.low_m = 3.0;
  config.occupancy.high_m = 4.0;
  EXPECT_EQ(grid_of(config, Wire::Cdr), "") << "nothing is known there";
  config.occupancy.low_m = 5.0;
  KeptTransport transport(Wire::Cdr);
  EXPECT_THAT([&] { Outputs(transport, config, std::nullopt); },
              ThrowsMessage<InputError>("occupancy.low_m 5: must be below occupancy.high_m 4"));
}

TEST(OccupancyGrid, IsOffByDefault) {
  KeptTransport transport(Wire::Cdr);
  const NodeConfig config;
  Outputs(transport, config, std::nullopt).publish(step_with_keyframe(1.05), Estimate(), SE3());
  EXPECT_THAT(transport.topics, Not(Contains("~/occupancy nav_msgs/OccupancyGrid")));
}

}  // namespace
}  // namespace edged::node
