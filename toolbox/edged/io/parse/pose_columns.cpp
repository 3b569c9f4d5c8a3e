// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/parse/pose_columns.hpp"

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
std::optional<PoseColumns> openvins_columns(const std::vector<ColumnName>& names) {
  const auto is = [&names](std::size_t i, std::string_view word) {
    return names[i].words.size() == 1 && names[i].words[0] == word;
  };
  if (names.size() < 3 || !names_time(names[0]) || !is(1, "q") || !is(2, "p")) return std::nullopt;
  PoseColumns columns;
  columns.q = {1, 2, 3, 4};
  columns.p = {5, 6, 7};
  return columns;
}

std::string said_of(const PoseColumns& c, const std::string& source) {
  const bool scalar_first = c.q[3] < c.q[0];
  return fmt::format("t [{}] in column {}, position in {} to {}, quaternion {} from {} on ({})", unit_name(c.unit),
                     c.t + 1, c.p[0] + 1, c.p[2] + 1, scalar_first ? "w x y z" : "x y z w", 1 + std::ranges::min(c.q),
                     source);
}

/// The first poses of a file: stamps in their unit, and the four numbers after the position.
struct PoseSample {
  std::size_t columns = 0, line = 0;
  bool commas = false;
  std::vector<double> stamps;
  std::vector<std::array<double, 4>> turns;
};

PoseSample read_pose_sample(const SourcePath& file, std::size_t t) {
  constexpr std::size_t kMostPoses = 1000;
  PoseSample sample;
  LineReader lines(file);
  for (std::size_t i = 0; i < kMostPoses; ++i) {
    const auto line = lines.next();
    if (!line) break;
    std::vector<double> row;
    for (FieldReader fields(line->text); !fields.rest().empty();)
      row.push_back(parse_number(fields.next()).value_or(std::nan("")));
    if (t >= row.size() || std::isnan(row[t])) continue;
    if (sample.columns == 0) {
      sample.columns = row.size(), sample.line = line->number;
      sample.commas = line->text.find(',') != std::string_view::npos;
    }
    sample.stamps.push_back(row[t]);
    if (row.size() >= 8) sample.turns.push_back({row[4], row[5], row[6], row[7]});
  }
  if (sample.columns == 0) throw InputError::format("{}: holds no pose", file.string());
  return sample;
}

/// The unit of stamps since 1970 by the number of digits, else by the interval between poses: 0.2 ms to 2 s.
TimeUnit unit_of_stamps(const PoseSample& sample, std::string& doubt) {
  const double size = std::abs(sample.stamps.front());
  if (size >= 1e17) return TimeUnit::Nanoseconds;
  if (size >= 1e14) return TimeUnit::Microseconds;
  std::vector<double> steps;
  bool whole = size == std::floor(size);
  for (std::size_t i = 1; i < sample.stamps.size(); ++i) {
    steps.push_back(std::abs(sample.stamps[i] - sample.stamps[i - 1]));
    whole = whole && sample.stamps[i] == std::floor(sample.stamps[i]);
  }
  if (steps.empty()) return whole && (sample.commas || size > 1e12) ? TimeUnit::Nanoseconds : TimeUnit::Seconds;
  const double step = median(std::move(steps));
  std::vector<TimeUnit> fitting;
  for (const TimeUnit unit :
       {TimeUnit::Seconds, TimeUnit::Nanoseconds, TimeUnit::Microseconds, TimeUnit::Milliseconds}) {
    const double step_s = step * std::pow(10.0, static_cast<int>(unit) - 9);
    if (step_s >= 2e-4 && step_s <= 2.0 && (whole || unit == TimeUnit::Seconds)) fitting.push_back(unit);
  }
  if (fitting.empty()) return whole && (sample.commas || step > 1e5) ? TimeUnit::Nanoseconds : TimeUnit::Seconds;
  if (fitting.size() > 1 && fitting.front() != TimeUnit::Seconds)
    doubt =
        fmt::format("the unit of the stamps is not certain ({} or {}, they are {:g} apart); name it in a first line",
                    unit_name(fitting[0]), unit_name(fitting[1]), step);
  return fitting.front();
}

