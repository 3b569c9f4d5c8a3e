// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/occupancy.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/files.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

static_assert(std::endian::native == std::endian::little, "voxels are written as they lie in memory");

constexpr std::size_t kFewestViews = 4;
constexpr double kMostSigma = 0.5;   // of a point along the ray, over the voxel
constexpr double kFreeSigmas = 3.0;  // before a point, where its ray ends to be free
constexpr double kFrames_px = 0.7;   // sigma of observations whose errors along a track are correlated
constexpr double kEvents_px = 1.2;
constexpr double kDenseSigmas = 2.5;  // of a dense point: their errors have long tails
constexpr double kHit = 0.9;          // probability that a voxel is occupied which surely holds a point
constexpr float kMiss = -0.4F;        // log-odds of a voxel that a ray crosses
constexpr double kMostPixels = 1e9;   // of a slice
constexpr std::uint8_t kOccupied = 0, kFree = 254, kUnknown = 205;  // as the ROS map server writes them

octomap::point3d to_octomap(const Eigen::Vector3d& p) {
  return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

/// What one image says. Each voxel counts once, so that many points in one direction are no more than one.
class Scan {
 public:
  Scan(octomap::OcTree& tree, const Eigen::Vector3d& from) : tree_(tree), from_(from) {}

  /// sigma: along the ray [m].
  void free_towards(const Eigen::Vector3d& p_W, double sigma) {
    const Eigen::Vector3d along = (p_W - from_).normalized();
    const Eigen::Vector3d free_end = p_W - (tree_.getResolution() + kFreeSigmas * sigma) * along;
    if (along.dot(free_end - from_) > 0.0 && tree_.computeRayKeys(to_octomap(from_), to_octomap(free_end), ray_))
      free_.insert(ray_.begin(), ray_.end());
  }

  void occupy(const Eigen::Vector3d& p_W, double sigma) {
    const double voxel = tree_.getResolution();
    octomap::OcTreeKey key;
    if (sigma > kMostSigma * voxel || !tree_.coordToKeyChecked(to_octomap(p_W), key)) return;
    const double in_voxel = std::erf(0.5 * voxel / (std::numbers::sqrt2 * sigma));  // if its middle is the estimate
    float& hit = hits_[key];
    hit = std::max(hit, octomap::logodds(0.5 + (kHit - 0.5) * in_voxel));
  }

  void insert() {
    // In any order: each voxel is changed once.
    for (const auto& [key, log_odds] : hits_) tree_.updateNode(key, log_odds, true);
    for (const octomap::OcTreeKey& key : free_)
      if (!hits_.contains(key)) tree_.updateNode(key, kMiss, true);
  }

 private:
  octomap::OcTree& tree_;
  Eigen::Vector3d from_;
  octomap::KeyRay ray_;
  octomap::KeySet free_;
  std::unordered_map<octomap::OcTreeKey, float, octomap::OcTreeKey::KeyHash> hits_;  // log-odds
};

/// A leaf as a square of voxels, seen from above.
struct Square {
  int x, y, size;
  bool occupied;
};

/// Those that reach into the heights, the free ones first.
std::vector<Square> squares_between(const octomap::OcTree& tree, const HeightRange& heights) {
  std::vector<Square> squares;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const double half = 0.5 * leaf.getSize();
    if (leaf.getZ() + half <= heights.low_m || leaf.getZ() - half >= heights.high_m) continue;
    const octomap::OcTreeKey first = leaf.getIndexKey();
    squares.push_back({first[0], first[1], 1 << (tree.getTreeDepth() - leaf.getDepth()), tree.isNodeOccupied(*leaf)});
  }
  std::stable_partition(squares.begin(), squares.end(), [](const Square& square) { return !square.occupied; });
  return squares;
}

/// x to the right, y up.
struct Slice {
  cv::Mat image;           // CV_8UC1, a pixel per voxel
  Eigen::Vector2d corner;  // lower left, in the map [m]
};

