// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "eval_command.hpp"

#include <spdlog/fmt/fmt.h>

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/eval/evaluation_json.hpp"
#include "edged/eval/metrics.hpp"
#include "edged/io/trajectory_io.hpp"
#include "evaluation_text.hpp"
#include "exit_code.hpp"

namespace edged {
namespace {

struct EvalOptions {
  std::filesystem::path truth, estimate;
  std::string align = "se3";
  std::vector<double> window;
  double first_s = 0.0;
  std::string protocol_name;
  double max_gap_s = kDefaultMaxGap_s;
  std::vector<double> deltas_s = {1.0, 10.0};
  bool json = false;
};

const std::map<std::string, AlignmentKind> kAlignments = {{"none", AlignmentKind::None},
                                                          {"yaw", AlignmentKind::PositionYaw},
                                                          {"se3", AlignmentKind::SE3},
                                                          {"sim3", AlignmentKind::Sim3}};

Protocol chosen_protocol(const EvalOptions& options) {
  if (!options.protocol_name.empty()) return protocol(options.protocol_name);
  Protocol result{"custom", kAlignments.at(options.align), {}};
  if (options.window.size() == 2) result.window = {options.window[0], options.window[1]};
  if (options.first_s > 0.0) result.window = {0.0, options.first_s};
  return result;
}

int run_eval(const EvalOptions& options) {
  const Trajectory truth = read_trajectory(options.truth);
  const Trajectory estimate = read_trajectory(options.estimate);
  const Association association = associate(truth, estimate, duration_from_seconds(options.max_gap_s));
  const Evaluation evaluation = evaluate(association, chosen_protocol(options), options.deltas_s);
  fmt::print("{}", options.json ? to_json(evaluation).dump(2) + "\n" : to_table(evaluation));
  return kExitOk;
}

}  // namespace

void add_eval_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<EvalOptions>();
  CLI::App* eval = app.add_subcommand(
      "eval", "Compare a trajectory with ground truth: ATE, local error, RPE, error per metre, scale");
  eval->add_option("GROUNDTRUTH", options->truth, "Trajectory file: TUM, EuRoC csv or KITTI, found by content")
      ->required();
  eval->add_option("ESTIMATE", options->estimate, "Trajectory file of the same sensor on the same clock")->required();
  CLI::Option* align =
      eval->add_option("--align", options->align, "What is aligned: none, yaw (position and yaw), se3, sim3")
          ->check(CLI::IsMember({"none", "yaw", "se3", "sim3"}))
          ->capture_default_str();
  CLI::Option* window =
      eval->add_option("--window", options->window, "Align on these seconds only: BEGIN END")->expected(2);
  CLI::Option* first = eval->add_option("--first", options->first_s, "Align on the first so many seconds only")
                           ->check(CLI::PositiveNumber)
                           ->excludes(window);
  eval->add_option("--protocol", options->protocol_name,
                   "P1: SE3 on seconds 3-8 (Ultimate SLAM). P2: SE3 on the first 5 s (PL-EVIO, EVI-SAM). "
                   "P3: SE3 on all (ESVIO). P4: Sim3 on all (DEVO)")
      ->check(CLI::IsMember({"P1", "P2", "P3", "P4"}))
      ->excludes(align)
      ->excludes(window)
      ->excludes(first);
  eval->add_option("--max-gap", options->max_gap_s, "Longest gap in the ground truth to interpolate over [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  eval->add_option("--delta", options->deltas_s, "Time steps of the relative errors [s]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  eval->add_flag("--json", options->json, "Print json instead of a table");
  eval->footer("Example:\n  edged eval data/groundtruth.txt runs/poster-fused/trajectory.tum --protocol P1");
  eval->callback([options, &chosen] { chosen = [options] { return run_eval(*options); }; });
}

}  // namespace edged
