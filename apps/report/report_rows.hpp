// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// States, errors, map and changes of status of one run as columns of json, thinned out and rounded to what a plot
// shows.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "report/report_path.hpp"
#include "report/states_table.hpp"

namespace edged {

/// A column of states.csv or pace.csv, and its name and decimals in a plot.
struct PlotColumn {
  const char* from;
  const char* name;
  int decimals;
};
std::span<const PlotColumn> plot_columns();

/// Roll, pitch, yaw [deg] about x, y, z: R = Rz Ry Rx. Unwrapped: without jumps from one to the next.
Eigen::Vector3d angles_deg(const SE3& T, const Eigen::Vector3d& before);

/// A subset of rows: evenly spaced, with the largest error and, unless they are too frequent, each change of status.
std::vector<std::size_t> chosen_rows(const StatesTable& states, const std::vector<double>& error, std::size_t most);

/// Times [s] since origin; null where a row has no pose.
nlohmann::ordered_json rows_json(const StatesTable& states, const AlignedPath& path, Timestamp origin,
                                 std::size_t most);
nlohmann::ordered_json pose_errors_json(const std::vector<PoseErrorSample>& pose_errors, Timestamp origin,
                                        std::size_t most);
/// x, y, z of point after point in the world that is shown.
nlohmann::ordered_json path_json(const Trajectory& path, std::size_t most);
nlohmann::ordered_json map_json(const nlohmann::ordered_json& album, const Similarity& alignment);
/// The first 300 changes of status, from album.json of the run, without one from states.csv.
nlohmann::ordered_json changes_json(const StatesTable& states, const nlohmann::ordered_json& album, Timestamp origin);

/// The samples of external.csv, by sensor: `t` [s since origin] and `y`, its value, of several their norm. At most so
/// many samples of each; empty without the file.
nlohmann::ordered_json external_json(const std::filesystem::path& folder, Timestamp origin, std::size_t most);

}  // namespace edged
