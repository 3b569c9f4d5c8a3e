// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What tables, plots and reports say of a step: numbers of a kind of camera, reach of the map, changes of the status.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "edged/step.hpp"

namespace edged {

struct KindNumbers {
  std::size_t tracks = 0;               ///< of all cameras
  std::optional<double> survival_rate;  ///< the mean; nothing where the run has no such camera
  double event_rate_hz = 0.0;           ///< of all cameras
};

KindNumbers numbers_of(const Step& step, Modality modality);

/// Since the oldest keyframe of which the map found a point in this packet's image; nothing where it found none.
std::optional<double> map_reach_s(const Step& step);

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
