// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/eval/evaluation_json.hpp"

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

}  // namespace

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
      {"tilt_deg", to_json(e.tilt_deg)},
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

nlohmann::ordered_json to_json(const TimeOffset& offset) {
  return {{"offset_s", offset.offset_s}, {"ate_rmse_m", offset.ate_rmse_m}, {"matters", offset.matters()}};
}

nlohmann::ordered_json to_json(const Consistency& c) {
  nlohmann::ordered_json json = {{"poses", c.poses},
                                 {"references", c.references},
                                 {"position", to_json(c.position)},
                                 {"rotation", to_json(c.rotation)},
                                 {"velocity", to_json(c.velocity)},
                                 {"nees_at", nlohmann::ordered_json::array()},
                                 {"silently_diverged_s", c.silent_s()},
                                 {"silently_diverged", nlohmann::ordered_json::array()}};
  for (const NeesAt& at : c.at) {
    json["nees_at"].push_back({{"since_start_s", at.since_start_s},
                               {"position", at.position},
                               {"rotation", at.rotation},
                               {"velocity", at.velocity}});  // NaN becomes null
  }
  for (const TimeSpan& span : c.silent)
    json["silently_diverged"].push_back({to_seconds(span.begin), to_seconds(span.end)});
  return json;
}

}  // namespace edged
