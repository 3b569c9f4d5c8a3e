// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/packetizer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/imu/preintegration.hpp"

namespace edged {
namespace {

constexpr Duration kTick(1);
constexpr Duration kHole = std::chrono::seconds(1);  // a silence of all sensors: no heartbeats inside
constexpr Duration kImuBeforeFirst = std::chrono::seconds(20);
constexpr Duration kFramesGivenUp = std::chrono::seconds(5);          // longer than any status takes to become Lost
constexpr Duration kMaxFramePeriod = std::chrono::milliseconds(500);  // slower frames are not waited for
constexpr std::size_t kMaxWaitingPackets = 256;

std::size_t count_of(double per_pixel, const CameraModel& camera) {
  return static_cast<std::size_t>(std::max(1.0, std::round(per_pixel * camera.width() * camera.height())));
}

}  // namespace

void PacketizerConfig::visit(ConfigFields& fields) {
  fields.add("events_per_pixel", events_per_pixel,
             {"1/px", 0.001, 100, "new events per pixel that cut a packet; fewer give more packets per second"});
  fields.add(
      "window_per_pixel", window_per_pixel,
      {"1/px", 0.001, 100, "events per pixel that are drawn into one event frame, reaching back past the last cut"});
  fields.add("max_age_s", max_age_s, {"s", 0.001, 10, "events older than this are not drawn, however few there are"});
  fields.add("max_interval_s", max_interval_s,
             {"s", 0.001, 1, "longest time between two packets with events (the heartbeat at standstill)"});
  fields.add("min_interval_s", min_interval_s,
             {"s", 0, 1, "shortest time between two packets, unless a frame comes: bounds the computing time"});
  fields.add("max_waiting_events", max_waiting_events,
             {"events", 1000, 1e9, "events kept while the IMU is late; beyond, the oldest packets are dropped"});
}

Packetizer::Packetizer(const Rig& rig, Mode mode, const PacketizerConfig& config, const PacketizerCounters& so_far)
    : mode_(mode), config_(config), counters_(so_far) {
  if (config_.min_interval_s > config_.max_interval_s) {
    throw InputError::format("packets.min_interval_s = {} is above packets.max_interval_s = {}: lower it",
                             config_.min_interval_s, config_.max_interval_s);
  }
  if (const RigCamera* camera = used_camera(rig, mode_, Modality::Events)) {
    event_camera_ = camera->name;
    event_offset_ = camera->time_offset;
    cut_events_ = count_of(config_.events_per_pixel, camera->model);
    window_events_ = count_of(config_.window_per_pixel, camera->model);
  }
  if (const RigCamera* camera = used_camera(rig, mode_, Modality::Frames)) {
    frame_camera_ = camera->name;
    frame_offset_ = camera->time_offset;
  }
}

void Packetizer::add(Measurement measurement) {
  if (const auto* batch = std::get_if<EventBatch>(&measurement)) {
    if (batch->events.empty()) return;
    advance_clock(batch->events.back().t, false);
    if (mode_ != Mode::Frames && batch->camera == event_camera_) add_events(*batch);
  } else if (auto* frame = std::get_if<Frame>(&measurement)) {
    advance_clock(frame->t, true);
    if (mode_ != Mode::Events && frame->camera == frame_camera_) add_frame(std::move(*frame));
  } else {
    const ImuSample& sample = std::get<ImuSample>(measurement);
    advance_clock(sample.t, false);
    add_imu(sample);
  }
  Timestamp complete_until = Timestamp::max();
  if (mode_ != Mode::Frames) complete_until = std::min(complete_until, events_complete_);
  if (mode_ != Mode::Events) complete_until = std::min(complete_until, frames_complete_);
  make_packets(complete_until);
}

/// The stream is in the order of the recorded stamps, ties broken IMU, events, frame: what can still come is not before
/// `recorded`, and after a frame not at it either.
void Packetizer::advance_clock(Timestamp recorded, bool is_frame) {
  if (last_recorded_ && recorded - *last_recorded_ > kHole) heartbeat_from_ = recorded + event_offset_;
  if (!last_recorded_ || recorded > *last_recorded_) last_recorded_ = recorded;
  const Timestamp complete = is_frame ? recorded : recorded - kTick;
  events_complete_ = std::max(events_complete_, complete + event_offset_);
  frames_complete_ = std::max(frames_complete_, complete + frame_offset_);
}

/// The first event or frame: time starts just before it.
void Packetizer::start_at(Timestamp t) {
  if (started_) return;
  started_ = true;
  last_cut_ = heartbeat_from_ = t - kTick;
  // Another sensor is far ahead already, by another clock or a damaged stamp: no heartbeats from here to there.
  if (events_complete_ - t > kHole) heartbeat_from_ = events_complete_;
}

void Packetizer::add_events(const EventBatch& batch) {
  start_at(batch.events.front().t + event_offset_);
  for (Event event : batch.events) {
    event.t += event_offset_;
    const bool late = event.t <= last_cut_ || (!events_.empty() && event.t < events_.back().t);
    if (late) {
      ++counters_.events_late;
    } else {
      events_.push_back(event);
    }
  }
}

void Packetizer::add_frame(Frame frame) {
  frame.t += frame_offset_;
  start_at(frame.t);
  if (frame.t <= (frames_.empty() ? last_cut_ : frames_.back().t)) {
    ++counters_.frames_late;
    return;
  }
  frames_.push_back(std::move(frame));
}

void Packetizer::add_imu(const ImuSample& sample) {
  if (!imu_.empty() && sample.t <= imu_.back().t) {
    ++counters_.imu_late;
    return;
  }
  if (!sample.gyro_B.allFinite() || !sample.accel_B.allFinite()) {
    ++counters_.imu_not_finite;
    return;
  }
  imu_.push_back(sample);
  if (last_handed_out_ || sample.t - imu_.front().t <= 2 * kImuBeforeFirst) return;
  const auto keep = std::lower_bound(imu_.begin(), imu_.end(), sample.t - kImuBeforeFirst,
                                     [](const ImuSample& s, Timestamp t) { return s.t < t; });
  imu_.erase(imu_.begin(), keep);
}

void Packetizer::make_packets(Timestamp complete_until) {
  if (!started_) return;
  while (const std::optional<Cut> cut = next_cut(complete_until)) make_packet(*cut);
}

std::optional<Packetizer::Cut> Packetizer::next_cut(Timestamp complete_until) const {
  const bool frame_ready = !frames_.empty() && frames_.front().t <= complete_until;
  const Timestamp by_time = mode_ == Mode::Frames ? frames_given_up() : next_event_cut();
  if (frame_ready && frames_.front().t <= by_time) return Cut{frames_.front().t, true};
  if (by_time <= complete_until) return Cut{by_time, false};
  return std::nullopt;
}

/// Frames mode: where a packet without a frame is cut.
Timestamp Packetizer::frames_given_up() const { return heartbeat_from_ + kFramesGivenUp; }

/// Where the count or the longest time cuts, unless a frame comes before.
Timestamp Packetizer::next_event_cut() const {
  Timestamp t = heartbeat_from_ + duration_from_seconds(config_.max_interval_s);
  if (const std::size_t last = uncut_begin_ + cut_events_ - 1; last < events_.size()) t = std::min(t, events_[last].t);
  const Duration spacing = duration_from_seconds(config_.min_interval_s);
  t = std::max(t, last_cut_ + std::max(spacing, kTick));

  if (!frames_.empty()) return frames_.front().t - t < spacing ? std::max(t, frames_.front().t) : t;
  if (!expected_frame_) return t;
  const Timestamp frame_given_up = *expected_frame_ + frame_period_ / 10;
  const bool frame_is_due = t > *expected_frame_ - spacing && t < frame_given_up;
  return frame_is_due ? frame_given_up : t;
}

void Packetizer::make_packet(const Cut& cut) {
  Packet packet;
  packet.t = cut.t;
  if (mode_ != Mode::Frames) {
    take_events(packet);
  } else if (!cut.by_frame) {
    ++counters_.frames_missing;
  }
  if (cut.by_frame) {
    if (last_frame_) {
      frame_period_ = cut.t - *last_frame_;
      expected_frame_.reset();
      if (frame_period_ <= kMaxFramePeriod) expected_frame_ = cut.t + frame_period_;
    }
    last_frame_ = cut.t;
    packet.frame = std::move(frames_.front());
    frames_.pop_front();
  }
  last_cut_ = cut.t;
  heartbeat_from_ = std::max(heartbeat_from_, cut.t);
  waiting_events_ += packet.events.size();
  waiting_.push_back(std::move(packet));
  drop_overflow();
}

void Packetizer::take_events(Packet& packet) {
  const auto index_of = [&](auto it) { return static_cast<std::size_t>(it - events_.begin()); };
  const auto at = [&](std::size_t i) { return events_.begin() + static_cast<std::ptrdiff_t>(i); };
  const std::size_t end = index_of(
      std::upper_bound(at(uncut_begin_), events_.end(), packet.t, [](Timestamp t, const Event& e) { return t < e.t; }));
  const Timestamp oldest = packet.t - duration_from_seconds(config_.max_age_s);
  std::size_t window_begin = index_of(
      std::lower_bound(at(history_begin_), at(end), oldest, [](const Event& e, Timestamp t) { return e.t < t; }));
  if (end - window_begin > window_events_) window_begin = end - window_events_;

  packet.events.assign(at(std::min(window_begin, uncut_begin_)), at(end));
  packet.new_events = end - uncut_begin_;
  packet.window_events = end - window_begin;
  packet.event_rate_hz = static_cast<double>(packet.new_events) / std::max(1e-3, to_seconds(packet.t - last_cut_));

  history_begin_ = window_begin;
  uncut_begin_ = end;
  if (history_begin_ < events_.size() / 2) return;
  events_.erase(events_.begin(), at(history_begin_));
  uncut_begin_ -= history_begin_;
  history_begin_ = 0;
}

void Packetizer::drop_overflow() {
  while (waiting_.size() > 1 && (waiting_events_ > static_cast<std::size_t>(config_.max_waiting_events) ||
                                 waiting_.size() > kMaxWaitingPackets)) {
    ++counters_.packets_overflow;
    drop_waiting(waiting_.begin());
  }
}

void Packetizer::drop_waiting(const std::deque<Packet>::iterator& packet) {
  counters_.events_lost += packet->new_events;
  waiting_events_ -= packet->events.size();
  waiting_.erase(packet);
}

std::optional<Packet> Packetizer::next() {
  while (!waiting_.empty() && !imu_.empty() && waiting_.front().t <= imu_.back().t) {
    const Timestamp from = last_handed_out_.value_or(imu_.front().t);
    if (waiting_.front().t <= from) {
      ++counters_.packets_before_imu;
      drop_waiting(waiting_.begin());
      continue;
    }
    Packet packet = std::move(waiting_.front());
    waiting_.pop_front();
    waiting_events_ -= packet.events.size();
    packet.imu = slice_imu(imu_, from, packet.t);
    last_handed_out_ = packet.t;
    const auto after =
        std::upper_bound(imu_.begin(), imu_.end(), packet.t, [](Timestamp t, const ImuSample& s) { return t < s.t; });
    imu_.erase(imu_.begin(), after - 1);  // the sample at or before t starts the next packet
    ++counters_.packets;
    return packet;
  }
  return std::nullopt;
}

void Packetizer::finish() {
  Timestamp end = last_cut_;
  if (!events_.empty()) end = std::max(end, events_.back().t);
  if (!frames_.empty()) end = std::max(end, frames_.back().t);
  make_packets(end);
  const bool rest = started_ && uncut_begin_ < events_.size();
  if (rest && end - last_cut_ >= duration_from_seconds(config_.min_interval_s)) make_packet({end, false});
  counters_.events_lost += events_.size() - uncut_begin_;
  uncut_begin_ = events_.size();
  while (!waiting_.empty() && (imu_.empty() || waiting_.back().t > imu_.back().t)) {
    ++counters_.packets_after_imu;
    drop_waiting(std::prev(waiting_.end()));
  }
}

}  // namespace edged
