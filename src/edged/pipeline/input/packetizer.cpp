// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/input/packetizer.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/imu/preintegration.hpp"

namespace edged {
namespace {

constexpr Duration kTick(1);
constexpr Duration kHole = std::chrono::seconds(1);  // a gap of all sensors: no cuts by time inside
constexpr Duration kImuBeforeFirst = std::chrono::seconds(20);
constexpr Duration kFramesGivenUp = std::chrono::seconds(5);          // longer than the status takes to become Lost
constexpr Duration kMaxFramePeriod = std::chrono::milliseconds(500);  // no waiting for slower frames
constexpr std::size_t kMaxWaitingPackets = 256;
constexpr std::size_t kMaxWaitingExternal = 100'000;

/// Frames of several cameras closer in time than this belong together.
constexpr Duration kSynchronised = std::chrono::milliseconds(1);
/// Batches of two event cameras overlap, and their boundaries are arbitrary. While IMU samples or frames arrive, only
/// these mark the progress of the stream, as their order among the events does not depend on the boundaries.
constexpr Duration kEventsAlone = std::chrono::seconds(1);

std::size_t events_in(const Packet& packet) {
  std::size_t sum = 0;
  for (const PacketEvents& events : packet.events) sum += events.events.size();
  return sum;
}

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
      {.effect = "Leave out events of lamps on mains or PWM, while the events of the whole image swing together."});
  fields.add("max_waiting_events", max_waiting_events,
             {"events", 1000, 1e9,
              "Largest number of events that wait for the IMU. The oldest packets beyond it are dropped."});
}

Packetizer::Packetizer(const Rig& cameras, const PacketizerConfig& config, const PacketizerCounters& so_far)
    : config_(config), least_offset_(cameras.cameras.front().time_offset), counters_(so_far) {
  if (config_.min_interval_s > config_.max_interval_s) {
    throw InputError::format("packets.min_interval_s = {} is above packets.max_interval_s = {}: lower it",
                             config_.min_interval_s, config_.max_interval_s);
  }
  for (const RigCamera& camera : cameras.cameras) {
    least_offset_ = std::min(least_offset_, camera.time_offset);
    if (camera.modality == Modality::Events) {
      if (events_.empty()) event_offset_ = camera.time_offset;
      events_.emplace_back(camera, config_);
    } else {
      frame_cameras_.push_back({camera.name, camera.time_offset});
    }
  }
  if (frame_cameras_.size() > 1) frame_patience_ = kSynchronised;
}

Packetizer::FrameCamera* Packetizer::find_frame_camera(const std::string& name) {
  const auto found = std::ranges::find(frame_cameras_, name, &FrameCamera::name);
  return found == frame_cameras_.end() ? nullptr : &*found;
}

/// The stream is in the order of the recorded stamps, ties broken IMU, events, frame: later measurements are not before
/// the stamp of the newest one, and after a frame not at it either, unless there is another frame camera.
void Packetizer::add(Measurement measurement) {
  if (const auto* batch = std::get_if<EventBatch>(&measurement)) {
    if (batch->events.empty()) return;
    const Timestamp first = batch->events.front().t, last = batch->events.back().t;
    advance_clock(last, events_.size() > 1 ? first - kEventsAlone : last - kTick);
    add_events(*batch);
  } else if (auto* frame = std::get_if<Frame>(&measurement)) {
    advance_clock(frame->t, frame_cameras_.size() > 1 ? frame->t - kTick : frame->t);
    add_frame(std::move(*frame));
  } else if (const auto* external = std::get_if<ExternalSample>(&measurement)) {
    return add_external(*external);
  } else {
    const ImuSample& sample = std::get<ImuSample>(measurement);
    advance_clock(sample.t, sample.t - kTick);
    add_imu(sample);
  }
  if (complete_ != Timestamp::min()) make_packets(complete_ + least_offset_);
}

void Packetizer::advance_clock(Timestamp recorded, Timestamp complete) {
  if (last_recorded_ && recorded - *last_recorded_ > kHole) heartbeat_from_ = recorded + event_offset_;
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
  if (complete - t > kHole) heartbeat_from_ = complete;
}

void Packetizer::add_events(const EventBatch& batch) {
  const auto history = std::ranges::find(events_, batch.camera, &EventHistory::camera);
  if (history == events_.end()) return;
  start_at(batch.events.front().t + history->offset());
  const EventHistory::Dropped dropped = history->add(batch.events, last_cut_);
  counters_.events_late += dropped.late, counters_.events_flicker += dropped.flicker;
}

