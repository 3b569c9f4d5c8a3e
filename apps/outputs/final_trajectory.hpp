// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The final results of a run as files: the final trajectory and the map.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "edged/camera/output_frame.hpp"
#include "edged/final_trajectory.hpp"

namespace edged {

/// trajectory_final.tum with the poses of `frame`, keyframes.csv and map.ply with those of the body. comments head the
/// first. All are valid even without a map or poses.
void write_final_trajectory(const std::filesystem::path& folder, const OutputFrame& frame, const FinalTrajectory& known,
                            const std::vector<std::string>& comments);

/// The points of keyframes, for viewers of point clouds.
std::string map_ply(const std::vector<MappedKeyframe>& keyframes);

}  // namespace edged
