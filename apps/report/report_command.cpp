// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/command.hpp"
#include "common/files.hpp"
#include "report/report_data.hpp"
#include "report/report_page.hpp"

namespace edged {
namespace {

struct ReportCommand {
  std::vector<std::filesystem::path> runs;
  std::filesystem::path out;
  ReportOptions report;
  bool json = false;
};

int write_report(const ReportCommand& options) {
  const bool one_folder = options.runs.size() == 1 && std::filesystem::is_directory(options.runs[0]);
  std::filesystem::path out = one_folder && options.out.empty() ? options.runs[0] : options.out;
  if (out.empty() || std::filesystem::is_directory(out)) out /= "report.html";
  check_writable(out, "--out", kPageBegin);
  write_file(out, report_page(report_data(options.runs, options.report)));
  print_result(options.json, {{"out", out.string()}}, out.string() + "\n");
  return kExitOk;
}

}  // namespace

void add_report_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<ReportCommand>();
  CLI::App* report = app.add_subcommand("report", "Make one page that shows runs side by side");
  report
      ->add_option("RUN", options->runs,
                   "Run folders of `edged run`, or trajectory files of other programs for the same sensor")
      ->required();
  report->add_option("--out", options->out, "Page to write [report.html; for one run in its folder]");
  report->add_option("--truth", options->report.truth,
                     "Ground truth of the sensor that the trajectory files are of [that of each run]");
  add_evaluation_options(*report, options->report.how);
  finish_command(*report, options,
                 "Examples:\n"
                 "  edged report runs/boxes-fused\n"
                 "  edged report runs/boxes-fused runs/boxes-events runs/boxes-frames --out modes.html\n"
                 "  edged report runs/boxes-fused other_slam.tum --truth groundtruth.txt --protocol P1",
                 chosen, write_report);
}

}  // namespace edged
