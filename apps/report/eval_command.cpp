// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/command.hpp"
#include "common/source.hpp"
#include "common/text.hpp"
#include "edged/core/check.hpp"
#include "edged/eval/evaluation_json.hpp"
#include "edged/eval/metrics.hpp"
#include "edged/io/parse/trajectory_io.hpp"
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
  for (const char* name : {"--window", "--first", "--max-gap", "--match", "--delta"})
    if (eval.count(name) > 0) timed = name;
  if (!timed.empty())
    throw InputError::format("{} needs times, and KITTI files hold no times; give files with stamps (TUM, EuRoC csv)",
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
  constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();
  result.duration_s = result.start_scale = result.first_scale = result.later_scale = kNoTime;
  return result;
}

/// A folder is refused with the trajectory that it holds.
const std::filesystem::path& no_folder(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return path;
  for (const char* name : {"trajectory.tum", "groundtruth.txt"})
    if (std::filesystem::exists(path / name))
      throw InputError::format("{}: is a folder; give {}", path.string(), (path / name).string());
  throw InputError::format("{}: is a folder; give the file of a trajectory", path.string());
}

/// A trajectory and how its file was read.
struct ReadFile {
  std::filesystem::path file;
  TrajectoryForm form;
  Trajectory poses;

  explicit ReadFile(const std::filesystem::path& path)
      : file(no_folder(path)), form(find_trajectory_form(path)), poses(read_trajectory(path, form)) {
    if (!form.columns.doubt.empty())
      spdlog::warn(fmt::format("{}: read as {}; {}", file.string(), form.columns.said, form.columns.doubt));
  }
};

/// A quaternion read in the wrong order gives a large rotation error; the other order fits much better then.
void warn_of_other_order(const ReadFile& truth, const ReadFile& estimate, const EvalOptions& options,
                         double rotation_deg) {
  constexpr double kSuspicious_deg = 3.0, kMuchBetter = 0.3;
  if (!(rotation_deg > kSuspicious_deg)) return;
  const auto try_other = [&](const ReadFile& suspect, bool is_truth) {
    if (suspect.form.columns.named) return;
    const Trajectory other = read_trajectory(suspect.file, {false, with_other_scalar(suspect.form.columns)});
    const Association association =
        associate(is_truth ? other : truth.poses, is_truth ? estimate.poses : other, options.how);
    const double error_deg = evaluate(association, chosen_protocol(options.how), {}, {}).rotation_deg.rmse;
    if (error_deg < kMuchBetter * rotation_deg)
      spdlog::warn(
          fmt::format("{}: read as {}; with the scalar at the other end the rotation error is {:.2f} deg instead of "
                      "{:.2f}: name the columns in a first line, `timestamp tx ty tz qx qy qz qw`",
                      suspect.file.string(), suspect.form.columns.said, error_deg, rotation_deg));
  };
  try_other(truth, true);
  try_other(estimate, false);
}

struct Compared {
  Evaluation evaluation;
  std::optional<TimeOffset> offset;  ///< nothing without times
};

Compared compare(const ReadFile& truth, const ReadFile& estimate, const EvalOptions& options, const CLI::App& eval) {
  if (truth.form.untimed || estimate.form.untimed) {
    refuse_times(options, eval);
    return {evaluate_untimed(truth.poses, estimate.poses, options), std::nullopt};
  }
  Compared compared{
      evaluate(associate(truth.poses, estimate.poses, options.how), chosen_protocol(options.how), options.deltas_s),
      fit_time_offset(truth.poses, estimate.poses, duration_from_seconds(options.how.max_gap_s))};
  warn_of_other_order(truth, estimate, options, compared.evaluation.rotation_deg.rmse);
  return compared;
}

std::string offset_text(const TimeOffset& offset) {
  return fmt::format("  time offset            {:+.1f} ms fits best: ATE {} with it (SE3 on all poses, {} without)\n",
                     1e3 * offset.offset_s, error_text(offset.ate_rmse_m), error_text(offset.ate_given_m));
}

/// The next step for the user.
std::string next_text(const EvalOptions& options, const Compared& compared) {
  if (compared.offset && compared.offset->matters())
    return fmt::format("add {:.4f} s to the stamps of {}: they are {}\n", -compared.offset->offset_s,
                       options.truth.string(), compared.offset->offset_s > 0.0 ? "late" : "early");
  return fmt::format("edged report {} --truth {}\n", shell_word(options.estimate.string()),
                     shell_word(options.truth.string()));
}

int run_eval(const EvalOptions& options, const CLI::App& eval) {
  const ReadFile truth(options.truth), estimate(options.estimate);
  const Compared compared = compare(truth, estimate, options, eval);
  nlohmann::ordered_json json = to_json(compared.evaluation);
  json["ground_truth_columns"] = truth.form.columns.said;
  json["estimate_columns"] = estimate.form.columns.said;
  if (compared.offset) json["ground_truth_time_offset"] = to_json(*compared.offset);
  print_result(options.json, json,
               fmt::format("ground truth: {}\nestimate: {}\n{}{}  next                   {}", truth.form.columns.said,
                           estimate.form.columns.said, to_table(compared.evaluation),
                           compared.offset ? offset_text(*compared.offset) : "", next_text(options, compared)));
  return kExitOk;
}

}  // namespace

void add_eval_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<EvalOptions>();
  CLI::App* eval = app.add_subcommand(
      "eval", "Compare a trajectory with ground truth: ATE, local error, RPE, error per metre, scale");
  eval->add_option(
          "GROUNDTRUTH", options->truth,
          "Trajectory file: TUM, EuRoC csv, KITTI (without times: poses are compared by index), or as written by "
          "ORB-SLAM3, OKVIS2, OpenVINS or VINS; the order of the columns is detected and printed")
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
