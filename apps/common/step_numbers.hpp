// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Numbers of a step for tables, plots and reports: per modality, age of map matches, status changes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "edged/step.hpp"

namespace edged {

struct ModalityNumbers {
  std::size_t tracks = 0;               ///< of all cameras
  std::optional<double> survival_rate;  ///< mean over the cameras; nothing without a camera of the modality
  double event_rate_hz = 0.0;           ///< of all cameras
};

ModalityNumbers modality_numbers(const Step& step, Modality modality);

/// Time since the oldest keyframe with a map match in the images of this step. Nothing without a match.
std::optional<double> map_reach_s(const Step& step);

/// Processing time of a packet.
struct PacketPace {
  double processing_ms = 0;          ///< the odometry's work on it
  std::optional<double> latency_ms;  ///< live runs: from measurement to result
};

/// Report and live page show at most this many, the first ones.
inline constexpr std::size_t kMostChangesShown = 300;

struct StatusChange {
  Timestamp t;
  TrackingStatus status;
  std::string reason;        ///< the last reason, while it lasts; "" without one
  bool relocalized = false;  ///< in the map; the status may be unchanged
};

/// The reason of the status: what initialization waits for, what ended the estimate, how it was initialized.
std::string reason_of(const Step& step);

class StatusChanges {
 public:
  void add(const Step& step);
  const std::vector<StatusChange>& all() const { return changes_; }

 private:
  std::vector<StatusChange> changes_;
};

}  // namespace edged
