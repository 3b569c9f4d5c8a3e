// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the commands of `edged` share: exit status, flags, validators of numbers, and how results are printed.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "common/cli.hpp"

namespace edged {

using Chosen = std::function<int()>;  ///< what to run, by the command that the user chose

/// Ends the description of a command: --quiet and --json where its options have them, examples, and what it runs.
template <typename Options>
void finish_command(CLI::App& command, const std::shared_ptr<Options>& options, const std::string& footer,
                    Chosen& chosen, int (*run)(const Options&)) {
  if constexpr (requires { options->quiet; }) command.add_flag("--quiet", options->quiet, "No status line");
  if constexpr (requires { options->json; }) command.add_flag("--json", options->json, "Print JSON");
  command.footer(footer);
  command.callback([options, run, &chosen] { chosen = [options, run] { return run(*options); }; });
}

/// Prints the result of a command.
void print_result(bool as_json, const nlohmann::ordered_json& json, const std::string& text);

/// "; did you mean NAME?" of the known names, or "" where none is similar to the word.
std::string did_you_mean(const std::vector<std::string>& known, const std::string& word);

/// Used instead of the bounds of CLI11, whose messages contain the largest double.
CLI::Validator positive_number();
CLI::Validator non_negative_number();

}  // namespace edged
