// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// states.csv as columns, whatever version wrote it, and what is read from them.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "edged/eval/consistency.hpp"
#include "edged/state.hpp"
#include "edged/step.hpp"

namespace edged {

struct StatesTable {
  std::vector<Timestamp> t;
  std::vector<TrackingStatus> status;
  std::map<std::string, std::vector<double>> columns;  ///< by the names of the heading; NaN where a field is empty

  /// One number a row; null where there is no such column.
  const std::vector<double>* find(const std::string& column) const;
};

/// Of a run's folder. Lines that are cut short, as a kill may leave the last one, are left out. Throws InputError when
/// there is no such file, or it has other columns.
StatesTable read_states(const std::filesystem::path& folder);

/// Good and Degraded rows as T_W_B on the IMU clock. rows: gets the row of each.
Trajectory body_poses(const StatesTable& states, std::vector<std::size_t>* rows = nullptr);

/// Those of the poses whose covariance was worked out anew.
std::vector<PoseCovarianceSample> covariance_samples_of(const StatesTable& states);

}  // namespace edged
