// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads and writes trajectories.
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
  if (!read_numbers(fields, v) || !fields.rest().empty()) return {std::nullopt, "not the 12 finite numbers of [R | t]"};
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

}  // namespace

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
