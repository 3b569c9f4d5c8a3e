// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The order of measurements and how long they are held back for it.
#include "edged/io/merger.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "edged/io/text.hpp"

namespace edged {
namespace {

constexpr Duration kLongestBatch = std::chrono::milliseconds(5);
constexpr Duration kPatience = std::chrono::seconds(1);       // a stream this far behind the others is not waited for
constexpr Duration kDisorder = std::chrono::milliseconds(1);  // within one stream
constexpr std::size_t kMostInBatch = 65536;

}  // namespace

Turn next_turn(Timestamp imu, Timestamp events, Timestamp frame) {
  using enum Turn::Stream;
  constexpr Timestamp never = Timestamp::max();
  if (imu == never && events == never && frame == never) return {};
  if (imu <= events && imu <= frame) return {Imu};
  if (events > frame) return {Frame};
  // Events at the stamp of a frame come before it, those at the stamp of an IMU sample after it.
  const Timestamp behind_frame = frame == never ? never : frame + Duration(1);
  return {Events, std::min({imu, behind_frame, events + kLongestBatch})};
}

template <typename T>
void ArrivalQueue<T>::push(T item, Timestamp floor) {
  if (suspect_) {
    T suspect = std::move(*suspect_);
    suspect_.reset();
    if (item.t > suspect.t - kJump) {
      insert(std::move(suspect), floor);
    } else {
      repairs_.add(subject_ + ": stamp far ahead, dropped",
                   fmt::format("{}: stamp {} s is followed by {} s", subject_, format_seconds(suspect.t),
                               format_seconds(item.t)));
    }
  }
  if (!last_ || item.t - newest_ > kJump) {
    suspect_ = std::move(item);
  } else {
    insert(std::move(item), floor);
  }
}

template <typename T>
void ArrivalQueue<T>::push(std::span<const T> items, Timestamp floor) {
  while (!items.empty()) {
    const std::size_t count = count_in_order(items, floor);
    if (count > 0) {
      sorted_.insert(sorted_.end(), items.begin(), items.begin() + static_cast<std::ptrdiff_t>(count));
      last_ = newest_ = items[count - 1].t;
    } else {
      push(items.front(), floor);
    }
    items = items.subspan(std::max<std::size_t>(count, 1));
  }
}

/// How many of the first items continue the stream, so that nothing has to be judged.
template <typename T>
std::size_t ArrivalQueue<T>::count_in_order(std::span<const T> items, Timestamp floor) const {
  if (suspect_ || !last_ || !stamps_repeat_) return 0;
  std::size_t count = 0;
  for (Timestamp before = std::max(newest_, floor); count < items.size(); ++count) {
    const Timestamp t = items[count].t;
    if (t < before || t - newest_ > kJump) break;
    before = t;
  }
  return count;
}

template <typename T>
void ArrivalQueue<T>::finish(Timestamp floor) {
  if (suspect_) insert(std::move(*suspect_), floor);
  suspect_.reset();
}

template <typename T>
T ArrivalQueue<T>::pop() {
  T item = std::move(sorted_.front());
  sorted_.pop_front();
  return item;
}

template <typename T>
std::vector<T> ArrivalQueue<T>::pop_before(Timestamp end, std::size_t most) {
  const auto last = sorted_.begin() + static_cast<std::ptrdiff_t>(std::min(most, sorted_.size()));
  const auto cut = std::partition_point(sorted_.begin(), last, [end](const T& item) { return item.t < end; });
  std::vector<T> items(sorted_.begin(), cut);
  sorted_.erase(sorted_.begin(), cut);
  return items;
}

template <typename T>
void ArrivalQueue<T>::insert(T item, Timestamp floor) {
  const Timestamp t = item.t;
  last_ = t;
  const auto repair = [&](const char* kind) {
    repairs_.add(subject_ + ": " + kind, fmt::format("{}: stamp {} s: {}", subject_, format_seconds(t), kind));
  };
  if (t < floor) return repair("out of order, dropped");
  if (t > newest_ || (stamps_repeat_ && t == newest_)) {
    newest_ = t;
    sorted_.push_back(std::move(item));
    return;
  }
  const auto place =
      std::upper_bound(sorted_.begin(), sorted_.end(), t, [](Timestamp a, const T& b) { return a < b.t; });
  const bool repeated = t == newest_ || (place != sorted_.begin() && std::prev(place)->t == t);
  if (repeated && !stamps_repeat_) return repair("duplicate stamp");
  repair("out of order, sorted in");
  sorted_.insert(place, std::move(item));
}

Merger::Merger(Repairs& repairs)
    : events_("events", true, 4'000'000, repairs),
      frames_("frames", false, 300, repairs),
      imu_("imu", false, 100'000, repairs) {}

void Merger::push(std::span<const Event> events) { events_.push(events, floor_); }

void Merger::push(Frame frame) { frames_.push(std::move(frame), floor_); }

void Merger::push(const ImuSample& sample) { imu_.push(sample, floor_); }

void Merger::finish() {
  events_.finish(floor_);
  frames_.finish(floor_);
  imu_.finish(floor_);
  finished_ = true;
}

/// Whatever comes from now on is not expected before this stamp.
Timestamp Merger::horizon() const {
  if (finished_) return Timestamp::max();
  Timestamp oldest = Timestamp::max(), newest = Timestamp::min();
  const auto wait_for = [&](bool expected, std::optional<Timestamp> last) {
    if (expected || last) oldest = std::min(oldest, last.value_or(Timestamp::min()));
    newest = std::max(newest, last.value_or(Timestamp::min()));
  };
  wait_for(expected_.events, events_.last());
  wait_for(expected_.frames, frames_.last());
  wait_for(expected_.imu, imu_.last());
  if (newest == Timestamp::min()) return newest;
  const Timestamp settled = oldest == Timestamp::min() ? oldest : oldest - kDisorder;
  return std::max({settled, newest - kPatience, events_.overflow(), frames_.overflow(), imu_.overflow()});
}

std::optional<Measurement> Merger::pop() {
  const Timestamp ready = horizon();
  const Turn turn = next_turn(imu_.next_stamp(), events_.next_stamp(), frames_.next_stamp());
  if (std::min({imu_.next_stamp(), events_.next_stamp(), frames_.next_stamp()}) >= ready) return std::nullopt;
  switch (turn.stream) {
    case Turn::Stream::Imu:
      floor_ = imu_.next_stamp();
      return imu_.pop();
    case Turn::Stream::Frame:
      floor_ = frames_.next_stamp();
      return frames_.pop();
    case Turn::Stream::Events:
      return take_events(std::min(turn.events_end, ready));
    case Turn::Stream::None:
      break;
  }
  return std::nullopt;
}

EventBatch Merger::take_events(Timestamp end) {
  EventBatch batch{expected_.event_camera, events_.pop_before(end, kMostInBatch)};
  floor_ = batch.events.back().t;
  return batch;
}

}  // namespace edged
