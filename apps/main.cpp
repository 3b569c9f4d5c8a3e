// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The one binary: its sub-commands.
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/cli.hpp"
#include "common/text.hpp"
#include "program/commands.hpp"
#include "program/program.hpp"

namespace {

constexpr const char* kFooter =
    "First steps:\n"
    "  edged simulate --out /tmp/flight          make a recording with ground truth\n"
    "  edged run /tmp/flight                     estimate its trajectory; prints the error\n"
    "  edged run /tmp/flight --mode events       the same from events and IMU alone\n"
    "  edged run REC --calib head.yaml           your own; `edged calib --target` makes head.yaml\n"
    "  edged config packets                      options whose name contains `packets`\n"
    "\n"
    "Exit codes: 0 ok, 1 internal error, 2 wrong command line, 3 bad recording, calibration or option,\n"
    "  4 no good pose, 5 finished, but the result is not to be trusted (the verdict says why),\n"
    "  130 interrupted by Ctrl-C (143 by SIGTERM, 129 by SIGHUP) with complete files.\n"
    "With --json an error is {\"error\": {\"kind\", \"exit_code\", \"message\"}} on stdout, beside the line on "
    "stderr.\n"
    "See `edged help COMMAND`.";

/// Descriptions of options and commands in a column of their own that ends at the width of a terminal.
class WrappedHelp : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool positional) const override {
    std::string text;
    for (const std::string& line : CLI::detail::split(CLI::Formatter::make_option(option, positional), '\n'))
      text += edged::wrapped(line, get_column_width()) + '\n';
    return text;
  }
  std::string make_subcommand(const CLI::App* command) const override {
    return edged::wrapped(CLI::Formatter::make_subcommand(command), get_column_width());
  }
};

/// The command line; `help COMMAND` as `COMMAND --help`.
std::vector<char*> words_of(int argc, char** argv) {
  static char flag[] = "--help";
  std::vector<char*> words(argv, argv + argc);
  if (words.size() > 1 && words[1] == std::string_view("help")) {
    words.erase(words.begin() + 1);
    words.push_back(flag);
  }
  return words;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace edged;
  CLI::App app{"Edged USLAM: visual-inertial odometry from events, frames and an IMU", "edged"};
  app.require_subcommand(1);
  app.set_version_flag("--version", fmt::format("edged {}", kVersion));
  app.formatter(std::make_shared<WrappedHelp>());
  std::function<int()> chosen;
  for (AddCommand* add :
       {add_run_command, add_info_command, add_show_command, add_doctor_command, add_convert_command, add_calib_command,
        add_simulate_command, add_eval_command, add_report_command, add_map_command, add_depth_command,
        add_config_command, add_ros2_command, add_play_command, add_manual_command})
    add(app, chosen);
  app.footer(kFooter);  // last, as commands take it over
  if (argc < 2) {
    fmt::print("{}", app.help());
    return kExitUsage;
  }
  std::vector<char*> words = words_of(argc, argv);
  return run_program(app, static_cast<int>(words.size()), words.data(), [&] { return chosen(); });
}
