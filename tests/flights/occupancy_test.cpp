// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The occupancy map of a flight through a simulated room, against its true surfaces.
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iostream>
#include <limits>
#include <utility>
#include <vector>

#include "edged/camera/undistort.hpp"
#include "edged/eval/alignment.hpp"
#include "edged/occupancy/occupancy_scan.hpp"
#include "edged/pipeline/mode.hpp"
#include "edged/sim/scene/scene.hpp"
#include "end_to_end.hpp"
#include "scene/occupancy.hpp"

namespace edged {
namespace {

using Eigen::Vector3d;

constexpr double kVoxel_m = 0.05;

/// In the plane of the face: how far beyond its edges [m], 0 within.
Eigen::Vector2d beyond(const Face& face, const Vector3d& d) {
  return {std::max(0.0, std::abs(d.dot(face.u_W)) - face.half_u),
          std::max(0.0, std::abs(d.dot(face.v_W)) - face.half_v)};
}

/// To the nearest surface [m].
double distance(const Scene& scene, const Vector3d& p_W) {
  double nearest = std::numeric_limits<double>::max();
  for (const Face& face : scene.faces) {
    const Vector3d d = p_W - face.centre_W;
    nearest = std::min(nearest, std::hypot(d.dot(face.normal_W), beyond(face, d).norm()));
  }
  return nearest;
}

/// The first face on a ray.
struct Hit {
  double range_m = std::numeric_limits<double>::max();
  bool from_front = false;
};

Hit first_hit(const Scene& scene, const Vector3d& from_W, const Vector3d& direction_W) {
  Hit hit;
  for (const Face& face : scene.faces) {
    const double towards = face.normal_W.dot(direction_W);
    const double range_m = face.normal_W.dot(face.centre_W - from_W) / towards;
    if (range_m > 0.0 && range_m < hit.range_m &&
        beyond(face, from_W + range_m * direction_W - face.centre_W).isZero(0.0))
      hit = {range_m, towards < 0.0};
  }
  return hit;
}

/// Behind the walls of the room, or in a box: from there most rays meet faces from behind, or none.
bool is_solid(const Scene& scene, const Vector3d& p_W) {
  int behind = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const Vector3d direction = sign * Vector3d::Unit(axis) + Vector3d(0.01, 0.02, 0.03);
      behind += !first_hit(scene, p_W, direction.normalized()).from_front;
    }
  }
  return behind > 3;
}

struct MappedRoom {
  Reconstruction model;
  octomap::OcTree tree, dense_tree;  ///< the second: of dense points, too
  octomap::OcTree live_tree;         ///< of keyframes as they are marginalized, as the nodes publish it
  SE3 T_W_M;                         ///< the true world: of the final trajectory, laid onto the truth
};

MappedRoom map_of(const Flight& flight, Mode mode) {
  const OdometryConfig config;
  Odometry odometry(flight.calibration.rig, flight.calibration.imu, mode, config, {kInOrder});
  Reconstruction model;
  DenseMapper mapper;
  octomap::OcTree live_tree(kVoxel_m);
  const Rig used = used_cameras(flight.calibration.rig, mode, config.cameras);
  const std::vector<RigCamera> images = image_cameras(used);
  for (const RigCamera& camera : used.cameras)
    model.cameras.push_back({camera.name, ideal_pinhole(camera.model), camera.modality});
  drive(odometry, source_of(flight.measurements), [&](const Step& step) {
    if (!is_tracking(step.status)) return true;
    for (const KeyframeRecord& keyframe : step.marginalized_keyframes) insert_keyframe(live_tree, keyframe);
    if (step.keyframe) add_images(model, step);
    mapper.add(dense_instant(step, images, odometry.rig()));
    return true;
  });
  const Trajectory poses = odometry.final_trajectory().poses;
  place(model, poses, odometry.rig());
  triangulate(model);
  mapper.finish();
  const std::vector<DenseScan> dense = place(mapper.maps(), poses, odometry.rig());
  live_tree.updateInnerOccupancy();
  return {model, occupancy_of(model, kVoxel_m), occupancy_of(model, kVoxel_m, dense), live_tree,
          align_rigidly(associate(flight.truth->trajectory, poses).pairs).T};
}

/// What the voxels say against what is there.
struct Agreement {
  int occupied = 0, at_surface = 0;  ///< the second: its centre within a voxel of a surface
  int free = 0, solid = 0,
      behind = 0;           ///< free voxels in solid bodies, and those deeper than 5 cm: the middle of a wall of 10 cm
  double farthest_m = 0.0;  ///< an occupied voxel from the next surface
};

Agreement agreement(const MappedRoom& room, const octomap::OcTree& tree, const Scene& scene) {
  Agreement count;
  octomap::OcTree all = tree;
  all.expand();
  for (auto leaf = all.begin_leafs(); leaf != all.end_leafs(); ++leaf) {
    const Vector3d p_W = room.T_W_M * Vector3d(leaf.getX(), leaf.getY(), leaf.getZ());
    const double away_m = distance(scene, p_W);
    if (all.isNodeOccupied(*leaf)) {
      ++count.occupied;
      count.at_surface += away_m <= kVoxel_m;
      count.farthest_m = std::max(count.farthest_m, away_m);
    } else {
      const bool solid = is_solid(scene, p_W);
      ++count.free;
      count.solid += solid;
      count.behind += solid && away_m > 0.05;
    }
  }
  return count;
}

