// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "report/states_table.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "common/step_numbers.hpp"
#include "edged/core/check.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kStateColumns =
    "px_m,py_m,pz_m,qx,qy,qz,qw,vx_mps,vy_mps,vz_mps,bgx_radps,bgy_radps,bgz_radps,bax_mps2,bay_mps2,baz_mps2,keyframe,"
    "relocalized,event_tracks,frame_tracks,landmarks,event_track_survival_rate,frame_track_survival_rate,map_matches,"
    "map_reach_s,event_rate_hz,scene_depth_m,depth_scale,depth_scale_sigma_ln,p_xx_m2,p_xy_m2,p_xz_m2,p_yy_m2,p_yz_m2,"
    "p_zz_m2,r_xx_rad2,r_xy_rad2,r_xz_rad2,r_yy_rad2,r_yz_rad2,r_zz_rad2,v_xx_m2ps2,v_xy_m2ps2,v_xz_m2ps2,v_yy_m2ps2,"
    "v_yz_m2ps2,v_zz_m2ps2";

/// A line of numbers, filled from the left.
class StateNumbers {
 public:
  void put(double number) { numbers_.push_back(number); }
  void put(const std::optional<double>& number) { put(number.value_or(kNoNumber)); }
  void put(const Eigen::Vector3d& v) { numbers_.insert(numbers_.end(), v.begin(), v.end()); }
  void put(const Eigen::Quaterniond& q) { numbers_.insert(numbers_.end(), {q.x(), q.y(), q.z(), q.w()}); }
  /// The upper triangle, row by row.
  void put(const Eigen::Matrix3d& P) {
    numbers_.insert(numbers_.end(), {P(0, 0), P(0, 1), P(0, 2), P(1, 1), P(1, 2), P(2, 2)});
  }
  void skip(std::size_t count) { numbers_.insert(numbers_.end(), count, kNoNumber); }
  std::vector<double> take() { return std::move(numbers_); }

 private:
  std::vector<double> numbers_;
};

/// Pose, velocity and biases; before the start of the estimate the attitude alone.
void put_state(StateNumbers& row, const Step& step) {
  if (step.status == TrackingStatus::Initializing) {
    row.skip(3);
    step.attitude ? row.put(step.attitude->R_W_B) : row.skip(4);
    row.skip(9);
    return;
  }
  row.put(step.state.T_W_B.translation());
  row.put(step.state.T_W_B.rotation());
  row.put(step.state.v_W);
  row.put(step.state.bias_gyro);
  row.put(step.state.bias_accel);
}

void put_covariance(StateNumbers& row, const Step& step) {
  if (step.covariance) {
    row.put(step.covariance->position);
    row.put(step.covariance->rotation);
    row.put(step.covariance->velocity);
    return;
  }
  row.skip(6);
  step.attitude ? row.put(step.attitude->covariance) : row.skip(6);
  row.skip(6);
}

std::optional<TrackingStatus> parse_status(std::string_view text) {
  for (const auto status :
       {TrackingStatus::Initializing, TrackingStatus::Good, TrackingStatus::Degraded, TrackingStatus::Lost}) {
    if (text == to_string(status)) return status;
  }
  return std::nullopt;
}

/// The numbers of these columns by row; nothing where one of them is missing or empty.
template <std::size_t N>
auto numbers_of(const StatesTable& states, const std::array<const char*, N>& names) {
  std::array<const std::vector<double>*, N> columns;
  std::ranges::transform(names, columns.begin(), [&](const char* name) { return states.find(name); });
  return [columns](std::size_t row) -> std::optional<std::array<double, N>> {
    std::array<double, N> numbers;
    for (std::size_t i = 0; i < N; ++i) {
      if (!columns[i] || std::isnan((*columns[i])[row])) return std::nullopt;
      numbers[i] = (*columns[i])[row];
    }
    return numbers;
  };
}

