// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Options for the comparison of a trajectory with ground truth on the command line, and the result as a table.
#pragma once

#include <string>
#include <vector>

#include "common/cli.hpp"
#include "edged/eval/metrics.hpp"

namespace edged {

struct EvaluationOptions {
  std::string align = "se3";
  std::vector<double> window;
  double first_s = 0.0;
  std::string protocol_name;
  double max_gap_s = kDefaultMaxGap_s;
  std::string match = "interpolate";
};

/// Adds --align, --window, --first, --protocol, --max-gap and --match.
void add_evaluation_options(CLI::App& command, EvaluationOptions& options);

Protocol chosen_protocol(const EvaluationOptions& options);
/// Pairs of both, by --max-gap and --match.
Association associate(const Trajectory& truth, const Trajectory& estimate, const EvaluationOptions& options);

std::string to_table(const Evaluation& evaluation);
/// "1.23 mm", from 10 cm on "0.123 m".
std::string error_text(double error_m);
/// The local errors in one line, for the existing windows.
std::string local_error_text(const std::vector<LocalError>& local);

}  // namespace edged