/// Whether a keyframe sees the place, with nothing in between.
bool is_seen(const MappedRoom& room, const Scene& scene, const Vector3d& p_W) {
  return std::ranges::any_of(room.model.images, [&](const Reconstruction::Image& image) {
    const SE3 T_W_C = room.T_W_M * image.T_W_C;
    const auto pixel = room.model.cameras[image.camera].pinhole.project(T_W_C.inverse() * p_W);
    if (!pixel || !room.model.cameras[image.camera].pinhole.contains(*pixel)) return false;
    const Vector3d ray = p_W - T_W_C.translation();
    return first_hit(scene, T_W_C.translation(), ray.normalized()).range_m > ray.norm() - 0.001;
  });
}

/// The known shares of the surface and of the free space that keyframes see, each in steps of 0.15 m.
struct Completeness {
  int surface = 0, occupied = 0, space = 0, free = 0;
};

Completeness completeness(const MappedRoom& room, const octomap::OcTree& tree, const Scene& scene) {
  constexpr double kStep_m = 0.15;
  const SE3 T_M_W = room.T_W_M.inverse();
  const auto state_near = [&](const Vector3d& p_W, int reach, bool occupied) {
    const Vector3d p_M = T_M_W * p_W;
    for (int i = -reach; i <= reach; ++i)
      for (int j = -reach; j <= reach; ++j)
        for (int k = -reach; k <= reach; ++k) {
          const octomap::OcTreeNode* node =
              tree.search(p_M.x() + i * kVoxel_m, p_M.y() + j * kVoxel_m, p_M.z() + k * kVoxel_m);
          if (node && room.tree.isNodeOccupied(node) == occupied) return true;
        }
    return false;
  };
  Completeness share;
  Vector3d low = scene.faces.front().centre_W, high = low;
  for (const Face& face : scene.faces) {
    low = low.cwiseMin(face.centre_W), high = high.cwiseMax(face.centre_W);
    for (double u = 0.5 * kStep_m - face.half_u; u < face.half_u; u += kStep_m) {
      for (double v = 0.5 * kStep_m - face.half_v; v < face.half_v; v += kStep_m) {
        const Vector3d p_W = face.centre_W + u * face.u_W + v * face.v_W;
        if (!is_seen(room, scene, p_W)) continue;
        ++share.surface;
        share.occupied += state_near(p_W, 1, true);
      }
    }
  }
  for (double x = low.x(); x < high.x(); x += kStep_m) {
    for (double y = low.y(); y < high.y(); y += kStep_m) {
      for (double z = low.z(); z < high.z(); z += kStep_m) {
        if (is_solid(scene, {x, y, z}) || !is_seen(room, scene, {x, y, z})) continue;
        ++share.space;
        share.free += state_near({x, y, z}, 0, false);
      }
    }
  }
  return share;
}

TEST(OccupancyOfARoom, IsOccupiedAtTrueSurfacesAndNotFreeThroughWalls) {
  SimulatorConfig config = simulator_preset("room");
  config.seed = 5;
  config.duration_s = 10.0;
  Simulator simulator(config);
  const Flight flight = read_flight(simulator, simulator.calibration());
  for (const Mode mode : kAllModes) {
    const MappedRoom room = map_of(flight, mode);
    const std::initializer_list<std::pair<const char*, const octomap::OcTree*>> trees = {
        {"", &room.tree}, {", dense", &room.dense_tree}, {", live", &room.live_tree}};
    for (const auto& [kind, tree] : trees) {
      const bool dense = tree == &room.dense_tree;
      const Agreement count = agreement(room, *tree, simulator.scene());
      const Completeness share = completeness(room, *tree, simulator.scene());
      const std::string what = mode_name(mode) + kind;
      std::cout << fmt::format(
          "{}: {} of {} occupied voxels within a voxel of a surface, the farthest {:.0f} mm; {} free ones, {} in solid "
          "bodies, {} deeper than 5 cm; of what keyframes show, {:.1f} % of the surface is occupied, {:.0f} % of the "
          "space free\n",
          what, count.at_surface, count.occupied, 1e3 * count.farthest_m, count.free, count.solid, count.behind,
          100.0 * share.occupied / share.surface, 100.0 * share.free / share.space);
      EXPECT_GE(count.occupied, dense && mode != Mode::Events ? 300 : 10) << what;
      EXPECT_GE(count.at_surface, 0.95 * count.occupied) << what;
      EXPECT_GE(count.free, 5000) << what;
      EXPECT_LE(count.solid, 0.001 * count.free) << what;
      EXPECT_EQ(count.behind, 0) << what;
    }
  }
}

}  // namespace
}  // namespace edged
