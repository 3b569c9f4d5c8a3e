// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The verdict on the result of a run. Terminal, page, metrics.json and exit code share it.
#pragma once

#include "common/source.hpp"
#include "run/run_summary.hpp"

namespace edged {

enum class Ending { Complete, Interrupted, BrokenOff };

/// Sets the verdict by all that the summary holds: the findings so far (of recording and map), the estimate, and how it
/// compares with ground truth. Called once, when nothing more will be known.
void judge_run(RunSummary& summary, const SourceOptions& source, Ending ending);

}  // namespace edged
