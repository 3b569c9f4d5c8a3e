// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Many points of a run: PLY files, and thinned out and packed into 16 bits a coordinate for its page.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace edged {

struct PointCloud {
  std::vector<Eigen::Vector3f> points;  ///< [m]
  std::vector<std::uint8_t> grey;       ///< of each point; empty where the points have no colour
  float size_m = 0.0F;                  ///< edge of the voxels whose centres the points are; 0: they are points
  std::size_t all = 0;                  ///< number of points before they were thinned out
};

/// The header of a PLY file of vertices. properties: such as "float x, uchar red".
std::string ply_header(bool binary, const std::vector<std::string>& comments, std::size_t count,
                       const std::string& properties);

/// The points of dense.ply or voxels.ply, at most so many points, evenly chosen; none where there is no such file.
/// Throws InputError if the file is damaged.
PointCloud read_cloud(const std::filesystem::path& file, std::size_t most);

/// "low" and "step": the corner of their box and 1/65535 of its edges; "xyz" and "grey": base64 of 16 bits for each
/// coordinate (little-endian), and of a byte for each point.
nlohmann::ordered_json packed_json(const std::vector<Eigen::Vector3f>& points, const std::vector<std::uint8_t>& grey);

}  // namespace edged
