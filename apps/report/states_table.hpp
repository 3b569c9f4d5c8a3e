// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Tables of a run folder: states.csv, of any version as columns, and readers of pace.csv and keyframes.csv.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/step_numbers.hpp"
#include "edged/eval/consistency.hpp"
#include "edged/final_trajectory.hpp"
#include "edged/odometry.hpp"
#include "edged/state.hpp"
#include "edged/step.hpp"

namespace edged {

/// The columns of states.csv after t_ns and status.
std::vector<std::string> state_columns();
/// The numbers of a step in these columns; NaN where it has none.
std::vector<double> state_numbers(const Step& step);
/// The first lines of states.csv, and the line of a step.
std::string states_heading();
std::string state_line(const Step& step);

struct StatesTable {
  std::vector<Timestamp> t;
  std::vector<TrackingStatus> status;
  std::map<std::string, std::vector<double>> columns;  ///< by the names of the heading; NaN where a field is empty

  /// One number a row; null where there is no such column.
  const std::vector<double>* find(const std::string& column) const;
};

/// Reads states.csv of a run folder. Truncated lines, such as the last one after a kill, are skipped. Throws InputError
/// when there is no such file, or it has other columns.
StatesTable read_states(const std::filesystem::path& folder);

/// Good and Degraded rows as T_W_B on the IMU clock. rows: gets the row of each.
Trajectory body_poses(const StatesTable& states, std::vector<std::size_t>* rows = nullptr);

/// The poses whose covariance was computed at their step.
std::vector<StateCovarianceSample> covariance_samples_of(const StatesTable& states);

/// Collects the poses whose covariance was computed at their step, and all Degraded ones that have one; relocalization
/// begins a new reference.
class CovarianceSamples {
 public:
  /// Every step, in time order.
  void add(const Step& step);
  const std::vector<StateCovarianceSample>& all() const { return samples_; }

 private:
  std::vector<StateCovarianceSample> samples_;
  int reference_ = 0;
};

/// The first line of pace.csv, and the line of a step.
std::string pace_heading();
std::string pace_line(Timestamp t, const PacketPace& pace);

/// Adds the columns processing_ms and latency_ms, if the run's folder has them.
void read_pace(const std::filesystem::path& folder, StatesTable& states);

/// keyframes.csv of a run's folder, without their points; empty where there is no such file.
std::vector<MappedKeyframe> read_keyframes(const std::filesystem::path& folder);

}  // namespace edged
