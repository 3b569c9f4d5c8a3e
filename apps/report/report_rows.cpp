// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "report/report_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/json_text.hpp"
#include "common/step_numbers.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Columns of the poses, by row of states.csv; NaN where a row has none.
class PathColumns {
 public:
  PathColumns(std::size_t rows, const AlignedPath& path) {
    for (auto* group : {&p_, &angles_, &true_p_, &true_angles_}) group->assign(rows, Eigen::Vector3d::Constant(kNone));
    error_.assign(rows, kNone);
    rotation_.assign(rows, kNone);
    Eigen::Vector3d before = Eigen::Vector3d::Constant(kNone);
    for (std::size_t i = 0; i < path.rows.size(); ++i) {
      const std::size_t row = path.rows[i];
      p_[row] = path.shown[i].T.translation();
      before = angles_[row] = angles_deg(path.body[i].T, before);
      if (path.truth[i]) {
        true_p_[row] = path.truth[i]->translation();
        true_angles_[row] = angles_deg(*path.true_body[i], angles_[row]);
      }
      error_[row] = path.error_m[i];
      rotation_[row] = path.rotation_deg[i];
    }
  }

  const std::vector<double>& error() const { return error_; }

  void write(Json& json, const std::vector<std::size_t>& chosen) const {
    constexpr std::array kAxes = {"x", "y", "z"}, kAngles = {"roll", "pitch", "yaw"};
    const bool compared = std::ranges::any_of(error_, [](double e) { return std::isfinite(e); });
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      for (const std::size_t row : chosen) {
        json[kAxes[i]].push_back(rounded(p_[row][k], 5));
        json[kAngles[i]].push_back(rounded(angles_[row][k], 3));
        if (!compared) continue;
        json[std::string("true_") + kAxes[i]].push_back(rounded(true_p_[row][k], 5));
        json[std::string("true_") + kAngles[i]].push_back(rounded(true_angles_[row][k], 3));
      }
    }
    for (const std::size_t row : chosen) {
      if (!compared) break;
      json["error_m"].push_back(rounded(error_[row], 6));
      json["rotation_error_deg"].push_back(rounded(rotation_[row], 4));
    }
  }

 private:
  std::vector<Eigen::Vector3d> p_, angles_, true_p_, true_angles_;
  std::vector<double> error_, rotation_;
};

constexpr PlotColumn kPlotColumns[] = {{"vx_mps", "vx", 4},
                                       {"vy_mps", "vy", 4},
                                       {"vz_mps", "vz", 4},
                                       {"bgx_radps", "bgx", 6},
                                       {"bgy_radps", "bgy", 6},
                                       {"bgz_radps", "bgz", 6},
                                       {"bax_mps2", "bax", 5},
                                       {"bay_mps2", "bay", 5},
                                       {"baz_mps2", "baz", 5},
                                       {"keyframe", "keyframe", 0},
                                       {"event_tracks", "event_tracks", 0},
                                       {"frame_tracks", "frame_tracks", 0},
                                       {"landmarks", "landmarks", 0},
                                       {"event_track_survival_rate", "event_track_survival_rate", 3},
                                       {"frame_track_survival_rate", "frame_track_survival_rate", 3},
                                       {"map_matches", "map_matches", 0},
                                       {"map_reach_s", "map_reach", 2},
                                       {"event_rate_hz", "event_rate", 0},
                                       {"scene_depth_m", "depth", 3},
                                       {"processing_ms", "processing", 3},
                                       {"latency_ms", "latency", 3}};

}  // namespace

std::span<const PlotColumn> plot_columns() { return kPlotColumns; }

Eigen::Vector3d angles_deg(const SE3& T, const Eigen::Vector3d& before) {
  const Eigen::Matrix3d R = T.R();
  Eigen::Vector3d angles(std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)),
                         std::atan2(R(1, 0), R(0, 0)));
  angles *= kDegreesPerRadian;
  for (int i = 0; i < 3; ++i) {
    if (std::isfinite(before[i])) angles[i] += 360.0 * std::round((before[i] - angles[i]) / 360.0);
  }
  return angles;
}

std::vector<std::size_t> chosen_rows(const StatesTable& states, const std::vector<double>& error, std::size_t most) {
  const std::size_t n = states.t.size(), stride = n / std::max<std::size_t>(1, most) + 1;
  std::size_t worst = n;
  for (std::size_t i = 0; i < n; ++i) {
    if (std::isfinite(error[i]) && (worst == n || error[i] > error[worst])) worst = i;
  }
  std::vector<std::size_t> even, chosen;
  for (std::size_t i = 0; i < n; ++i) {
    const bool begins = i > 0 && states.status[i] != states.status[i - 1];
    const bool ends = i + 1 == n || states.status[i] != states.status[i + 1];
    if (i % stride == 0 || i == worst) even.push_back(i);
    if (i % stride == 0 || begins || ends || i == worst) chosen.push_back(i);
  }
  return chosen.size() > most + most / 2 ? even : chosen;
}

