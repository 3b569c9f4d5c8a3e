// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/parse/trajectory_io.hpp"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/whole_file.hpp"
#include "edged/io/parse/text_parsing.hpp"

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

constexpr double kQuaternionTolerance = 0.05;  // of the norm; rounding to few digits changes it by less
constexpr double kPrintedRotationTolerance = 1e-2;

/// The pose of a line, or the error.
struct ParsedLine {
  std::optional<StampedPose> pose;
  std::string wrong;
};

using ParseLine = std::function<ParsedLine(std::string_view line, std::size_t index)>;

ParsedLine make_pose(Timestamp t, const Eigen::Vector3d& p, const Eigen::Quaterniond& q) {
  if (std::abs(q.norm() - 1.0) > kQuaternionTolerance)
    return {std::nullopt, fmt::format("the quaternion has norm {:.3f}, not 1", q.norm())};
  return {StampedPose{t, SE3(q, p)}, ""};
}

/// The pose of a line in those columns.
ParseLine parse_pose(const TextTable& table) {
  return [said = table.said, reader = RowReader(table)](std::string_view line, std::size_t) -> ParsedLine {
    std::array<double, 7> v{};
    const auto t = reader.read(line, v);
    if (!t) return {std::nullopt, fmt::format("no pose in finite numbers: {}", said)};
    return make_pose(*t, {v[0], v[1], v[2]}, {v[6], v[3], v[4], v[5]});
  };
}

ParsedLine parse_kitti(std::string_view line, std::size_t index) {
  FieldReader fields(line);
  std::array<double, 12> v;
  bool all = true;
  for (double& x : v) {
    const auto number = parse_number(fields.next());
    all = all && number;
    x = number.value_or(0.0);
  }
  if (!all || !fields.rest().empty()) return {std::nullopt, "not the 12 finite numbers of [R | t]"};
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> T(v.data());
  const Eigen::Matrix3d R = T.leftCols<3>();
  const double deviation = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (deviation > kPrintedRotationTolerance || R.determinant() < 0)
    return {std::nullopt, fmt::format("not a rotation matrix (deviation {:.2g})", deviation)};
  return {StampedPose{Timestamp(std::chrono::seconds(index)), SE3(R, T.col(3))}, ""};
}

Trajectory read_lines(const SourcePath& file, const ParseLine& parse, const DamageHandler& on_damage) {
  const auto damaged = [&](std::size_t line, const std::string& detail) {
    if (!on_damage) throw InputError::format("{}:{}: {}", file.string(), line, detail);
    on_damage(line, detail);
  };
  Trajectory trajectory;
  constexpr std::size_t kMostHeadings = 20;
  std::size_t repeated = 0, headings = 0;
  LineReader lines(file);
  while (const auto line = lines.next()) {
    const ParsedLine parsed = parse(line->text, trajectory.size());
    if (!parsed.pose && trajectory.empty() && is_heading(line->text) && ++headings <= kMostHeadings) continue;
    if (!parsed.pose) {
      damaged(line->number, parsed.wrong);
    } else if (trajectory.empty() || parsed.pose->t > trajectory.back().t) {
      trajectory.push_back(*parsed.pose);
    } else if (parsed.pose->t == trajectory.back().t && !on_damage) {
      ++repeated;
    } else {
      damaged(line->number, "the stamp is not after the one above: sort the file by time");
    }
  }
  if (trajectory.empty() && headings > kMostHeadings) throw InputError::format("{}: holds no pose", file.string());
  if (repeated > 0)
    spdlog::warn(fmt::format("{}: {} repeated stamps, the first pose of each is kept", file.string(), repeated));
  return trajectory;
}

/// How a trajectory is written.
struct WrittenForm {
  TextTable table;
  char separator;
  const char* heading;
};

const WrittenForm& written_form(TrajectoryFormat format) {
  static const WrittenForm tum{tum_table(TimeUnit::Seconds), ' ', "# timestamp [s] tx ty tz [m] qx qy qz qw\n"},
      euroc{euroc_table(), ',', "#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w,q_x,q_y,q_z\n"};
  return format == TrajectoryFormat::Tum ? tum : euroc;
}

std::string heading_of(TrajectoryFormat format, const std::vector<std::string>& comments) {
  std::string text;
  for (const std::string& comment : comments) text += "# " + comment + '\n';
  return text + written_form(format).heading;
}

