// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "evaluation_text.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>

namespace edged {
namespace {

std::string row(const char* name, const Statistics& s, const char* unit) {
  return fmt::format("  {:<22} {:>10.4f} {:>10.4f} {:>10.4f} {:>10.4f} {:>10.4f} {:>10.4f}  {}\n", name, s.rmse, s.mean,
                     s.median, s.std, s.min, s.max, unit);
}

std::string window_text(const TimeWindow& window) {
  if (window == TimeWindow{}) return "all poses";
  if (std::isinf(window.end_s)) return fmt::format("seconds {} to the end", window.begin_s);
  return fmt::format("seconds {} to {}", window.begin_s, window.end_s);
}

}  // namespace

std::string local_error_text(const std::vector<LocalError>& local) {
  std::string errors, counts;
  for (const LocalError& e : local) {
    if (e.windows == 0) continue;
    const char* comma = errors.empty() ? "" : ", ";
    errors += fmt::format("{}{:.2f} mm over {} s", comma, 1e3 * e.rmse_m, e.window_s);
    counts += fmt::format("{}{}", comma, e.windows);
  }
  return errors.empty() ? "- (too short)" : fmt::format("{} ({} windows)", errors, counts);
}

std::string to_table(const Evaluation& e) {
  const bool timed = !std::isnan(e.duration_s);
  std::string table = fmt::format("{} pairs over {}{:.3f} m; {} alignment on {}\n", e.pairs,
                                  timed ? fmt::format("{:.2f} s and ", e.duration_s) : "", e.path_length_m,
                                  to_string(e.protocol.alignment), window_text(e.protocol.window));
  if (e.outside + e.in_gaps > 0) {
    table +=
        fmt::format("without ground truth: {} poses outside its time span, {} in its gaps\n", e.outside, e.in_gaps);
  }
  table += fmt::format("  {:<22} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "", "rmse", "mean", "median", "std",
                       "min", "max");
  table += row("ATE position", e.ate_m, "m");
  table += row("ATE rotation", e.rotation_deg, "deg");
  table += row("ATE yaw", e.yaw_deg, "deg");
  for (const RelativeError& relative : e.relative) {
    if (relative.translation_m.count == 0) continue;
    table += row(fmt::format("RPE position, {} s", relative.delta_s).c_str(), relative.translation_m, "m");
    table += row(fmt::format("RPE rotation, {} s", relative.delta_s).c_str(), relative.rotation_deg, "deg");
  }
  if (timed) table += fmt::format("  local error            {}\n", local_error_text(e.local));
  table += fmt::format("  mean position error    {:.4f} % of the path\n", e.mpe_percent);
  table +=
      fmt::format("  mean rotation error    {:.4f} deg/m, yaw {:.4f} deg/m\n", e.rotation_deg_per_m, e.yaw_deg_per_m);
  table += fmt::format("  scale (Sim3)           {:.6f}{}\n", e.scale,
                       e.protocol.alignment == AlignmentKind::Sim3 ? " applied" : " estimated, not applied");
  return table;
}

}  // namespace edged
