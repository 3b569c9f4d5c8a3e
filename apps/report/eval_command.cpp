// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "common/numbers.hpp"
#include "common/source.hpp"
#include "edged/core/check.hpp"
#include "edged/eval/evaluation_json.hpp"
#include "edged/eval/metrics.hpp"
#include "edged/io/trajectory_io.hpp"
#include "report/evaluation.hpp"

namespace edged {
namespace {

struct EvalOptions {
  std::filesystem::path truth, estimate;
  EvaluationOptions how;
  std::vector<double> deltas_s = {1.0, 10.0};
  bool json = false;
};

/// KITTI has no times: metrics over seconds are not possible.
void refuse_times(const EvalOptions& options, const CLI::App& eval) {
  std::string timed =
      chosen_protocol(options.how).window == TimeWindow{} ? "" : "--protocol " + options.how.protocol_name;
  for (const char* name : {"--window", "--first", "--max-gap", "--delta"})
    if (eval.count(name) > 0) timed = name;
  if (!timed.empty())
    throw InputError::format("{} is in seconds, and KITTI files hold no times; give files with stamps (TUM, EuRoC csv)",
                             timed);
}

/// Pairs by index; metrics that need times are left empty.
Evaluation evaluate_untimed(const Trajectory& truth, const Trajectory& estimate, const EvalOptions& options) {
  if (truth.size() != estimate.size())
    throw InputError::format(
        "KITTI files hold no times, so pose i is compared with pose i: {} holds {} poses, {} holds {}; give files with "
        "stamps (TUM, EuRoC csv)",
        options.truth.string(), truth.size(), options.estimate.string(), estimate.size());
  Evaluation result = evaluate(associate_by_index(truth, estimate), chosen_protocol(options.how), {}, {});
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  result.duration_s = result.start_scale = result.first_scale = result.later_scale = kUnknown;
  return result;
}

struct Compared {
  Evaluation evaluation;
  std::optional<TimeOffset> offset;  ///< nothing without times
};

Compared evaluate_files(const EvalOptions& options, const CLI::App& eval) {
  const bool timed = trajectory_format(options.truth) != TrajectoryFormat::Kitti &&
                     trajectory_format(options.estimate) != TrajectoryFormat::Kitti;
  if (!timed) refuse_times(options, eval);
  const Trajectory truth = read_trajectory(options.truth);
  const Trajectory estimate = read_trajectory(options.estimate);
  if (!timed) return {evaluate_untimed(truth, estimate, options), std::nullopt};
  const Duration max_gap = duration_from_seconds(options.how.max_gap_s);
  return {evaluate(associate(truth, estimate, max_gap), chosen_protocol(options.how), options.deltas_s),
          fit_time_offset(truth, estimate, max_gap)};
}

std::string offset_text(const TimeOffset& offset) {
  return fmt::format(
      "  time offset            {:+.1f} ms fits best: ATE {:.4f} m with it (SE3 on all poses, {:.4f} m without)\n",
      1e3 * offset.offset_s, offset.ate_rmse_m, offset.ate_given_m);
}

/// What follows from it.
std::string next_text(const EvalOptions& options, const Compared& compared) {
  if (compared.offset && compared.offset->matters())
    return fmt::format("add {:.4f} s to the stamps of {}: they are {}\n", -compared.offset->offset_s,
                       options.truth.string(), compared.offset->offset_s > 0.0 ? "late" : "early");
  return fmt::format("edged report {} --truth {}\n", shell_word(options.estimate.string()),
                     shell_word(options.truth.string()));
}

int run_eval(const EvalOptions& options, const CLI::App& eval) {
  const Compared compared = evaluate_files(options, eval);
  if (options.json) {
    nlohmann::ordered_json json = to_json(compared.evaluation);
    if (compared.offset) json["ground_truth_time_offset"] = to_json(*compared.offset);
    fmt::print("{}\n", json.dump(2));
    return kExitOk;
  }
  fmt::print("{}{}  next                   {}", to_table(compared.evaluation),
             compared.offset ? offset_text(*compared.offset) : "", next_text(options, compared));
  return kExitOk;
}

}  // namespace

void add_eval_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<EvalOptions>();
  CLI::App* eval = app.add_subcommand(
      "eval", "Compare a trajectory with ground truth: ATE, local error, RPE, error per metre, scale");
  eval->add_option("GROUNDTRUTH", options->truth,
                   "Trajectory file: TUM, EuRoC csv or KITTI (without times: poses are compared by index); the format "
                   "is detected")
      ->required();
  eval->add_option("ESTIMATE", options->estimate, "Trajectory file of the same sensor, on the same clock")->required();
  add_evaluation_options(*eval, options->how);
  eval->add_option("--delta", options->deltas_s, "Time steps of the relative errors, separated by blanks [s]")
      ->check(positive_number())
      ->capture_default_str();
  eval->add_flag("--json", options->json, "Print JSON");
  eval->footer("Example:\n  edged eval data/groundtruth.txt runs/poster-fused/trajectory.tum --protocol P1");
  eval->callback([options, eval, &chosen] { chosen = [options, eval] { return run_eval(*options, *eval); }; });
}

}  // namespace edged
