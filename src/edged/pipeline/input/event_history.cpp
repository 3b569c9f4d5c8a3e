// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/input/event_history.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "edged/pipeline/tuning.hpp"

namespace edged {
namespace {

std::size_t count_of(double per_pixel, const CameraModel& camera) {
  return static_cast<std::size_t>(std::max(1.0, std::round(per_pixel * camera.width() * camera.height())));
}

}  // namespace

EventHistory::EventHistory(const RigCamera& camera, const PacketizerConfig& config)
    : camera_(camera.name),
      offset_(camera.time_offset),
      cut_events_(count_of(config.events_per_pixel, camera.model)),
      window_events_(count_of(config.window_per_pixel, camera.model)),
      max_age_s_(config.max_age_s) {
  if (config.remove_flicker) flicker_.emplace(camera.model.width(), camera.model.height());
}

/// Whether the newest events have filled a packet that an event at t cannot yet cut.
bool EventHistory::in_full_burst(Timestamp t) const {
  constexpr std::size_t kMost = kPipelineTuning.max_burst_events;
  return events_.size() >= kMost && events_[events_.size() - kMost].t > t - kPipelineTuning.burst;
}

/// Adds all of them at once, or none if they are not in order, or some may be of a burst or of lamps.
bool EventHistory::append(const std::vector<Event>& events, Timestamp last_cut) {
  const Timestamp first = events.front().t + offset_;
  if (first <= last_cut || (!events_.empty() && first < events_.back().t)) return false;
  if (events_.size() + events.size() > kPipelineTuning.max_burst_events) return false;
  if (!std::ranges::is_sorted(events, {}, &Event::t)) return false;
  const std::size_t before = events_.size();
  events_.insert(events_.end(), events.begin(), events.end());
  const std::span<Event> added = std::span(events_).subspan(before);
  if (offset_ != Duration(0))
    for (Event& event : added) event.t += offset_;
  const bool all_stay = !flicker_ || flicker_->drops_none(added);
  if (!all_stay) events_.resize(before);
  return all_stay;
}

EventHistory::Dropped EventHistory::add(const std::vector<Event>& events, Timestamp last_cut) {
  Dropped dropped;
  if (events.empty() || append(events, last_cut)) return dropped;
  for (Event event : events) {
    event.t += offset_;
    if (event.t <= last_cut || (!events_.empty() && event.t < events_.back().t)) {
      ++dropped.late;
    } else if (in_full_burst(event.t)) {
      ++dropped.surplus;
    } else if (flicker_ && flicker_->drops(event)) {
      ++dropped.flicker;
    } else {
      events_.push_back(event);
    }
  }
  return dropped;
}

std::optional<Timestamp> EventHistory::complete() const {
  const std::size_t last = uncut_begin_ + cut_events_ - 1;
  return last < events_.size() ? std::optional(events_[last].t) : std::nullopt;
}

PacketEvents EventHistory::take(Timestamp t, Timestamp last_cut) {
  const auto index_of = [&](auto it) { return static_cast<std::size_t>(it - events_.begin()); };
  const auto at = [&](std::size_t i) { return events_.begin() + static_cast<std::ptrdiff_t>(i); };
  const std::size_t end = index_of(std::upper_bound(at(uncut_begin_), events_.end(), t,
                                                    [](Timestamp end_t, const Event& e) { return end_t < e.t; }));
  const Timestamp oldest = t - duration_from_seconds(max_age_s_);
  std::size_t window_begin = index_of(
      std::lower_bound(at(history_begin_), at(end), oldest, [](const Event& e, Timestamp from) { return e.t < from; }));
  if (end - window_begin > window_events_) window_begin = end - window_events_;

  PacketEvents taken;
  taken.camera = camera_;
  taken.events.assign(at(std::min(window_begin, uncut_begin_)), at(end));
  taken.new_events = end - uncut_begin_;
  taken.window_events = end - window_begin;
  taken.event_rate_hz = static_cast<double>(taken.new_events) / std::max(1e-3, to_seconds(t - last_cut));

  if (flicker_) taken.lamp = flicker_->detector().lamp_at(t);

  history_begin_ = window_begin;
  uncut_begin_ = end;
  if (history_begin_ < events_.size() / 2) return taken;
  events_.erase(events_.begin(), at(history_begin_));
  uncut_begin_ -= history_begin_;
  history_begin_ = 0;
  return taken;
}

std::size_t EventHistory::give_up() {
  const std::size_t count = new_events();
  uncut_begin_ = events_.size();
  return count;
}

}  // namespace edged
