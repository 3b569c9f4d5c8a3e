// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "report/evaluation.hpp"

#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <map>

#include "common/command.hpp"
#include "common/text.hpp"

namespace edged {
namespace {

const std::map<std::string, AlignmentKind> kAlignments = {{"none", AlignmentKind::None},
                                                          {"yaw", AlignmentKind::PositionYaw},
                                                          {"se3", AlignmentKind::SE3},
                                                          {"sim3", AlignmentKind::Sim3}};

constexpr double kSmallError_m = 0.1;  ///< Smaller errors are given in millimetres.

std::string row(const char* name, const Statistics& s, const char* unit) {
  return fmt::format("  {:<22} {:>10.4f} {:>10.4f} {:>10.4f} {:>10.4f} {:>10.4f} {:>10.4f}  {}\n", name, s.rmse, s.mean,
                     s.median, s.std, s.min, s.max, unit);
}

/// Millimetres where the RMSE is below 0.1 m, as everywhere in the output, else metres.
std::string position_row(const std::string& name, const Statistics& m) {
  if (!(m.rmse < kSmallError_m)) return row(name.c_str(), m, "m");
  Statistics mm = m;
  for (double* value : {&mm.rmse, &mm.mean, &mm.median, &mm.std, &mm.min, &mm.max}) *value *= 1e3;
  return row(name.c_str(), mm, "mm");
}

std::string window_text(const TimeWindow& window) {
  if (window == TimeWindow{}) return "all poses";
  if (std::isinf(window.end_s)) return fmt::format("seconds {} to the end", window.begin_s);
  return fmt::format("seconds {} to {}", window.begin_s, window.end_s);
}

}  // namespace

void add_evaluation_options(CLI::App& command, EvaluationOptions& options) {
  CLI::Option* align =
      command.add_option("--align", options.align, "Alignment: none, yaw (position and yaw), se3, sim3")
          ->transform(CLI::IsMember({"none", "yaw", "se3", "sim3"}, CLI::ignore_case))
          ->capture_default_str();
  CLI::Option* window =
      command.add_option("--window", options.window, "Align on these seconds only: BEGIN END [s]")->expected(2);
  CLI::Option* first = command.add_option("--first", options.first_s, "Align on the first seconds only [s]")
                           ->check(positive_number())
                           ->excludes(window);
  command
      .add_option("--protocol", options.protocol_name,
                  "P1: SE3 on seconds 3-8 (Ultimate SLAM). P2: SE3 on the first 5 s (PL-EVIO, EVI-SAM). "
                  "P3: SE3 on all (ESVIO). P4: Sim3 on all (DEVO)")
      ->transform(CLI::IsMember({"P1", "P2", "P3", "P4"}, CLI::ignore_case))
      ->excludes(align)
      ->excludes(window)
      ->excludes(first);
  command.add_option("--max-gap", options.max_gap_s, "Longest gap of the ground truth that is interpolated [s]")
      ->check(positive_number())
      ->capture_default_str();
  command
      .add_option("--match", options.match,
                  "Pairs of poses at the stamps of the sparser trajectory: the denser one interpolated, or its nearest "
                  "pose within 10 ms (as evo does), which adds the motion between the two")
      ->check(CLI::IsMember({"interpolate", "nearest"}))
      ->capture_default_str();
}

Association associate(const Trajectory& truth, const Trajectory& estimate, const EvaluationOptions& options) {
  return associate(truth, estimate, duration_from_seconds(options.max_gap_s),
                   options.match == "nearest" ? Matching::Nearest : Matching::Interpolate);
}

Protocol chosen_protocol(const EvaluationOptions& options) {
  if (!options.protocol_name.empty()) return protocol(options.protocol_name);
  Protocol result{"custom", kAlignments.at(options.align), {}};
  if (result.alignment == AlignmentKind::SE3 && options.window.empty() && !(options.first_s > 0.0))
    return protocol("P3");
  if (options.window.size() == 2) result.window = {options.window[0], options.window[1]};
  if (options.first_s > 0.0) result.window = {0.0, options.first_s};
  return result;
}

std::string error_text(double error_m) {
  return error_m < kSmallError_m ? fmt::format("{:.2f} mm", 1e3 * error_m) : fmt::format("{:.3f} m", error_m);
}

std::string local_error_text(const std::vector<LocalError>& local) {
  std::string errors, counts;
  std::size_t most = 0;
  for (const LocalError& e : local) {
    if (e.windows == 0) continue;
    const char* comma = errors.empty() ? "" : ", ";
    errors += fmt::format("{}{:.2f} mm over {} s", comma, 1e3 * e.rmse_m, e.window_s);
    counts += fmt::format("{}{}", comma, e.windows);
    most = std::max(most, e.windows);
  }
  return errors.empty() ? "- (too short)" : fmt::format("{} ({} {})", errors, counts, most == 1 ? "window" : "windows");
}

std::string to_table(const Evaluation& e) {
  const bool timed = !std::isnan(e.duration_s);
  std::string table = fmt::format("{} over {}{:.3f} m; {} alignment on {}\n", quantity(e.pairs, "pair"),
                                  timed ? fmt::format("{:.2f} s and ", e.duration_s) : "", e.path_length_m,
                                  to_string(e.protocol.alignment), window_text(e.protocol.window));
  if (e.outside + e.in_gaps > 0) {
    table += fmt::format("without ground truth: {} outside its time span, {} in its gaps\n",
                         quantity(e.outside, "pose"), e.in_gaps);
  }
  table += fmt::format("  {:<22} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "", "rmse", "mean", "median", "std",
                       "min", "max");
  table += position_row("ATE position", e.ate_m);
  table += row("ATE rotation", e.rotation_deg, "deg");
  table += row("ATE yaw", e.yaw_deg, "deg");
  table += row("tilt, not aligned", e.tilt_deg, "deg");
  for (const RelativeError& relative : e.relative) {
    if (relative.translation_m.count == 0) continue;
    table += position_row(fmt::format("RPE position, {} s", relative.delta_s), relative.translation_m);
    table += row(fmt::format("RPE rotation, {} s", relative.delta_s).c_str(), relative.rotation_deg, "deg");
  }
  if (timed) table += fmt::format("  local error            {}\n", local_error_text(e.local));
  if (std::isnan(e.mpe_percent))
    return table + fmt::format("  errors per metre and scale: - (the path is shorter than {} m)\n", kShortestPath_m);
  table += fmt::format("  mean position error    {:.4f} % of the path\n", e.mpe_percent);
  table +=
      fmt::format("  mean rotation error    {:.4f} deg/m, yaw {:.4f} deg/m\n", e.rotation_deg_per_m, e.yaw_deg_per_m);
  table += fmt::format("  scale (Sim3)           {:.6f}{}\n", e.scale,
                       e.protocol.alignment == AlignmentKind::Sim3 ? " applied" : " estimated, not applied");
  return table;
}

}  // namespace edged
