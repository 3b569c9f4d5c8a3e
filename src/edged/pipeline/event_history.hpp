// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The events of one camera that packets still need: the new ones, and those before that a window reaches back to.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "edged/options.hpp"
#include "edged/pipeline/packet.hpp"
#include "edged/rig.hpp"

namespace edged {

class EventHistory {
 public:
  EventHistory(const RigCamera& camera, const PacketizerConfig& config);

  const std::string& camera() const { return camera_; }
  Duration offset() const { return offset_; }
  /// Takes events of the camera's clock over to the IMU's. Those not after the last cut, or before one that has come,
  /// are left out: how many.
  std::size_t add(const std::vector<Event>& events, Timestamp last_cut);

  /// The stamp of the event that completes the count of a packet; nothing while there are fewer.
  std::optional<Timestamp> complete() const;
  std::size_t new_events() const { return events_.size() - uncut_begin_; }
  std::optional<Timestamp> newest() const { return events_.empty() ? std::nullopt : std::optional(events_.back().t); }

  /// What a packet cut at t holds; the one before was cut at last_cut.
  PacketEvents take(Timestamp t, Timestamp last_cut);
  /// New events that no packet will take: how many.
  std::size_t give_up();

 private:
  std::string camera_;
  Duration offset_;
  std::size_t cut_events_, window_events_;  // per packet
  double max_age_s_;
  std::vector<Event> events_;  // history, then the uncut ones
  std::size_t history_begin_ = 0, uncut_begin_ = 0;
};

}  // namespace edged
