// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "scene/occupancy.hpp"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <bit>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "common/files.hpp"
#include "edged/core/check.hpp"
#include "edged/occupancy/occupancy_scan.hpp"
#include "report/point_cloud.hpp"

namespace edged {
namespace {

static_assert(std::endian::native == std::endian::little, "voxels are written as they lie in memory");

constexpr std::size_t kFewestViews = 4;
constexpr double kFrames_px = 0.7;  // sigma of observations whose errors along a track are correlated
constexpr double kEvents_px = 1.2;
constexpr double kDenseSigmas = 2.5;  // of a dense point: their errors have long tails
constexpr double kMostPixels = 1e9;   // of a slice
constexpr std::uint8_t kOccupied = 0, kFree = 254, kUnknownCell = 205;  // as the ROS map server writes them

/// Not by OctoMap's functions for whole files, which print to stderr.
std::string header_of(const char* kind, const octomap::OcTree& tree) {
  return fmt::format("{}\nid {}\nsize {}\nres {}\ndata\n", kind, tree.getTreeType(), tree.size(), tree.getResolution());
}

/// The picture of the ROS map server: y up.
cv::Mat picture_of(const OccupancySlice& slice) {
  cv::Mat picture(slice.cells.size(), CV_8UC1, cv::Scalar(kUnknownCell));
  picture.setTo(kFree, slice.cells == OccupancySlice::kFree);
  picture.setTo(kOccupied, slice.cells == OccupancySlice::kOccupied);
  cv::flip(picture, picture, 0);
  return picture;
}

}  // namespace

octomap::OcTree occupancy_of(const Reconstruction& model, double voxel_m, std::span<const DenseScan> dense) {
  octomap::OcTree tree(voxel_m);
  for (const Reconstruction::Image& image : model.images) {
    const double noise_px = model.cameras[image.camera].modality == Modality::Events ? kEvents_px : kFrames_px;
    OccupancyScan scan(tree, image.T_W_C.translation());
    for (const Reconstruction::Observation& observation : image.observations) {
      if (observation.point == Reconstruction::kNone) continue;
      const Reconstruction::Point& point = model.points[observation.point];
      if (point.seen.size() < kFewestViews) continue;
      const Eigen::Vector3d along = (point.p_W - image.T_W_C.translation()).normalized();
      const double sigma = noise_px * std::sqrt(along.dot(point.covariance * along));
      scan.free_towards(point.p_W, sigma);
      scan.occupy(point.p_W, sigma);
    }
    scan.insert();
  }
  // Their few outliers would be free through walls, and those of event frames too often beside a surface.
  for (const DenseScan& of_image : dense) {
    if (of_image.modality == Modality::Events) continue;
    OccupancyScan scan(tree, of_image.from_W);
    for (const DenseScan::Point& point : of_image.points) scan.occupy(point.p_W, kDenseSigmas * point.sigma_m);
    scan.insert();
  }
  tree.updateInnerOccupancy();
  tree.prune();
  return tree;
}

std::string voxels_ply(const octomap::OcTree& tree) {
  const std::vector<Eigen::Vector3f> centres = occupied_voxels(tree);
  std::string ply = ply_header(true, {"centres of occupied voxels in the world (z up) [m]; size: their edge [m]"},
                               centres.size(), "float x, float y, float z, float size");
  for (const Eigen::Vector3f& p : centres) {
    const std::array vertex = {p.x(), p.y(), p.z(), static_cast<float>(tree.getResolution())};
    ply.append(reinterpret_cast<const char*>(vertex.data()), sizeof(vertex));
  }
  return ply;
}

void write_occupancy(const std::filesystem::path& folder, const octomap::OcTree& tree, const HeightRange& heights) {
  std::ostringstream probabilities, binary;
  probabilities << header_of("# Octomap OcTree file", tree);
  tree.writeData(probabilities);
  octomap::OcTree likely(tree);
  likely.toMaxLikelihood();
  likely.prune();
  binary << header_of("# Octomap OcTree binary file", likely);
  likely.writeBinaryData(binary);
  write_file(folder / "occupancy.ot", probabilities.str());
  write_file(folder / "occupancy.bt", binary.str());
  const std::optional<OccupancySlice> slice = slice_of(tree, heights, kMostPixels);
  if (!slice)
    throw InputError::format("--occupancy-heights {:g} {:g}: nothing is known between them", heights.low_m,
                             heights.high_m);
  write_picture(folder / "map.pgm", picture_of(*slice));
  // The map server takes 1 - v / 255 of a pixel v as the probability that it is occupied: of unknown ones 0.1961.
  write_file(folder / "map.yaml",
             fmt::format("image: map.pgm\nresolution: {}\norigin: [{:.6f}, {:.6f}, 0.0]\nnegate: 0\n"
                         "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
                         tree.getResolution(), slice->corner_W.x(), slice->corner_W.y()));
}

}  // namespace edged
