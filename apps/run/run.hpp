// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// One run: from a recording and its options to the run folder.
#pragma once

#include <memory>
#include <vector>

#include "run/run_observer.hpp"

namespace edged {

class RunReader;

/// One run from the first measurement to the complete files.
class Run {
 public:
  /// Makes the run folder; `options` must outlive the run. Throws InputError if it cannot run.
  Run(const RunOptions& options, Source source, Mode mode, const RunConfig& config);
  RunSummary go();

 private:
  void make_folder();
  std::optional<Measurement> next_measurement(RunReader& reader);
  void observe(const Step& step, RunReader& reader);
  RunSummary finish(RunReader& reader, bool broken_off);
  RunEnd summarize(const RunReader& reader, bool broken_off);
  void compare_with_truth(RunEnd& end) const;

  RunContext run_;
  OwnTruth truth_;
  std::vector<std::unique_ptr<RunObserver>> observers_;
};

}  // namespace edged
