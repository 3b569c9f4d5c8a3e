// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/reading.hpp"

#include "common/interrupt.hpp"
#include "common/status_line.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {

void read_through(Dataset& dataset, bool quiet, std::string_view what,
                  const std::function<bool(const Measurement&)>& use) {
  StatusLine status(quiet);
  InterruptibleDataset recording(dataset);
  while (const std::optional<Measurement> measurement = recording.next()) {
    if (!use(*measurement)) return;
    if (const auto t = last_stamp(*measurement)) show_progress(status, *t, dataset.info(), what);
  }
}

}  // namespace edged
