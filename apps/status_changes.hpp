// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// When the status of a run changed, and why; and when it was found again in the map.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "edged/step.hpp"

namespace edged {

/// The first of them are shown, by the report and by the live page.
inline constexpr std::size_t kMostChangesShown = 300;

struct StatusChange {
  Timestamp t;
  TrackingStatus status;
  std::string reason;        ///< what was missing last, while it lasts; "" where there is nothing to say
  bool relocalized = false;  ///< in the map; the status may have been this before
};

/// Why the status is what it is: what a start waits for, what ended the estimate, how it started.
std::string reason_of(const Step& step);

class StatusChanges {
 public:
  void add(const Step& step);
  const std::vector<StatusChange>& all() const { return changes_; }

 private:
  std::vector<StatusChange> changes_;
};

}  // namespace edged