/// The columns of the heading. Nothing for a file without a heading. `unit`: of the stamps, unless the heading names
/// it. Throws InputError if the heading does not name each column once.
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

/// The columns of the heading, else those of the conventions: with commas and stamps in nanoseconds the scalar is first
/// (EuRoC, VINS), with blanks it is last (TUM, ORB-SLAM3). An unnamed unit of the stamps is the one that gives a
/// present date or the interval of a sensor. Throws InputError if the file holds no poses.
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

}  // namespace

TextTable tum_table(TimeUnit unit) {
  return with_said({.at = {0, 1, 2, 3, 4, 5, 6, 7}, .unit = unit, .exact = true}, "as TUM");
}

TextTable euroc_table() {
  return with_said({.at = {0, 1, 2, 3, 5, 6, 7, 4}, .unit = TimeUnit::Nanoseconds}, "as EuRoC");
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

Trajectory read_poses(const SourcePath& file, const TextTable& documented, const DamageHandler& on_damage) {
  return read_lines(file, parse_pose(named_pose_table(file, documented.unit).value_or(documented)), on_damage);
}

Trajectory read_tum(const SourcePath& file) { return read_poses(file, tum_table(TimeUnit::Seconds)); }

std::optional<GroundTruth> read_ground_truth(const SourcePath& file, const TextTable& documented,
                                             const std::string& frame, Repairs& repairs) {
  LineDamage damage(file.string(), "groundtruth", repairs);
  const auto count = [&](std::size_t line, const std::string& detail) { damage.bad(line, "bad line", detail); };
  GroundTruth truth{read_poses(file, documented, count), frame};
  return truth.trajectory.empty() ? std::nullopt : std::optional(std::move(truth));
}

TrajectoryForm find_trajectory_form(const SourcePath& file) {
  constexpr std::size_t kKittiColumns = 12;
  LineReader lines(file);
  const auto line = lines.next();
  if (!line) throw InputError::format("{}: holds no pose", file.string());
  std::size_t columns = 0;
  for (FieldReader fields(line->text); !fields.rest().empty(); ++columns) fields.next();
  const bool kitti = columns == kKittiColumns && line->text.find_first_of(",;") == std::string_view::npos &&
                     !named_pose_table(file, TimeUnit::Seconds);
  if (kitti) return {true, {.said = "[R | t] without times (KITTI)"}};
  return {false, find_pose_table(file)};
}

Trajectory read_trajectory(const SourcePath& file, const TrajectoryForm& form) {
  return read_lines(file, form.untimed ? ParseLine(parse_kitti) : parse_pose(form.columns), {});
}

Trajectory read_trajectory(const SourcePath& file) {
  const TrajectoryForm form = find_trajectory_form(file);
  if (!form.columns.doubt.empty())
    spdlog::warn(fmt::format("{}: read as {}; {}", file.string(), form.columns.said, form.columns.doubt));
  return read_trajectory(file, form);
}

TrajectoryWriter::TrajectoryWriter(const std::filesystem::path& file, TrajectoryFormat format,
                                   const std::vector<std::string>& comments)
    : file_(file), out_(file), format_(format) {
  if (!out_) throw InputError::format("{}: cannot be written", file.string());
  if (format != TrajectoryFormat::Kitti) out_ << heading_of(format, comments);
}

void TrajectoryWriter::add(const StampedPose& pose) {
  if (format_ == TrajectoryFormat::Kitti) {
    const Eigen::Matrix<double, 3, 4, Eigen::RowMajor> T = pose.T.matrix().topRows<3>();
    out_ << fmt::format("{}\n", fmt::join(T.data(), T.data() + T.size(), " "));
    return;
  }
  const WrittenForm& form = written_form(format_);
  out_ << pose_row(form.table, pose, form.separator) << '\n';
}

void TrajectoryWriter::flush() {
  if (!out_.flush()) throw InputError::format("{}: cannot be written; is the disk full?", file_.string());
}

void write_tum(const std::filesystem::path& file, const Trajectory& trajectory,
               const std::vector<std::string>& comments) {
  const WrittenForm& form = written_form(TrajectoryFormat::Tum);
  std::string text = heading_of(TrajectoryFormat::Tum, comments);
  for (const StampedPose& pose : trajectory) text += pose_row(form.table, pose, form.separator) + '\n';
  write_file(file, text);
}

}  // namespace edged