/// use(row, T_W_B) of each row that has a pose.
template <typename Use>
void for_each_pose(const StatesTable& states, Use use) {
  const auto numbers = numbers_of<7>(states, {"px_m", "py_m", "pz_m", "qx", "qy", "qz", "qw"});
  for (std::size_t row = 0; row < states.t.size(); ++row) {
    const auto v = numbers(row);
    if (v) use(row, SE3(Eigen::Quaterniond(v->data() + 3), Eigen::Vector3d(v->data())));
  }
}

/// The upper triangle, row by row.
Eigen::Matrix3d symmetric(const double* v) {
  Eigen::Matrix3d P;
  P << v[0], v[1], v[2], v[1], v[3], v[4], v[2], v[4], v[5];
  return P;
}

}  // namespace

std::vector<std::string> state_columns() { return heading_fields(kStateColumns); }

std::vector<double> state_numbers(const Step& step) {
  const ModalityNumbers events = modality_numbers(step, Modality::Events),
                        frames = modality_numbers(step, Modality::Frames);
  StateNumbers row;
  put_state(row, step);
  for (const double number :
       {step.keyframe ? 1.0 : 0.0, step.relocalized ? 1.0 : 0.0, static_cast<double>(events.tracks),
        static_cast<double>(frames.tracks), static_cast<double>(step.landmarks.size())})
    row.put(number);
  row.put(events.survival_rate);
  row.put(frames.survival_rate);
  const std::optional<double> reach_s = map_reach_s(step);
  row.put(reach_s ? static_cast<double>(step.map_matches.size()) : kNoNumber);
  row.put(reach_s);
  row.put(events.event_rate_hz);
  row.put(step.scene_depth);
  const auto& ln_s = step.ln_depth_scale;
  row.put(ln_s ? std::exp(ln_s->value) : kNoNumber);
  row.put(ln_s ? ln_s->sigma : kNoNumber);
  put_covariance(row, step);
  return row.take();
}

std::string states_heading() {
  return fmt::format(
      "# state of the body (IMU) in the world (z up), stamps on the IMU clock, whatever the trajectory's frame\n"
      "t_ns,status,{}\n",
      kStateColumns);
}

std::string state_line(const Step& step) {
  std::string line = fmt::format("{},{}", to_ns(step.t), to_string(step.status));
  for (const double number : state_numbers(step)) line += std::isnan(number) ? "," : fmt::format(",{}", number);
  return line + '\n';
}

const std::vector<double>* StatesTable::find(const std::string& column) const {
  const auto found = columns.find(column);
  return found == columns.end() ? nullptr : &found->second;
}

StatesTable read_states(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "states.csv";
  LineReader lines(file);
  const auto heading = lines.next();
  const std::vector<std::string> names = heading ? heading_fields(heading->text) : std::vector<std::string>();
  if (names.size() < 2 || names[0] != "t_ns" || names[1] != "status") {
    throw InputError::format("{}: is not the states.csv of a run; give the folder that `edged run` left",
                             file.string());
  }
  StatesTable table;
  std::vector<std::vector<double>*> columns;
  for (std::size_t i = 2; i < names.size(); ++i) columns.push_back(&table.columns[names[i]]);
  while (const auto line = lines.next()) {
    FieldReader fields(line->text);
    const auto t = parse_nanoseconds(fields.next());
    const auto status = parse_status(fields.next());
    if (!t || !status || std::ranges::count(line->text, ',') + 1 != std::ssize(names)) continue;
    table.t.push_back(*t);
    table.status.push_back(*status);
    for (auto* column : columns) {
      column->push_back(parse_number(fields.next()).value_or(kNoNumber));
    }
  }
  return table;
}

Trajectory body_poses(const StatesTable& states, std::vector<std::size_t>* rows) {
  Trajectory body;
  for_each_pose(states, [&](std::size_t row, const SE3& T_W_B) {
    if (!is_tracking(states.status[row])) return;
    body.push_back({states.t[row], T_W_B});
    if (rows) rows->push_back(row);
  });
  return body;
}

