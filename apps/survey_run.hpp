// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// One pass through a recording, for `edged info` and `edged doctor`.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "edged/survey/survey.hpp"
#include "source.hpp"

namespace edged {

struct SurveyRun {
  Survey survey;
  std::optional<std::string> damage;  ///< why the recording could not be read beyond what was surveyed
};

/// With a status line. Ends early, with what was read so far, when the user interrupts. also: sees every measurement;
/// may be empty.
SurveyRun survey_recording(Dataset& dataset, bool quiet, const std::function<void(const Measurement&)>& also);

}  // namespace edged