Json rows_json(const StatesTable& states, const AlignedPath& path, Timestamp origin, std::size_t most) {
  const PathColumns poses(states.t.size(), path);
  const std::vector<std::size_t> chosen = chosen_rows(states, poses.error(), most);
  Json json = {{"t", Json::array()}, {"status", Json::array()}};
  for (const std::size_t row : chosen) {
    json["t"].push_back(rounded(to_seconds(states.t[row] - origin), 4));
    json["status"].push_back(to_string(states.status[row]));
  }
  poses.write(json, chosen);
  for (const auto& [from, to, decimals] : kPlotColumns) {
    const std::vector<double>* column = states.find(from);
    if (!column) continue;
    for (const std::size_t row : chosen) json[to].push_back(rounded((*column)[row], decimals));
  }
  constexpr std::array kVariances = {"p_xx_m2", "p_yy_m2", "p_zz_m2"}, kSigmas = {"sigma3_x", "sigma3_y", "sigma3_z"};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<double>* variance = states.find(kVariances[i]);
    if (!variance) continue;
    for (const std::size_t row : chosen) json[kSigmas[i]].push_back(rounded(3.0 * std::sqrt((*variance)[row]), 6));
  }
  return json;
}

Json pose_errors_json(const std::vector<PoseErrorSample>& pose_errors, Timestamp origin, std::size_t most) {
  constexpr std::array kErrors = {"x", "y", "z"}, kSigmas = {"sigma3_x", "sigma3_y", "sigma3_z"};
  Json json = Json::object();
  const std::size_t stride = pose_errors.size() / std::max<std::size_t>(1, most) + 1;
  for (std::size_t i = 0; i < pose_errors.size(); i += stride) {
    json["t"].push_back(rounded(to_seconds(pose_errors[i].t - origin), 4));
    for (int k = 0; k < 3; ++k) {
      json[kErrors[static_cast<std::size_t>(k)]].push_back(rounded(pose_errors[i].error[k], 6));
      json[kSigmas[static_cast<std::size_t>(k)]].push_back(rounded(3.0 * pose_errors[i].sigma[k], 6));
    }
  }
  return json;
}

Json path_json(const Trajectory& path, std::size_t most) {
  Json json = Json::array();
  const std::size_t stride = path.size() / std::max<std::size_t>(1, most) + 1;
  for (std::size_t i = 0; i < path.size(); i += stride) {
    for (int k = 0; k < 3; ++k) json.push_back(rounded(path[i].T.translation()[k], 4));
  }
  return json;
}

Json map_json(const Json& album, const Similarity& alignment) {
  Json json = Json::array();
  if (album.is_null()) return json;
  const auto points = album.at("points").get<std::vector<double>>();
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
    const Eigen::Vector3d p = alignment * Eigen::Vector3d(points[i], points[i + 1], points[i + 2]);
    for (int k = 0; k < 3; ++k) json.push_back(rounded(p[k], 3));
  }
  return json;
}

Json changes_json(const StatesTable& states, const Json& album, Timestamp origin) {
  Json json = Json::array();
  const auto add = [&](Timestamp t, const std::string& status, const std::string& reason, bool relocalized) {
    if (json.size() == kMostChangesShown) return;
    json.push_back({{"t", rounded(to_seconds(t - origin), 4)},
                    {"status", status},
                    {"reason", reason},
                    {"relocalized", relocalized}});
  };
  if (!album.is_null()) {
    for (const Json& change : album.at("changes")) {
      add(timestamp_from_ns(change.at("t_ns").get<std::int64_t>()), change.at("status"), change.at("reason"),
          change.value("relocalized", false));
    }
    return json;
  }
  const std::vector<double>* relocalized = states.find("relocalized");
  for (std::size_t i = 0; i < states.t.size(); ++i) {
    const bool found = relocalized && (*relocalized)[i] == 1.0;
    if (i == 0 || states.status[i] != states.status[i - 1] || found)
      add(states.t[i], to_string(states.status[i]), "", found);
  }
  return json;
}

Json external_json(const std::filesystem::path& folder, Timestamp origin, std::size_t most) {
  Json json = Json::object();
  const std::filesystem::path file = folder / "external.csv";
  if (!std::filesystem::exists(file)) return json;
  std::map<std::string, std::vector<std::pair<double, double>>> samples;
  LineReader lines(file);
  while (const auto line = lines.next()) {
    FieldReader fields(line->text);
    const ExternalSensor* sensor = find_external_sensor(fields.next());
    const auto t = parse_nanoseconds(fields.next());
    if (!sensor || !t) continue;  // the heading, or half a line that a kill has left
    double first = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < sensor->columns.size(); ++i) {
      const double value = parse_number(fields.next()).value_or(0.0);
      if (i == 0) first = value;
      squares += value * value;
    }
    samples[std::string(sensor->name)].emplace_back(to_seconds(*t - origin),
                                                    sensor->columns.size() == 1 ? first : std::sqrt(squares));
  }
  for (const auto& [sensor, all] : samples) {
    const std::size_t stride = all.size() / std::max<std::size_t>(1, most) + 1;
    for (std::size_t i = 0; i < all.size(); i += stride) {
      json[sensor]["t"].push_back(rounded(all[i].first, 4));
      json[sensor]["y"].push_back(rounded(all[i].second, 4));
    }
  }
  return json;
}

}  // namespace edged
