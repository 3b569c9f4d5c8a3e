// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// One run: from a recording and its options to the run folder.
#pragma once

#include <memory>
#include <vector>

#include "edged/odometry.hpp"
#include "run/run_context.hpp"

namespace edged {

class RunReader;

/// One run from the first measurement to the complete files.
class Run {
 public:
  /// Makes the run folder; `context` must outlive the run. outputs: in the order of their calls. Throws InputError if
  /// it cannot run.
  Run(RunContext& context, const std::vector<RunOutput>& outputs);
  RunSummary go();

 private:
  void make_folder(const std::vector<RunOutput>& outputs);
  std::optional<Measurement> next_measurement(RunReader& reader);
  void observe(const Step& step, RunReader& reader);
  void update_context();
  RunSummary finish(RunReader& reader, bool broken_off);
  /// Earlier results stay, in complete files.
  RunSummary break_off(RunReader& reader, const std::exception& error);
  RunEnd summarize(const RunReader& reader, bool broken_off);
  void compare(RunEnd& end) const;

  RunContext& run_;
  Odometry odometry_;
  OwnTruth truth_;
  std::vector<std::unique_ptr<RunObserver>> observers_;
};

}  // namespace edged
