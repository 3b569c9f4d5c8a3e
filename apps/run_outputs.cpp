// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run_outputs.hpp"

namespace edged {

// Each is defined in the source of its name, in outputs/, scene/ or live/.
RunOutput autopilot_output(), status_line_output(), log_output(), checks_output(), map_output(), states_output(),
    external_samples_output(), summary_output(), snapshots_output(), final_trajectory_output(), export_output(),
    dense_output(), occupancy_output(), report_output(), mcap_output(), live_page_output();

std::vector<RunOutput> run_outputs() {
  return {
      autopilot_output(),  // first, as it is not to wait for the others
      status_line_output(),
      log_output(),
      checks_output(),
      map_output(),
      states_output(),
      external_samples_output(),
      summary_output(),    // before large outputs, and those that `edged report` can write again
      snapshots_output(),  // which those below show
      final_trajectory_output(),
      export_output(),
      dense_output(),
      occupancy_output(),  // uses the points of the one above
      report_output(),     // uses the files of those above
      mcap_output(),
      live_page_output(),
  };
}

}  // namespace edged
