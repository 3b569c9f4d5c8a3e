// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/input/packetizer.hpp"

#include <algorithm>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/pipeline/tuning.hpp"

namespace edged {
namespace {

constexpr Duration kTick(1);

}  // namespace

void PacketizerConfig::visit(ConfigFields& fields) {
  fields.add("events_per_pixel", events_per_pixel,
             {"1/px", 0.001, 100,
              "A packet is made after this many new events per pixel. Fewer give more packets per second."});
  fields.add("window_per_pixel", window_per_pixel,
             {"1/px", 0.001, 100, "Number of events per pixel in one event frame, older packets' events included."});
  fields.add("max_age_s", max_age_s, {"s", 0.001, 10, "Event frames leave out events older than this."});
  fields.add("max_interval_s", max_interval_s,
             {"s", 0.001, 1, "Longest time between two packets, also at standstill."});
  fields.add("min_interval_s", min_interval_s,
             {"s", 0, 1, "Shortest time between two packets without a frame. It bounds the computing time."});
  fields.add(
      "remove_flicker", remove_flicker,
      {.effect = "Leave out events of lamps on mains or PWM, while the event rate of the whole image oscillates."});
  fields.add("max_waiting_events", max_waiting_events,
             {"events", 1000, 1e9,
              "Largest number of events that wait for the IMU. The oldest packets beyond it are dropped."});
}

Packetizer::Packetizer(const Rig& cameras, const PacketizerConfig& config, const PacketizerCounters& so_far)
    : config_(config),
      frames_(cameras),
      completion_(config.max_waiting_events, so_far.imu),
      counters_(so_far),
      least_offset_(cameras.cameras.front().time_offset) {
  if (config_.min_interval_s > config_.max_interval_s) {
    throw InputError::format("packets.min_interval_s = {} is above packets.max_interval_s = {}: lower it",
                             config_.min_interval_s, config_.max_interval_s);
  }
  for (const RigCamera& camera : cameras.cameras) {
    least_offset_ = std::min(least_offset_, camera.time_offset);
    if (camera.modality != Modality::Events) continue;
    if (events_.empty()) event_offset_ = camera.time_offset;
    events_.emplace_back(camera, config_);
  }
}

/// The stream is in the order of the recorded stamps, ties broken IMU, events, frame: later measurements are not before
/// the stamp of the newest one, and after a frame not at it either, unless there is another frame camera.
void Packetizer::add(Measurement measurement) {
  if (const auto* batch = std::get_if<EventBatch>(&measurement)) {
    if (batch->events.empty()) return;
    const Timestamp first = batch->events.front().t, last = batch->events.back().t;
    // Batches of two event cameras overlap, and their boundaries are arbitrary. While IMU samples or frames arrive,
    // only these mark the progress of the stream, as their order among the events does not depend on the boundaries.
    advance_clock(last, events_.size() > 1 ? first - kPipelineTuning.clock_jump : last - kTick);
    add_events(*batch);
  } else if (auto* frame = std::get_if<Frame>(&measurement)) {
    advance_clock(frame->t, frames_.cameras() > 1 ? frame->t - kTick : frame->t);
    add_frame(std::move(*frame));
  } else if (const auto* external = std::get_if<ExternalSample>(&measurement)) {
    return completion_.add(*external, counters_);
  } else {
    const ImuSample& sample = std::get<ImuSample>(measurement);
    advance_clock(sample.t, sample.t - kTick);
    completion_.add(sample, counters_);
  }
  if (complete_ != Timestamp::min()) make_packets(complete_ + least_offset_);
}

void Packetizer::advance_clock(Timestamp recorded, Timestamp complete) {
  if (last_recorded_ && to_seconds(recorded - *last_recorded_) > kPipelineTuning.max_gap_s)
    heartbeat_from_ = recorded + event_offset_;
  if (!last_recorded_ || recorded > *last_recorded_) last_recorded_ = recorded;
  complete_ = std::max(complete_, complete);
}

/// The first event or frame: packets start just before it.
void Packetizer::start_at(Timestamp t) {
  if (started_) return;
  started_ = true;
  last_cut_ = heartbeat_from_ = t - kTick;
  // Another sensor is far ahead already, by another clock or a damaged stamp: no cuts by time from here to there.
  const Timestamp complete = complete_ + event_offset_;
  if (complete - t > kPipelineTuning.clock_jump) heartbeat_from_ = complete;
}

void Packetizer::add_events(const EventBatch& batch) {
  const auto history = std::ranges::find(events_, batch.camera, &EventHistory::camera);
  if (history == events_.end()) return;
  start_at(batch.events.front().t + history->offset());
  const EventHistory::Dropped dropped = history->add(batch.events, last_cut_);
  counters_.events_late += dropped.late, counters_.events_surplus += dropped.surplus;
  counters_.events_flicker += dropped.flicker;
}

void Packetizer::add_frame(Frame frame) {
  const std::optional<Duration> offset = frames_.offset(frame.camera);
  if (!offset) return;
  frame.t += *offset;
  start_at(frame.t);
  if (!frames_.add(std::move(frame), last_cut_)) ++counters_.frames_late;
}

void Packetizer::make_packets(Timestamp complete_until) {
  while (started_) {
    const Timestamp by_time = next_cut_without_frame();
    const bool by_frame = !frames_.empty() && frames_.first() <= by_time;
    const Timestamp t = by_frame ? frames_.first() : by_time;
    if ((by_frame ? t + frames_.wait() : t) > complete_until) return;
    make_packet(t, by_frame);
  }
}

/// The cut by a count of events or by the longest time, unless a frame is before it.
Timestamp Packetizer::next_cut_without_frame() const {
  if (events_.empty()) return heartbeat_from_ + kPipelineTuning.frame_heartbeat;
  Timestamp t = heartbeat_from_ + duration_from_seconds(config_.max_interval_s);
  for (const EventHistory& history : events_) t = std::min(t, history.complete().value_or(t));
  const Duration spacing = duration_from_seconds(config_.min_interval_s);
  return frames_.yield(std::max(t, last_cut_ + std::max(spacing, kTick)), spacing);
}

void Packetizer::make_packet(Timestamp t, bool by_frame) {
  Packet packet;
  packet.t = t;
  for (EventHistory& history : events_) packet.events.push_back(history.take(t, last_cut_));
  if (by_frame) {
    frames_.take(packet);
  } else if (events_.empty()) {
    ++counters_.frames_missing;
  }
  last_cut_ = t;
  heartbeat_from_ = std::max(heartbeat_from_, t);
  completion_.add(std::move(packet), counters_);
}

void Packetizer::finish() {
  Timestamp end = last_cut_;
  for (const EventHistory& history : events_) end = std::max(end, history.newest().value_or(end));
  if (!frames_.empty()) end = std::max(end, frames_.last());
  make_packets(end + frames_.wait());
  const bool rest = std::ranges::any_of(events_, [](const EventHistory& history) { return history.new_events() > 0; });
  if (rest && end - last_cut_ >= duration_from_seconds(config_.min_interval_s)) make_packet(end, false);
  for (EventHistory& history : events_) counters_.events_lost += history.give_up();
  completion_.finish(counters_);
}

}  // namespace edged
