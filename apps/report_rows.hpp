// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// States, errors, map and changes of status of one run as columns of json, thinned out and rounded to what a plot
// shows.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "report_path.hpp"
#include "states_table.hpp"

namespace edged {

/// A number with so many decimals takes little room as text; null where it is none.
nlohmann::ordered_json rounded(double value, int decimals);

/// Roll, pitch, yaw [deg] about x, y, z: R = Rz Ry Rx. Each without jumps against the one before.
Eigen::Vector3d angles_deg(const SE3& T, const Eigen::Vector3d& before);

/// Which rows stand for all: evenly chosen, but the largest error among them and, unless it flutters, each change of
/// status.
std::vector<std::size_t> chosen_rows(const StatesTable& states, const std::vector<double>& error, std::size_t most);

/// Times [s] since origin; null where a row has no pose.
nlohmann::ordered_json rows_json(const StatesTable& states, const ReportPath& path, Timestamp origin, std::size_t most);
nlohmann::ordered_json pose_errors_json(const std::vector<PoseErrorSample>& pose_errors, Timestamp origin,
                                        std::size_t most);
/// x, y, z of point after point in the world that is shown.
nlohmann::ordered_json path_json(const Trajectory& path, std::size_t most);
nlohmann::ordered_json map_json(const nlohmann::ordered_json& album, const Similarity& alignment);
/// As noted while it ran; without an album those that states.csv tells. The first 300.
nlohmann::ordered_json changes_json(const StatesTable& states, const nlohmann::ordered_json& album, Timestamp origin);

}  // namespace edged