/// The order of the quaternion. Most trajectories begin at rest with small angles, or have a scalar that is never
/// negative.
std::string doubt_of_scalar(const std::vector<std::array<double, 4>>& turns, bool scalar_first) {
  if (turns.empty()) return "";
  constexpr double kNearOne = 0.995;
  const std::size_t scalar = scalar_first ? 0 : 3, other = 3 - scalar;
  const bool starts_at_one = std::abs(turns[0][other]) > kNearOne && std::abs(turns[0][scalar]) < 0.1;
  return starts_at_one ? fmt::format("the first pose would be a turn of 180 deg, and with the scalar {} nearly none",
                                     scalar_first ? "last" : "first")
                       : "";
}

}  // namespace

PoseColumns tum_columns(TimeUnit unit) {
  PoseColumns columns{.unit = unit, .exact = true};
  columns.said = said_of(columns, "as TUM");
  return columns;
}

PoseColumns euroc_columns() {
  PoseColumns columns{.q = {5, 6, 7, 4}, .unit = TimeUnit::Nanoseconds};
  columns.said = said_of(columns, "as EuRoC");
  return columns;
}

std::optional<PoseColumns> named_pose_columns(const SourcePath& file, std::optional<TimeUnit> unit) {
  static const ColumnRoles roles{
      {"timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw"}, pose_role, "timestamp tx ty tz qx qy qz qw"};
  const std::vector<ColumnName> last = last_heading(file);
  std::optional<PoseColumns> columns = openvins_columns(last);
  std::optional<TimeUnit> named_unit = last.empty() ? std::nullopt : time_unit_of(last[0]);
  if (!columns) {
    const auto named = named_columns(file, roles);
    if (!named) return std::nullopt;
    const auto& at = named->at;
    columns = PoseColumns{.t = at[0], .p = {at[1], at[2], at[3]}, .q = {at[4], at[5], at[6], at[7]}};
    named_unit = time_unit_of(named->name_of(0));
  }
  if (named_unit || unit)
    columns->unit = named_unit ? *named_unit : *unit;
  else
    columns->unit = unit_of_stamps(read_pose_sample(file, columns->t), columns->doubt);
  columns->named = true;
  columns->said = said_of(*columns, "by the heading");
  return columns;
}

PoseColumns find_pose_columns(const SourcePath& file) {
  if (auto named = named_pose_columns(file, std::nullopt)) return std::move(*named);
  const PoseSample sample = read_pose_sample(file, 0);
  std::string doubt;
  const TimeUnit unit = unit_of_stamps(sample, doubt);
  const bool scalar_first = sample.commas && unit == TimeUnit::Nanoseconds;
  if (sample.columns < 8 || (sample.columns > 8 && !sample.commas))
    throw InputError::format(
        "{}:{}: {} columns; TUM has 8, EuRoC csv 8 or more with stamps in ns, KITTI 12; or name them in a first line: "
        "`timestamp tx ty tz qx qy qz qw`",
        file.string(), sample.line, sample.columns);
  PoseColumns columns = scalar_first ? euroc_columns() : tum_columns(unit);
  columns.exact = !sample.commas;
  const char* convention = scalar_first                    ? "no heading: commas and ns, as EuRoC and VINS write"
                           : unit == TimeUnit::Nanoseconds ? "no heading: blanks and ns, as ORB-SLAM3 writes"
                                                           : "no heading: as TUM";
  columns.said = said_of(columns, convention);
  columns.doubt = doubt.empty() ? doubt_of_scalar(sample.turns, scalar_first) : doubt;
  return columns;
}

PoseColumns with_other_scalar(const PoseColumns& columns) {
  PoseColumns other = columns;
  const std::size_t first = std::ranges::min(columns.q);
  other.q = columns.q[3] == first ? std::array{first, first + 1, first + 2, first + 3}
                                  : std::array{first + 1, first + 2, first + 3, first};
  return other;
}

}  // namespace edged