void Packetizer::add_frame(Frame frame) {
  FrameCamera* camera = find_frame_camera(frame.camera);
  if (camera == nullptr) return;
  frame.t += camera->offset;
  start_at(frame.t);
  if (frame.t <= std::max(last_cut_, camera->newest.value_or(last_cut_))) {
    ++counters_.frames_late;
    return;
  }
  camera->newest = frame.t;
  const auto after =
      std::upper_bound(frames_.begin(), frames_.end(), frame.t, [](Timestamp t, const Frame& f) { return t < f.t; });
  frames_.insert(after, std::move(frame));
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

void Packetizer::add_external(const ExternalSample& sample) {
  const Timestamp t = time_of(sample);
  if (last_handed_out_ && t <= *last_handed_out_) {
    ++counters_.external_late[sample.index()];
    return;
  }
  const auto after = std::ranges::upper_bound(external_, t, {}, [](const ExternalSample& one) { return time_of(one); });
  external_.insert(after, sample);
  if (external_.size() <= kMaxWaitingExternal) return;
  ++counters_.external_lost[external_.front().index()];
  external_.pop_front();
}

/// Those after `from`, up to `to`; older ones are dropped.
std::vector<ExternalSample> Packetizer::take_external(Timestamp from, Timestamp to) {
  std::vector<ExternalSample> taken;
  for (; !external_.empty() && time_of(external_.front()) <= to; external_.pop_front()) {
    const ExternalSample& sample = external_.front();
    const bool in_time = time_of(sample) > from;
    ++(in_time ? counters_.external : counters_.external_lost)[sample.index()];
    if (in_time) taken.push_back(sample);
  }
  return taken;
}

void Packetizer::make_packets(Timestamp complete_until) {
  if (!started_) return;
  while (const std::optional<Cut> cut = next_cut(complete_until)) make_packet(*cut);
}

std::optional<Packetizer::Cut> Packetizer::next_cut(Timestamp complete_until) const {
  const Timestamp by_time = events_.empty() ? frames_given_up() : next_event_cut();
  if (!frames_.empty() && frames_.front().t <= by_time) {
    const Timestamp t = frames_.front().t;
    return t + frame_patience_ <= complete_until ? std::optional(Cut{t, true}) : std::nullopt;
  }
  if (by_time <= complete_until) return Cut{by_time, false};
  return std::nullopt;
}

/// Without event cameras: the cut of a packet without a frame.
Timestamp Packetizer::frames_given_up() const { return heartbeat_from_ + kFramesGivenUp; }

/// The cut by a count or by the longest time, unless a frame is before it.
Timestamp Packetizer::next_event_cut() const {
  Timestamp t = heartbeat_from_ + duration_from_seconds(config_.max_interval_s);
  for (const EventHistory& history : events_) t = std::min(t, history.complete().value_or(t));
  const Duration spacing = duration_from_seconds(config_.min_interval_s);
  t = std::max(t, last_cut_ + std::max(spacing, kTick));

  if (!frames_.empty()) return frames_.front().t - t < spacing ? std::max(t, frames_.front().t) : t;
  for (const FrameCamera& camera : frame_cameras_) {
    if (!camera.expected) continue;
    const Timestamp given_up = *camera.expected + camera.period / 10;
    if (t > *camera.expected - spacing && t < given_up) t = given_up;
  }
  return t;
}

void Packetizer::make_packet(const Cut& cut) {
  Packet packet;
  packet.t = cut.t;
  for (EventHistory& history : events_) packet.events.push_back(history.take(cut.t, last_cut_));
  if (cut.by_frame) {
    take_frames(packet);
  } else if (events_.empty()) {
    ++counters_.frames_missing;
  }
  last_cut_ = cut.t;
  heartbeat_from_ = std::max(heartbeat_from_, cut.t);
  waiting_events_ += events_in(packet);
  waiting_.push_back(std::move(packet));
  drop_overflow();
}

/// The frame that cuts, and those of other cameras that belong to it.
void Packetizer::take_frames(Packet& packet) {
  while (!frames_.empty() && frames_.front().t <= packet.t + frame_patience_) {
    const Timestamp t = frames_.front().t;
    FrameCamera& camera = *find_frame_camera(frames_.front().camera);
    if (camera.cut >= packet.t) return;  // has a frame already: this one cuts the next packet
    if (camera.cut) {
      camera.period = t - *camera.cut;
      camera.expected.reset();
      if (camera.period <= kMaxFramePeriod) camera.expected = t + camera.period;
    }
    camera.cut = t;
    packet.frames.push_back(std::move(frames_.front()));
    frames_.pop_front();
  }
}

void Packetizer::drop_overflow() {
  while (waiting_.size() > 1 && (waiting_events_ > static_cast<std::size_t>(config_.max_waiting_events) ||
                                 waiting_.size() > kMaxWaitingPackets)) {
    ++counters_.packets_overflow;
    drop_waiting(waiting_.begin());
  }
}

void Packetizer::drop_waiting(const std::deque<Packet>::iterator& packet) {
  for (const PacketEvents& events : packet->events) counters_.events_lost += events.new_events;
  waiting_events_ -= events_in(*packet);
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
    waiting_events_ -= events_in(packet);
    packet.imu = slice_imu(imu_, from, packet.t);
    packet.external = take_external(from, packet.t);
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
  for (const EventHistory& history : events_) end = std::max(end, history.newest().value_or(end));
  if (!frames_.empty()) end = std::max(end, frames_.back().t);
  make_packets(end + frame_patience_);
  const bool rest = std::ranges::any_of(events_, [](const EventHistory& history) { return history.new_events() > 0; });
  if (rest && end - last_cut_ >= duration_from_seconds(config_.min_interval_s)) make_packet({end, false});
  for (EventHistory& history : events_) counters_.events_lost += history.give_up();
  while (!waiting_.empty() && (imu_.empty() || waiting_.back().t > imu_.back().t)) {
    ++counters_.packets_after_imu;
    drop_waiting(std::prev(waiting_.end()));
  }
  const Timestamp last = waiting_.empty() ? last_handed_out_.value_or(Timestamp::min()) : waiting_.back().t;
  for (; !external_.empty() && time_of(external_.back()) > last; external_.pop_back())
    ++counters_.external_lost[external_.back().index()];
}

}  // namespace edged
