// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Voxels before, at and behind a wall, and the files by OctoMap's reader, OpenCV and yaml-cpp.
#include "scene/occupancy.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <tuple>

#include "common/files.hpp"
#include "edged/io/test_support.hpp"
#include "report/point_cloud.hpp"

namespace edged {
namespace {

/// Five images along y that face x, and points on a wall 2 m in front of them.
Reconstruction seen_wall(double baseline_m = 0.8) {
  Reconstruction model;
  model.cameras.push_back({"frames", CameraModel(240, 180, 200.0, 200.0, 120.0, 90.0)});
  Eigen::Matrix3d R_W_C;
  R_W_C << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  for (int i = 0; i < 5; ++i) {
    Reconstruction::Image& image = model.images.emplace_back();
    image.T_W_C = SE3(Eigen::Quaterniond(R_W_C), {0.02, baseline_m * (0.25 * i - 0.5), 0.02});
    for (FeatureId id = 0; id < 12; ++id) {
      const Eigen::Vector3d p_W(2.02, 0.1 * static_cast<double>(id % 4) - 0.13,
                                0.1 * static_cast<double>(id / 4) - 0.08);
      image.observations.push_back(
          {.feature = id, .pixel = *model.cameras[0].pinhole.project(image.T_W_C.inverse() * p_W)});
    }
  }
  triangulate(model);
  return model;
}

enum class Space { Unknown, Free, Occupied };

Space space_at(const octomap::OcTree& tree, double x, double y, double z) {
  const octomap::OcTreeNode* node = tree.search(x, y, z);
  return !node ? Space::Unknown : tree.isNodeOccupied(node) ? Space::Occupied : Space::Free;
}

TEST(OccupancyOfAWall, IsOccupiedAtPointsFreeBeforeThemAndUnknownBehind) {
  const octomap::OcTree tree = occupancy_of(seen_wall(), 0.05);
  for (const double y : {-0.13, -0.03, 0.07, 0.17}) {
    EXPECT_EQ(space_at(tree, 2.02, y, 0.02), Space::Occupied) << y;
    EXPECT_EQ(space_at(tree, 1.0, 0.5 * y, 0.02), Space::Free) << y;
    for (const double behind_m : {0.06, 0.2, 1.0}) EXPECT_EQ(space_at(tree, 2.02 + behind_m, y, 0.02), Space::Unknown);
  }
  EXPECT_EQ(space_at(tree, 2.02, -0.08, 0.02), Space::Unknown) << "between points";
  EXPECT_EQ(space_at(tree, 1.0, 0.0, 1.0), Space::Unknown) << "no image shows it";
}

TEST(OccupancyOfAWall, IsNotOccupiedWhereTheDepthIsCoarserThanAVoxel) {
  const Reconstruction coarse = seen_wall(0.3);
  ASSERT_EQ(coarse.points.size(), 12U);
  EXPECT_EQ(space_at(occupancy_of(coarse, 0.05), 2.02, -0.03, 0.02), Space::Unknown);
  EXPECT_EQ(space_at(occupancy_of(coarse, 0.05), 1.9, -0.03, 0.02), Space::Unknown) << "within three sigmas";
  EXPECT_EQ(space_at(occupancy_of(coarse, 0.05), 1.0, 0.0, 0.02), Space::Free);
  EXPECT_EQ(space_at(occupancy_of(coarse, 0.2), 2.02, -0.03, 0.02), Space::Occupied);
}

TEST(OccupancyOfAWall, NeedsFourObservations) {
  Reconstruction few = seen_wall();
  for (Reconstruction::Point& point : few.points) point.seen.resize(3);
  EXPECT_EQ(occupancy_of(few, 0.05).size(), 0U);
}

class OccupancyFiles : public testing::Test {
 protected:
  TempFolder folder_;
  octomap::OcTree tree_ = occupancy_of(seen_wall(), 0.05);
};

TEST_F(OccupancyFiles, AreReadByOctoMap) {
  write_occupancy(folder_.path(), tree_, {-0.1, 0.1});
  const std::unique_ptr<octomap::AbstractOcTree> read(
      octomap::AbstractOcTree::read((folder_.path() / "occupancy.ot").string()));
  const auto* with_probabilities = dynamic_cast<octomap::OcTree*>(read.get());
  ASSERT_NE(with_probabilities, nullptr);
  EXPECT_TRUE(*with_probabilities == tree_);
  octomap::OcTree binary((folder_.path() / "occupancy.bt").string());
  EXPECT_EQ(binary.getResolution(), 0.05);
  octomap::OcTree all = tree_;
  all.expand();
  ASSERT_GT(all.getNumLeafNodes(), 100U);
  for (auto leaf = all.begin_leafs(); leaf != all.end_leafs(); ++leaf)
    ASSERT_EQ(space_at(binary, leaf.getX(), leaf.getY(), leaf.getZ()),
              space_at(tree_, leaf.getX(), leaf.getY(), leaf.getZ()));
}

TEST_F(OccupancyFiles, AreReadAsByTheRosMapServer) {
  write_occupancy(folder_.path(), tree_, {-0.1, 0.1});
  const YAML::Node yaml = YAML::LoadFile((folder_.path() / "map.yaml").string());
  const cv::Mat image = cv::imread((folder_.path() / yaml["image"].as<std::string>()).string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(image.type(), CV_8UC1);
  const auto space = [&](double x, double y) {
    const double voxel_m = yaml["resolution"].as<double>();
    const int column = static_cast<int>(std::floor((x - yaml["origin"][0].as<double>()) / voxel_m));
    const int row = image.rows - 1 - static_cast<int>(std::floor((y - yaml["origin"][1].as<double>()) / voxel_m));
    if (column < 0 || row < 0 || column >= image.cols || row >= image.rows) return Space::Unknown;
    const double probability = 1.0 - image.at<std::uint8_t>(row, column) / 255.0;
    return probability > yaml["occupied_thresh"].as<double>() ? Space::Occupied
           : probability < yaml["free_thresh"].as<double>()   ? Space::Free
                                                              : Space::Unknown;
  };
  for (const double y : {-0.13, -0.03, 0.07, 0.17}) EXPECT_EQ(space(2.02, y), Space::Occupied) << y;
  EXPECT_EQ(space(1.02, 0.02), Space::Free);
  EXPECT_EQ(space(2.02, -0.08), Space::Unknown);
  EXPECT_EQ(space(0.02, 0.42), Space::Free) << "left of the middle is up in the image";
  EXPECT_EQ(space(0.02, 0.48), Space::Unknown);
}

TEST_F(OccupancyFiles, ListTheOccupiedVoxelsForTheReport) {
  const std::filesystem::path file = folder_.path() / "voxels.ply";
  octomap::OcTree tree(0.05);
  for (unsigned i = 0; i < 8; ++i)  // equal neighbours: one leaf of the pruned tree
    tree.updateNode(0.025F + 0.05F * (i % 2), 0.025F + 0.05F * (i / 2 % 2), 0.025F + 0.05F * (i / 4), true);
  tree.updateNode(1.025, 0.025, 0.025, true);
  tree.updateNode(2.025, 0.025, 0.025, false);
  ASSERT_EQ(tree.getNumLeafNodes(), 3U);
  write_file(file, voxels_ply(tree));
  const PointCloud cloud = read_cloud(file, 100);
  EXPECT_EQ(cloud.all, 9U);
  ASSERT_EQ(cloud.points.size(), 9U);
  EXPECT_FLOAT_EQ(cloud.size_m, 0.05F);
  std::set<std::tuple<int, int, int>> places;
  for (const Eigen::Vector3f& p : cloud.points) {
    EXPECT_EQ(tree.search(p.x(), p.y(), p.z()) != nullptr, true);
    places.insert(
        {std::lround(p.x() / 0.05F - 0.5F), std::lround(p.y() / 0.05F - 0.5F), std::lround(p.z() / 0.05F - 0.5F)});
  }
  EXPECT_EQ(places.size(), 9U);
}

TEST_F(OccupancyFiles, ThatCannotBeWrittenAreRefused) {
  EXPECT_THROW(write_occupancy(folder_.path() / "missing", tree_, {-0.1, 0.1}), InputError);
  EXPECT_THROW(write_occupancy(folder_.path(), tree_, {5.0, 6.0}), InputError) << "nothing is known there";
}

}  // namespace
}  // namespace edged
