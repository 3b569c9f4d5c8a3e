// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the node logs: changes of the status, what it waits for, overload, and what is wrong with topics.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "edged/live/drop_report.hpp"
#include "node/diagnostics.hpp"

namespace edged::node {

class StatusLog {
 public:
  /// Each step, in order.
  void add(const Step& step);
  /// Logs each trouble once, and every few seconds what it waits for before the first pose; the counters go on in the
  /// diagnostics. Fills in the status, and what is newly lost.
  void complete(NodeHealth& health);

 private:
  std::optional<TrackingStatus> status_;
  std::string reason_;
  std::size_t lost_ = 0;        ///< lost_measurements of the last health
  std::set<std::string> said_;  ///< troubles that have been logged
  DropReport drops_;
  DropReport::Clock::time_point waits_from_ = DropReport::Clock::now();  ///< of the last line on what it waits for
};

}  // namespace edged::node
