// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How long the program took for each packet: pace.csv, beside states.csv, which is the same in every run.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>

#include "edged/time.hpp"
#include "states_table.hpp"

namespace edged {

struct PacketPace {
  double processing_ms = 0;          ///< the odometry's work on it
  std::optional<double> latency_ms;  ///< live runs: from when it was measured to its result
};

/// Complete lines, as those of states.csv.
class PaceWriter {
 public:
  explicit PaceWriter(const std::filesystem::path& folder);
  void add(Timestamp t, const PacketPace& pace);

 private:
  std::ofstream out_;
};

/// Adds the columns processing_ms and latency_ms, where the run's folder has them.
void read_pace(const std::filesystem::path& folder, StatesTable& states);

}  // namespace edged
