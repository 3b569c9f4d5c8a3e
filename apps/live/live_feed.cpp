// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "live/live_feed.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/json_text.hpp"
#include "common/pictures.hpp"
#include "common/step_numbers.hpp"
#include "report/report_rows.hpp"
#include "report/states_table.hpp"

namespace edged {
namespace {

using LiveClockTime = std::chrono::steady_clock;
constexpr auto kShotPeriod = std::chrono::milliseconds(150), kMapPeriod = std::chrono::milliseconds(2000);
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr int kWidestShot_px = 640;

/// Position, angles, plot_columns(), and three sigmas of the position.
std::vector<PlotColumn> live_columns() {
  std::vector<PlotColumn> columns = {{"", "x", 5},    {"", "y", 5},     {"", "z", 5},
                                     {"", "roll", 3}, {"", "pitch", 3}, {"", "yaw", 3}};
  columns.insert(columns.end(), plot_columns().begin(), plot_columns().end());
  for (const char* sigma : {"sigma3_x", "sigma3_y", "sigma3_z"}) columns.push_back({"", sigma, 6});
  return columns;
}

/// The numbers of plot_columns().
std::vector<double> plot_numbers(const Step& step, const PacketPace& pace) {
  static const std::vector<std::string> kNames = state_columns();
  const std::vector<double> numbers = state_numbers(step);
  std::vector<double> chosen;
  for (const PlotColumn& column : plot_columns()) {
    const auto name = std::ranges::find(kNames, column.from);
    chosen.push_back(name != kNames.end() ? numbers[static_cast<std::size_t>(name - kNames.begin())]
                     : column.from == std::string_view("latency_ms") ? pace.latency_ms.value_or(kUnknown)
                                                                     : pace.processing_ms);
  }
  return chosen;
}

nlohmann::ordered_json progress_json(const RunProgress& progress) {
  const RunStatistics& s = progress.statistics;
  const double span = s.visual_span_s();
  const RunStatistics::Overload overload = s.overload();
  return {{"poses", s.poses()},
          {"keyframes", s.keyframes()},
          {"packets", s.packets()},
          {"coverage", s.coverage()},
          {"first_good_s", value_or_null(s.first_good_s())},
          {"times_lost", s.times_lost()},
          {"duration_s", span},
          {"overload", overload.share >= kToldOverload ? overload.text : ""},
          {"real_time_factor", progress.wall_s > 0.0 ? span / progress.wall_s : 0.0}};
}

}  // namespace

LiveFeed::LiveFeed(std::string frame, const LivePoints& dense)
    : frame_(std::move(frame)), dense_(dense), angles_(Eigen::Vector3d::Constant(kUnknown)) {
  newest_.values.assign(live_columns().size(), kUnknown);
}

LiveFeed::Row LiveFeed::row_of(const Step& step, const PacketPace& pace) {
  Row row{to_seconds(step.t - *origin_), step.status, {}};
  const auto put = [&row](const Eigen::Vector3d& v, bool known) {
    for (int k = 0; k < 3; ++k) row.values.push_back(known ? v[k] : kUnknown);
  };
  const bool tracking = is_tracking(step.status);
  if (tracking) angles_ = angles_deg(step.state.T_W_B, angles_);
  put(step.pose_of(frame_).T.translation(), tracking);
  put(angles_, tracking);
  const std::vector<double> numbers = plot_numbers(step, pace);
  row.values.insert(row.values.end(), numbers.begin(), numbers.end());
  const Eigen::Matrix3d covariance = step.covariance ? step.covariance->position : Eigen::Matrix3d::Zero();
  put(3.0 * covariance.diagonal().cwiseSqrt(), step.covariance.has_value());
  return row;
}

void LiveFeed::add(const Step& step, RunProgress progress, const Snapshots& snapshots) {
  if (!origin_) origin_ = step.t;
  const Row row = row_of(step, progress.pace);
  if (viewers_ > 0) take_shots(step);
  const std::lock_guard lock(mutex_);
  newest_ = row;
  reason_ = reason_of(step);
  progress_ = std::move(progress);
  changes_.add(step);
  rows_.add(row);
  const auto now = LiveClockTime::now();
  if (viewers_ == 0 || now < map_taken_ + kMapPeriod) return;
  map_taken_ = now;
  ++map_number_;
  map_.clear();
  for (const auto& [id, point] : snapshots.points()) map_.insert(map_.end(), point.begin(), point.end());
}

/// Copies of the images, at the rate of a viewer, as the odometry continues with the originals. Only this thread
/// changes the shots.
void LiveFeed::take_shots(const Step& step) {
  const auto now = LiveClockTime::now();
  for (const CameraStep& camera : step.cameras) {
    const bool first = &camera == step.find(camera.modality);
    const std::string name = !first ? camera.name : camera.modality == Modality::Events ? "events" : "frame";
    const auto before = shots_.find(name);
    const bool any = before != shots_.end();
    if (camera.image.empty() || (any && now < before->second->taken + kShotPeriod)) continue;
    auto taken = std::make_shared<const Shot>(
        Shot{any ? before->second->number + 1 : 1, now, camera.image.clone(), camera.tracks});
    const std::lock_guard lock(mutex_);
    shots_[name] = std::move(taken);
  }
}

void LiveFeed::finish(RunProgress progress) {
  const std::lock_guard lock(mutex_);
  progress_ = std::move(progress);
}

LiveFeed::Present LiveFeed::present(Place& place) const {
  const std::lock_guard lock(mutex_);
  const std::vector<StatusChange>& changes = changes_.all();
  const auto known = [](std::size_t n) { return static_cast<std::ptrdiff_t>(n); };
  const std::size_t shown = std::min(changes.size(), kMostChangesShown);
  if (place.halvings != rows_.halvings()) place.rows = 0;
  Present now{newest_,
              reason_,
              progress_,
              place.rows,
              place.changes,
              {rows_.all().begin() + known(place.rows), rows_.all().end()},
              {changes.begin() + known(place.changes), changes.begin() + known(shown)},
              {}};
  for (const char* kind : {"events", "frame"}) now.shots[kind] = 0;
  for (const auto& [name, shot] : shots_) now.shots[name] = shot->number;
  if (place.map != map_number_) now.new_map = map_;
  place.rows = rows_.all().size();
  place.halvings = rows_.halvings();
  place.changes = shown > 0 ? shown - 1 : 0;  // the last one's reason may change
  place.map = map_number_;
  return now;
}

nlohmann::ordered_json LiveFeed::columns(const std::vector<Row>& rows) {
  nlohmann::ordered_json json = {{"t", nlohmann::ordered_json::array()}, {"status", nlohmann::ordered_json::array()}};
  for (const Row& row : rows) {
    json["t"].push_back(rounded(row.t, 4));
    json["status"].push_back(to_string(row.status));
  }
  const std::vector<PlotColumn> all = live_columns();
  for (std::size_t k = 0; k < all.size(); ++k) {
    auto& column = json[all[k].name] = nlohmann::ordered_json::array();
    for (const Row& row : rows) column.push_back(rounded(row.values[k], all[k].decimals));
  }
  return json;
}

std::string LiveFeed::news(Place& place) const {
  const Present now = present(place);
  nlohmann::ordered_json json = {{"t", rounded(now.newest.t, 4)},
                                 {"status", to_string(now.newest.status)},
                                 {"reason", now.reason},
                                 {"left_out", place.left_out},
                                 {"progress", progress_json(now.progress)},
                                 {"newest", columns({now.newest})},
                                 {"rows_from", now.rows},
                                 {"rows", columns(now.new_rows)},
                                 {"changes_from", now.changes},
                                 {"changes", nlohmann::ordered_json::array()},
                                 {"pictures", now.shots}};
  for (const StatusChange& change : now.new_changes) {
    json["changes"].push_back({{"t", rounded(to_seconds(change.t - *origin_), 4)},
                               {"status", to_string(change.status)},
                               {"reason", change.reason},
                               {"relocalized", change.relocalized}});
  }
  if (!now.new_map.empty()) {
    auto& map = json["map"] = nlohmann::ordered_json::array();
    for (const float x : now.new_map) map.push_back(rounded(x, 3));
  }
  if (nlohmann::ordered_json dense = dense_.news(place.dense); !dense.is_null()) json["dense"] = std::move(dense);
  if (nlohmann::ordered_json voxels = dense_.new_voxels(place.dense); !voxels.is_null())
    json["voxels"] = std::move(voxels);
  return compact_json(json);
}

std::vector<unsigned char> LiveFeed::picture(const std::string& of) const {
  std::shared_ptr<const Shot> shot;
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = shots_.find(of); found != shots_.end()) shot = found->second;
  }
  return shot ? track_picture(shot->image, shot->tracks, kWidestShot_px) : std::vector<unsigned char>{};
}

}  // namespace edged
