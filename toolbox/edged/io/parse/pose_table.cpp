// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/parse/pose_table.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"

namespace edged {
namespace {

/// 0: time, 1 to 3: position, 4 to 7: quaternion as x y z w.
std::optional<std::size_t> pose_role(const ColumnName& name) {
  if (has_word(name, {"v", "vel", "velocity", "bias", "b", "bg", "ba", "cov", "covariance", "std", "sigma", "acc",
                      "accel", "gyro", "linear", "angular", "twist"}))
    return std::nullopt;
  if (names_time(name)) return 0;
  const auto axis = axis_of(name, {"q", "p", "t"});
  if (!axis) return std::nullopt;
  const bool turn =
      has_word(name, {"q", "quat", "quaternion", "orientation", "rotation", "rot", "qx", "qy", "qz", "qw"});
  if (turn || *axis == 3) return 4 + *axis;
  const bool place =
      name.words.size() == 1 || has_word(name, {"p", "pos", "position", "t", "trans", "translation", "pose"});
  return place ? std::optional<std::size_t>(1 + *axis) : std::nullopt;
}

/// OpenVINS names whole vectors: `# timestamp(s) q p v bg ba ...`. Its quaternion is a JPL one from world to IMU. Its
/// numbers x y z w equal those of the Hamilton quaternion from IMU to world.
bool is_openvins(const std::vector<ColumnName>& names) {
  const auto is = [&names](std::size_t i, std::string_view word) {
    return names[i].words.size() == 1 && names[i].words[0] == word;
  };
  return names.size() >= 3 && names_time(names[0]) && is(1, "q") && is(2, "p");
}

/// Columns of the quaternion x y z w.
std::span<std::size_t> quaternion(TextTable& table) { return std::span(table.at).subspan(4); }

TextTable with_said(TextTable table, const std::string& source) {
  const auto q = quaternion(table);
  table.said = fmt::format("t [{}] in column {}, position in {} to {}, quaternion {} from {} on ({})",
                           unit_name(table.unit), table.at[0] + 1, table.at[1] + 1, table.at[3] + 1,
                           q[3] < q[0] ? "w x y z" : "x y z w", 1 + std::ranges::min(q), source);
  return table;
}

RowSample sample_poses(const SourcePath& file, std::size_t t) {
  constexpr std::size_t kMostPoses = 1000;
  RowSample sample = sample_rows(file, kMostPoses, {t});
  if (sample.rows.empty()) throw InputError::format("{}: holds no pose", file.string());
  return sample;
}

/// The units in which whole stamps of this interval are of poses, 0.2 ms to 2 s apart, the most likely first.
std::vector<TimeUnit> units_by_step(double step, bool whole) {
  std::vector<TimeUnit> fitting;
  for (const TimeUnit unit :
       {TimeUnit::Seconds, TimeUnit::Nanoseconds, TimeUnit::Microseconds, TimeUnit::Milliseconds}) {
    const double step_s = step * seconds_of(unit);
    if (step_s >= 2e-4 && step_s <= 2.0 && (whole || unit == TimeUnit::Seconds)) fitting.push_back(unit);
  }
  return fitting;
}

/// The unit of stamps since 1970 by the number of digits, else by the interval between poses.
TimeUnit unit_of_stamps(const RowSample& sample, std::size_t t, std::string& doubt) {
  const double size = std::abs(sample.rows.front()[t]);
  if (size >= 1e17) return TimeUnit::Nanoseconds;
  if (size >= 1e14) return TimeUnit::Microseconds;
  const bool whole = std::ranges::all_of(sample.rows, [t](const auto& row) { return row[t] == std::floor(row[t]); });
  const auto step = median_step(sample, t);
  const std::vector<TimeUnit> fitting = step ? units_by_step(*step, whole) : std::vector<TimeUnit>();
  if (fitting.empty()) {
    const bool long_numbers = step ? *step > 1e5 : size > 1e12;
    return whole && (sample.commas || long_numbers) ? TimeUnit::Nanoseconds : TimeUnit::Seconds;
  }
  if (fitting.size() > 1 && fitting.front() != TimeUnit::Seconds)
    doubt =
        fmt::format("the unit of the stamps is not certain ({} or {}, they are {:g} apart); name it in a first line",
                    unit_name(fitting[0]), unit_name(fitting[1]), *step);
  return fitting.front();
}

/// The order of the quaternion. Most trajectories begin at rest with small angles, or have a scalar that is never
/// negative.
std::string doubt_of_scalar(const RowSample& sample, bool scalar_first) {
  constexpr double kNearOne = 0.995;
  const std::vector<double>& row = sample.rows.front();
  const std::size_t scalar = scalar_first ? 4 : 7, other = 11 - scalar;
  if (!(std::abs(row[other]) > kNearOne && std::abs(row[scalar]) < 0.1)) return "";
  return fmt::format("the first pose would be rotated by 180 deg, and with the scalar {} hardly at all",
                     scalar_first ? "last" : "first");
}

}  // namespace

TextTable tum_table(TimeUnit unit) {
  return with_said({.at = {0, 1, 2, 3, 4, 5, 6, 7}, .unit = unit, .exact = true}, "as TUM");
}

TextTable euroc_table() {
  return with_said({.at = {0, 1, 2, 3, 5, 6, 7, 4}, .unit = TimeUnit::Nanoseconds}, "as EuRoC");
}

std::optional<TextTable> named_pose_table(const SourcePath& file, std::optional<TimeUnit> unit) {
  static const TableKind kind{
      {"timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"}, pose_role, "timestamp tx ty tz qx qy qz qw"};
  TextTable table{.named = true};
  std::optional<TimeUnit> named_unit;
  if (const std::vector<ColumnName> last = last_heading(file); is_openvins(last)) {
    table.at = {0, 5, 6, 7, 1, 2, 3, 4};
    named_unit = time_unit_of(last[0]);
  } else {
    const auto heading = find_heading(file, kind);
    if (!heading) return std::nullopt;
    table.at = heading->at;
    named_unit = heading->time_unit();
  }
  if (named_unit || unit)
    table.unit = named_unit ? *named_unit : *unit;
  else
    table.unit = unit_of_stamps(sample_poses(file, table.at[0]), table.at[0], table.doubt);
  return with_said(std::move(table), "by the heading");
}

TextTable find_pose_table(const SourcePath& file) {
  if (auto named = named_pose_table(file, std::nullopt)) return std::move(*named);
  const RowSample sample = sample_poses(file, 0);
  std::string doubt;
  const TimeUnit unit = unit_of_stamps(sample, 0, doubt);
  const bool scalar_first = sample.commas && unit == TimeUnit::Nanoseconds;
  if (const std::size_t columns = sample.rows.front().size(); columns < 8 || (columns > 8 && !sample.commas))
    throw InputError::format(
        "{}:{}: {} columns; TUM has 8, EuRoC csv 8 or more with stamps in ns, KITTI 12; or name them in a first line: "
        "`timestamp tx ty tz qx qy qz qw`",
        file.string(), sample.line, columns);
  TextTable table = scalar_first ? euroc_table() : tum_table(unit);
  table.exact = !sample.commas;
  table.doubt = doubt.empty() ? doubt_of_scalar(sample, scalar_first) : doubt;
  return with_said(std::move(table), scalar_first ? "no heading: commas and ns, as EuRoC and VINS write"
                                     : unit == TimeUnit::Nanoseconds ? "no heading: blanks and ns, as ORB-SLAM3 writes"
                                                                     : "no heading: as TUM");
}

std::string pose_row(const TextTable& table, const StampedPose& pose, char separator) {
  const Eigen::Vector3d& p = pose.T.translation();
  const Eigen::Quaterniond& q = pose.T.rotation();
  return format_row(table, pose.t, std::array{p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}, separator);
}

TextTable with_other_scalar(const TextTable& table) {
  TextTable other = table;
  const auto q = quaternion(other);
  const std::size_t first = std::ranges::min(q);
  const bool scalar_last = q[3] != first;
  for (std::size_t i = 0; i < 3; ++i) q[i] = first + i + (scalar_last ? 1 : 0);
  q[3] = first + (scalar_last ? 0 : 3);
  return other;
}

}  // namespace edged
