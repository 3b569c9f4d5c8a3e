// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The events of one camera that packets still need: the new ones, and older ones within the window.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "edged/events/flicker.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/input/packet.hpp"
#include "edged/rig.hpp"

namespace edged {

class EventHistory {
 public:
  EventHistory(const RigCamera& camera, const PacketizerConfig& config);

  const std::string& camera() const { return camera_; }
  Duration offset() const { return offset_; }
  struct Dropped {
    std::size_t late = 0;     ///< not after the last cut, or before an earlier event
    std::size_t surplus = 0;  ///< of a burst that is too large for a packet
    std::size_t flicker = 0;  ///< caused by lamps
  };
  /// Adds events, converted from the camera clock to the IMU clock.
  Dropped add(const std::vector<Event>& events, Timestamp last_cut);

  /// The stamp of the event that completes the count of a packet; nothing while there are fewer.
  std::optional<Timestamp> complete() const;
  std::size_t new_events() const { return events_.size() - uncut_begin_; }
  std::optional<Timestamp> newest() const { return events_.empty() ? std::nullopt : std::optional(events_.back().t); }

  /// The events of a packet cut at t; the one before was cut at last_cut.
  PacketEvents take(Timestamp t, Timestamp last_cut);
  /// Drops new events that are in no packet; returns how many.
  std::size_t give_up();

 private:
  bool append(const std::vector<Event>& events, Timestamp last_cut);
  bool in_full_burst(Timestamp t) const;

  std::string camera_;
  Duration offset_;
  std::size_t cut_events_, window_events_;  // per packet
  double max_age_s_;
  std::optional<FlickerFilter> flicker_;  // if the option is set
  std::vector<Event> events_;             // history, then the uncut ones
  std::size_t history_begin_ = 0, uncut_begin_ = 0;
};

}  // namespace edged
