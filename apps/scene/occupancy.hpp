// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Occupied, free and unknown space around the points of a reconstruction, as files of OctoMap and of the ROS map
// server.
#pragma once

#include <octomap/OcTree.h>

#include <filesystem>
#include <span>
#include <string>

#include "edged/occupancy/occupancy_slice.hpp"
#include "scene/dense_scan.hpp"
#include "scene/reconstruction.hpp"

namespace edged {

/// The map of points with four observations and more: voxels of those whose depth is known to half a voxel are
/// occupied, by how likely they hold it. The rays to all of them are free up to a voxel and three sigmas before the
/// point. What no ray crosses stays unknown. Dense points of frames only make voxels occupied. voxel_m: edge of a voxel
/// [m].
octomap::OcTree occupancy_of(const Reconstruction& model, double voxel_m, std::span<const DenseScan> dense = {});

/// The occupied voxels: centres and edge, binary.
std::string voxels_ply(const octomap::OcTree& tree);

/// occupancy.ot (with probabilities) and occupancy.bt (occupied or free) of OctoMap; for the ROS map server map.pgm and
/// map.yaml, what lies between two heights: a pixel is occupied if a voxel there is, else free if one is. Throws
/// InputError if they cannot be written, or map.pgm would have more than 1e9 pixels.
void write_occupancy(const std::filesystem::path& folder, const octomap::OcTree& tree, const HeightRange& heights);

}  // namespace edged
