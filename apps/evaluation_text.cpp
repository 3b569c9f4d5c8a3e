// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "evaluation_text.hpp"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace edged {
namespace {

nlohmann::ordered_json to_json(const Statistics& s) {
  return {{"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median}, {"std", s.std},
          {"min", s.min},   {"max", s.max},   {"sse", s.sse},       {"count", s.count}};
}

nlohmann::ordered_json to_json(const NormalizedErrors& e) {
  return {{"mean_nees", e.mean_nees},
          {"max_nees", e.max_nees},
          {"within_3_sigma", e.within},
          {"axes_within_3_sigma", {e.axes_within.x(), e.axes_within.y(), e.axes_within.z()}}};
}

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

nlohmann::ordered_json to_json(const Evaluation& e) {
  nlohmann::ordered_json json = {
      {"protocol", e.protocol.name},
      {"alignment", to_string(e.protocol.alignment)},
      {"window_s", {e.protocol.window.begin_s, e.protocol.window.end_s}},  // json has no infinity: null is "to the end"
      {"pairs", e.pairs},
      {"outside_ground_truth", e.outside},
      {"in_ground_truth_gaps", e.in_gaps},
      {"duration_s", e.duration_s},
      {"path_length_m", e.path_length_m},
      {"scale", e.scale},
      {"start_scale", e.start_scale},
      {"scale_of_first_2_s", e.first_scale},
      {"scale_of_seconds_10_to_12", e.later_scale},
      {"ate_rmse_m", e.ate_m.rmse},
      {"mpe_percent", e.mpe_percent},
      {"rotation_deg_per_m", e.rotation_deg_per_m},
      {"yaw_deg_per_m", e.yaw_deg_per_m},
      {"ate_m", to_json(e.ate_m)},
      {"rotation_deg", to_json(e.rotation_deg)},
      {"yaw_deg", to_json(e.yaw_deg)},
  };
  for (const RelativeError& relative : e.relative) {
    json["rpe"].push_back({{"delta_s", relative.delta_s},
                           {"translation_m", to_json(relative.translation_m)},
                           {"rotation_deg", to_json(relative.rotation_deg)}});
  }
  for (const LocalError& local : e.local) {
    json["local_error"].push_back(
        {{"window_s", local.window_s}, {"windows", local.windows}, {"rmse_m", local.rmse_m}});  // NaN becomes null
  }
  return json;
}

nlohmann::ordered_json to_json(const Consistency& c) {
  nlohmann::ordered_json json = {{"poses", c.poses},
                                 {"starts", c.starts},
                                 {"position", to_json(c.position)},
                                 {"rotation", to_json(c.rotation)},
                                 {"silently_diverged_s", c.silent_s()},
                                 {"silently_diverged", nlohmann::ordered_json::array()}};
  for (const TimeSpan& span : c.silent)
    json["silently_diverged"].push_back({to_seconds(span.begin), to_seconds(span.end)});
  return json;
}

std::string to_table(const Evaluation& e) {
  std::string table = fmt::format("{} pairs over {:.2f} s and {:.3f} m; {} alignment on {}\n", e.pairs, e.duration_s,
                                  e.path_length_m, to_string(e.protocol.alignment), window_text(e.protocol.window));
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
  table += fmt::format("  local error            {}\n", local_error_text(e.local));
  table += fmt::format("  mean position error    {:.4f} % of the path\n", e.mpe_percent);
  table +=
      fmt::format("  mean rotation error    {:.4f} deg/m, yaw {:.4f} deg/m\n", e.rotation_deg_per_m, e.yaw_deg_per_m);
  table += fmt::format("  scale (Sim3)           {:.6f}{}\n", e.scale,
                       e.protocol.alignment == AlignmentKind::Sim3 ? " applied" : " estimated, not applied");
  return table;
}

}  // namespace edged