std::vector<StateCovarianceSample> covariance_samples_of(const StatesTable& states) {
  const auto covariance =
      numbers_of<12>(states, {"p_xx_m2", "p_xy_m2", "p_xz_m2", "p_yy_m2", "p_yz_m2", "p_zz_m2", "r_xx_rad2",
                              "r_xy_rad2", "r_xz_rad2", "r_yy_rad2", "r_yz_rad2", "r_zz_rad2"});
  const auto velocity = numbers_of<3>(states, {"vx_mps", "vy_mps", "vz_mps"});
  const auto of_velocity =  // version 0.2 did not write it
      numbers_of<6>(states, {"v_xx_m2ps2", "v_xy_m2ps2", "v_xz_m2ps2", "v_yy_m2ps2", "v_yz_m2ps2", "v_zz_m2ps2"});
  const std::vector<double>* relocalized = states.find("relocalized");
  CovarianceSamples samples;
  for_each_pose(states, [&](std::size_t row, const SE3& T_W_B) {
    Step step;
    step.t = states.t[row];
    step.status = states.status[row];
    step.state.T_W_B = T_W_B;
    step.relocalized = relocalized && (*relocalized)[row] == 1.0;
    if (const auto v = velocity(row)) step.state.v_W = Eigen::Vector3d(v->data());
    if (const auto P = covariance(row)) {
      const auto V = of_velocity(row);
      step.covariance = {symmetric(P->data()), symmetric(P->data() + 6),
                         V ? symmetric(V->data()) : Eigen::Matrix3d(Eigen::Matrix3d::Zero())};
    }
    samples.add(step);
  });
  return samples.all();
}

void CovarianceSamples::add(const Step& step) {
  const bool good = step.status == TrackingStatus::Good;
  if (step.relocalized) ++reference_;
  if (!step.covariance || !is_tracking(step.status)) return;
  const auto old = [&](const StateCovarianceSample& last) {
    return last.reference == reference_ && last.good && last.covariance.position == step.covariance->position;
  };
  if (good && !samples_.empty() && old(samples_.back())) return;
  samples_.push_back({step.t, step.state.T_W_B, step.state.v_W, *step.covariance, good, reference_});
}

std::string pace_heading() { return "t_ns,processing_ms,latency_ms\n"; }

std::string pace_line(Timestamp t, const PacketPace& pace) {
  return fmt::format("{},{:.3f},{}\n", to_ns(t), pace.processing_ms,
                     pace.latency_ms ? fmt::format("{:.3f}", *pace.latency_ms) : "");
}

void read_pace(const std::filesystem::path& folder, StatesTable& states) {
  const std::filesystem::path file = folder / "pace.csv";
  if (!std::filesystem::exists(file)) return;
  std::vector<double> processing(states.t.size(), kNoNumber), latency = processing;
  LineReader lines(file);
  lines.next();
  for (std::size_t row = 0; row < states.t.size();) {
    const auto line = lines.next();
    if (!line) break;
    FieldReader fields(line->text);
    if (parse_nanoseconds(fields.next()) != states.t[row]) continue;  // a kill may have left half a line
    if (const auto number = parse_number(fields.next())) processing[row] = *number;
    if (const auto number = parse_number(fields.next())) latency[row] = *number;
    ++row;
  }
  states.columns["processing_ms"] = std::move(processing);
  states.columns["latency_ms"] = std::move(latency);
}

std::vector<MappedKeyframe> read_keyframes(const std::filesystem::path& folder) {
  std::vector<MappedKeyframe> keyframes;
  if (!std::filesystem::exists(folder / "keyframes.csv")) return keyframes;
  LineReader lines(folder / "keyframes.csv");
  while (const auto line = lines.next()) {
    FieldReader fields(line->text);
    const auto t = parse_nanoseconds(fields.next());
    if (!t) continue;  // the heading
    std::array<double, 7> v;
    for (double& number : v) number = parse_number(fields.next()).value_or(0.0);
    MappedKeyframe& keyframe = keyframes.emplace_back();
    keyframe.t = *t;
    keyframe.T_W_B = SE3(Eigen::Quaterniond(v.data() + 3), Eigen::Vector3d(v.data()));
    keyframe.camera = fields.next();
    fields.next();  // how many points it has
    keyframe.times_found = static_cast<int>(parse_number(fields.next()).value_or(0.0));
  }
  return keyframes;
}

}  // namespace edged
