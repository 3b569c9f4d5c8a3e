// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "survey_run.hpp"

#include "edged/core/check.hpp"
#include "edged/core/measurement_stamps.hpp"
#include "interrupt.hpp"
#include "status_line.hpp"

namespace edged {

SurveyRun survey_recording(Dataset& dataset, bool quiet, const std::function<void(const Measurement&)>& also) {
  Surveyor surveyor(dataset.info());
  StatusLine status(quiet);
  InterruptibleDataset recording(dataset);
  std::optional<std::string> damage;
  try {
    while (const auto measurement = recording.next()) {
      surveyor.add(*measurement);
      if (also) also(*measurement);
      if (const auto t = last_stamp(*measurement); t && status.due())
        status.show(progress_text(*t, dataset.info(), "read"));
    }
  } catch (const InputError& error) {
    damage = error.what();
  }
  return {surveyor.result(dataset, dataset.ground_truth()), damage};
}

}  // namespace edged
