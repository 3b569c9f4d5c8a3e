// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "evaluation_options.hpp"

#include <CLI/CLI.hpp>
#include <map>

#include "numbers.hpp"

namespace edged {
namespace {

const std::map<std::string, AlignmentKind> kAlignments = {{"none", AlignmentKind::None},
                                                          {"yaw", AlignmentKind::PositionYaw},
                                                          {"se3", AlignmentKind::SE3},
                                                          {"sim3", AlignmentKind::Sim3}};

}  // namespace

void add_evaluation_options(CLI::App& command, EvaluationOptions& options) {
  CLI::Option* align =
      command.add_option("--align", options.align, "What is aligned: none, yaw (position and yaw), se3, sim3")
          ->check(CLI::IsMember({"none", "yaw", "se3", "sim3"}))
          ->capture_default_str();
  CLI::Option* window =
      command.add_option("--window", options.window, "Align on these seconds only: BEGIN END")->expected(2);
  CLI::Option* first = command.add_option("--first", options.first_s, "Align on the first so many seconds only")
                           ->check(positive_number())
                           ->excludes(window);
  command
      .add_option("--protocol", options.protocol_name,
                  "P1: SE3 on seconds 3-8 (Ultimate SLAM). P2: SE3 on the first 5 s (PL-EVIO, EVI-SAM). "
                  "P3: SE3 on all (ESVIO). P4: Sim3 on all (DEVO)")
      ->check(CLI::IsMember({"P1", "P2", "P3", "P4"}))
      ->excludes(align)
      ->excludes(window)
      ->excludes(first);
  command.add_option("--max-gap", options.max_gap_s, "Longest gap in the ground truth to interpolate over [s]")
      ->check(positive_number())
      ->capture_default_str();
}

Protocol chosen_protocol(const EvaluationOptions& options) {
  if (!options.protocol_name.empty()) return protocol(options.protocol_name);
  Protocol result{"custom", kAlignments.at(options.align), {}};
  if (options.window.size() == 2) result.window = {options.window[0], options.window[1]};
  if (options.first_s > 0.0) result.window = {0.0, options.first_s};
  return result;
}

}  // namespace edged
