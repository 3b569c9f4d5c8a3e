// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// metrics.json and timing.json, and report.html, which is made from the files of a run.
#include "common/files.hpp"
#include "common/json_text.hpp"
#include "report/report_page.hpp"
#include "run/run_context.hpp"

namespace edged {
namespace {

class SummaryFiles : public RunObserver {
 public:
  explicit SummaryFiles(const RunContext& run) : run_(run) {}
  void on_end(const RunEnd& end) override {
    write_file(run_.folder / "timing.json", timing_json(end.timings, run_.timings));
    write_file(run_.folder / "metrics.json", json_text(to_json(end.summary)) + "\n");
  }

 private:
  const RunContext& run_;
};

class ReportFile : public RunObserver {
 public:
  explicit ReportFile(const RunContext& run) : run_(run) {}
  void on_end(const RunEnd&) override { write_run_report(run_.folder); }

 private:
  const RunContext& run_;
};

}  // namespace

RunOutput summary_output() { return always<SummaryFiles>({"metrics.json", "timing.json"}); }
RunOutput report_output() { return always<ReportFile>({"report.html"}); }

}  // namespace edged