Slice slice_of(const octomap::OcTree& tree, const HeightRange& heights) {
  const std::vector<Square> squares = squares_between(tree, heights);
  if (squares.empty())
    throw InputError::format("--occupancy-heights {:g} {:g}: nothing is known between them", heights.low_m,
                             heights.high_m);
  cv::Point low(squares.front().x, squares.front().y), high = low;
  for (const auto& [x, y, size, occupied] : squares) {
    low = {std::min(low.x, x), std::min(low.y, y)};
    high = {std::max(high.x, x + size), std::max(high.y, y + size)};
  }
  const cv::Size size(high - low);
  if (1.0 * size.width * size.height > kMostPixels)
    throw InputError::format("--occupancy-voxel {:g}: map.pgm would have {} x {} pixels; give a larger voxel",
                             tree.getResolution(), size.width, size.height);
  const auto corner_m = [&](int key) {
    return tree.keyToCoord(static_cast<octomap::key_type>(key)) - 0.5 * tree.getResolution();
  };
  Slice slice{cv::Mat(size, CV_8UC1, cv::Scalar(kUnknown)), {corner_m(low.x), corner_m(low.y)}};
  for (const Square& square : squares) {
    const cv::Rect place(square.x - low.x, high.y - square.y - square.size, square.size, square.size);
    slice.image(place).setTo(square.occupied ? kOccupied : kFree);
  }
  return slice;
}

/// Not by OctoMap's functions for whole files, which print to stderr.
std::string header_of(const char* kind, const octomap::OcTree& tree) {
  return fmt::format("{}\nid {}\nsize {}\nres {}\ndata\n", kind, tree.getTreeType(), tree.size(), tree.getResolution());
}

}  // namespace

octomap::OcTree occupancy_of(const Reconstruction& model, double voxel_m, std::span<const DenseScan> dense) {
  octomap::OcTree tree(voxel_m);
  for (const Reconstruction::Image& image : model.images) {
    const double noise_px = model.cameras[image.camera].modality == Modality::Events ? kEvents_px : kFrames_px;
    Scan scan(tree, image.T_W_C.translation());
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
    Scan scan(tree, of_image.from_W);
    for (const DenseScan::Point& point : of_image.points) scan.occupy(point.p_W, kDenseSigmas * point.sigma_m);
    scan.insert();
  }
  tree.updateInnerOccupancy();
  tree.prune();
  return tree;
}

std::string voxels_ply(const octomap::OcTree& tree) {
  std::string vertices;
  std::size_t count = 0;
  const auto edge_m = static_cast<float>(tree.getResolution());
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (!tree.isNodeOccupied(*leaf)) continue;
    const int edge = 1 << (tree.getTreeDepth() - leaf.getDepth());  // [voxels]: equal ones are one leaf
    const octomap::OcTreeKey first = leaf.getIndexKey();
    for (int i = 0; i < edge * edge * edge; ++i) {
      const auto at = [&](unsigned axis, int steps) {
        return static_cast<float>(tree.keyToCoord(static_cast<octomap::key_type>(first[axis] + steps)));
      };
      const std::array vertex = {at(0, i % edge), at(1, i / edge % edge), at(2, i / edge / edge), edge_m};
      vertices.append(reinterpret_cast<const char*>(vertex.data()), sizeof(vertex));
      ++count;
    }
  }
  return fmt::format(
             "ply\nformat binary_little_endian 1.0\ncomment centres of occupied voxels in the world (z up) [m]; size: "
             "their edge [m]\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty "
             "float size\nend_header\n",
             count) +
         vertices;
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
  const Slice slice = slice_of(tree, heights);
  write_picture(folder / "map.pgm", slice.image);
  // The map server takes 1 - v / 255 of a pixel v as the probability that it is occupied: of unknown ones 0.1961.
  write_file(folder / "map.yaml",
             fmt::format("image: map.pgm\nresolution: {}\norigin: [{:.6f}, {:.6f}, 0.0]\nnegate: 0\n"
                         "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
                         tree.getResolution(), slice.corner.x(), slice.corner.y()));
}

}  // namespace edged
