// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/input/packet_completion.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/imu/preintegration.hpp"
#include "edged/pipeline/tuning.hpp"

namespace edged {
namespace {

std::size_t events_in(const Packet& packet) {
  std::size_t sum = 0;
  for (const PacketEvents& events : packet.events) sum += events.events.size();
  return sum;
}

}  // namespace

void PacketCompletion::add(Packet packet, PacketizerCounters& counters) {
  waiting_events_ += events_in(packet);
  waiting_.push_back(std::move(packet));
  const auto overflow = [&](const std::deque<Packet>::iterator& oldest) {
    ++counters.packets_overflow;
    drop(oldest, counters);
  };
  if (waiting_.size() > kPipelineTuning.max_waiting_packets) overflow(waiting_.begin());
  // Frames tell the motion in a gap of the IMU; event frames need a gyro.
  for (std::size_t i = 0; waiting_events_ > max_events_ && i + 1 < waiting_.size();) {
    if (waiting_[i].frames.empty())
      overflow(waiting_.begin() + static_cast<std::ptrdiff_t>(i));
    else
      drop_events(waiting_[i++], counters);
  }
}

void PacketCompletion::drop_events(Packet& packet, PacketizerCounters& counters) {
  waiting_events_ -= events_in(packet);
  for (PacketEvents& events : packet.events) {
    counters.events_lost += events.new_events;
    events.events.clear();
    events.new_events = events.window_events = 0;
  }
}

void PacketCompletion::drop(const std::deque<Packet>::iterator& packet, PacketizerCounters& counters) {
  drop_events(*packet, counters);
  waiting_.erase(packet);
}

void PacketCompletion::add(const ImuSample& sample, PacketizerCounters& counters) {
  std::ranges::copy(gate_.push(sample), std::back_inserter(imu_));
  counters.imu = gate_.counts();
  constexpr Duration kKept = kPipelineTuning.imu_history;
  if (last_handed_out_ || imu_.empty() || sample.t - imu_.front().t <= 2 * kKept) return;
  imu_.erase(imu_.begin(), std::ranges::lower_bound(imu_, sample.t - kKept, {}, &ImuSample::t));
}

void PacketCompletion::add(const ExternalSample& sample, PacketizerCounters& counters) {
  const Timestamp t = time_of(sample);
  if (last_handed_out_ && t <= *last_handed_out_) {
    ++counters.external_late[sample.index()];
    return;
  }
  const auto after = std::ranges::upper_bound(external_, t, {}, [](const ExternalSample& one) { return time_of(one); });
  external_.insert(after, sample);
  if (external_.size() <= kPipelineTuning.max_waiting_external) return;
  ++counters.external_lost[external_.front().index()];
  external_.pop_front();
}

/// The samples after `from`, up to `to`; older ones are dropped.
std::vector<ExternalSample> PacketCompletion::take_external(Timestamp from, Timestamp to,
                                                            PacketizerCounters& counters) {
  std::vector<ExternalSample> taken;
  for (; !external_.empty() && time_of(external_.front()) <= to; external_.pop_front()) {
    const ExternalSample& sample = external_.front();
    const bool in_time = time_of(sample) > from;
    ++(in_time ? counters.external : counters.external_lost)[sample.index()];
    if (in_time) taken.push_back(sample);
  }
  return taken;
}

std::optional<Packet> PacketCompletion::next(PacketizerCounters& counters) {
  while (!waiting_.empty() && !imu_.empty() && waiting_.front().t <= imu_.back().t) {
    const Timestamp from = last_handed_out_.value_or(imu_.front().t);
    if (waiting_.front().t <= from) {
      ++counters.packets_before_imu;
      drop(waiting_.begin(), counters);
      continue;
    }
    Packet packet = std::move(waiting_.front());
    waiting_.pop_front();
    waiting_events_ -= events_in(packet);
    packet.imu = slice_imu(imu_, from, packet.t);
    packet.external = take_external(from, packet.t, counters);
    last_handed_out_ = packet.t;
    const auto after = std::ranges::upper_bound(imu_, packet.t, {}, &ImuSample::t);
    imu_.erase(imu_.begin(), after - 1);  // the sample at or before t starts the next packet
    ++counters.packets;
    return packet;
  }
  return std::nullopt;
}

void PacketCompletion::finish(PacketizerCounters& counters) {
  std::ranges::copy(gate_.finish(), std::back_inserter(imu_));
  counters.imu = gate_.counts();
  while (!waiting_.empty() && (imu_.empty() || waiting_.back().t > imu_.back().t)) {
    ++counters.packets_after_imu;
    drop(std::prev(waiting_.end()), counters);
  }
  const Timestamp last = waiting_.empty() ? last_handed_out_.value_or(Timestamp::min()) : waiting_.back().t;
  for (; !external_.empty() && time_of(external_.back()) > last; external_.pop_back())
    ++counters.external_lost[external_.back().index()];
}

}  // namespace edged
