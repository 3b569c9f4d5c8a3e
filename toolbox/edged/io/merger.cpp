// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Sorts measurements, and limits how long they are held.
#include "edged/io/merger.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

#include "edged/io/text_parsing.hpp"

namespace edged {
namespace {

constexpr Duration kPatience = std::chrono::seconds(1);       // a stream that is silent for longer is not waited for
constexpr Duration kDisorder = std::chrono::milliseconds(1);  // within one stream
constexpr std::size_t kMostInBatch = 65536;

}  // namespace

template <typename T>
void ArrivalQueue<T>::push(T item) {
  gate_.push(
      std::move(item), [this](T passed) { insert(std::move(passed)); },
      [this](const T& dropped, Timestamp next) {
        repairs_.add(subject_ + ": stamp far ahead, dropped",
                     fmt::format("{}: stamp {} s is followed by {} s", subject_, format_seconds(time_of(dropped)),
                                 format_seconds(next)));
      });
}

template <typename T>
void ArrivalQueue<T>::push(std::span<const T> items) {
  while (!items.empty()) {
    const std::size_t count = gate_.push_first(items.first(count_in_order(items)));
    if (count > 0) {
      sorted_.insert(sorted_.end(), items.begin(), items.begin() + static_cast<std::ptrdiff_t>(count));
      last_ = time_of(items[count - 1]);
    } else {
      push(items.front());
    }
    items = items.subspan(std::max<std::size_t>(count, 1));
  }
}

/// The number of leading items that are in order, also relative to the newest item before.
template <typename T>
std::size_t ArrivalQueue<T>::count_in_order(std::span<const T> items) const {
  if (!stamps_repeat_) return 0;
  std::size_t count = 0;
  for (Timestamp before = std::max(newest(), handed_out_); count < items.size(); ++count) {
    if (time_of(items[count]) < before) break;
    before = time_of(items[count]);
  }
  return count;
}

template <typename T>
void ArrivalQueue<T>::finish() {
  gate_.finish([this](T passed) { insert(std::move(passed)); });
}

template <typename T>
T ArrivalQueue<T>::pop() {
  T item = std::move(sorted_.front());
  sorted_.pop_front();
  handed_out_ = time_of(item);
  return item;
}

template <typename T>
std::vector<T> ArrivalQueue<T>::pop_before(Timestamp end, std::size_t most) {
  const auto last = sorted_.begin() + static_cast<std::ptrdiff_t>(std::min(most, sorted_.size()));
  const auto cut = std::partition_point(sorted_.begin(), last, [end](const T& item) { return time_of(item) < end; });
  std::vector<T> items(sorted_.begin(), cut);
  sorted_.erase(sorted_.begin(), cut);
  if (!items.empty()) handed_out_ = time_of(items.back());
  return items;
}

template <typename T>
void ArrivalQueue<T>::insert(T item) {
  const Timestamp t = time_of(item);
  last_ = t;
  const auto repair = [&](const char* kind) {
    repairs_.add(subject_ + ": " + kind, fmt::format("{}: stamp {} s: {}", subject_, format_seconds(t), kind));
  };
  if (t < handed_out_) return repair("out of order, dropped");
  if (t > newest() || (stamps_repeat_ && t == newest())) {
    sorted_.push_back(std::move(item));
    return;
  }
  const auto place =
      std::upper_bound(sorted_.begin(), sorted_.end(), t, [](Timestamp a, const T& b) { return a < time_of(b); });
  const bool repeated = t == newest() || (place != sorted_.begin() && time_of(*std::prev(place)) == t);
  if (repeated && !stamps_repeat_) return repair("duplicate stamp");
  repair("out of order, sorted in");
  sorted_.insert(place, std::move(item));
}

Merger::Merger(Repairs& repairs)
    : events_("events", true, 4'000'000, repairs),
      frames_("frames", false, 300, repairs),
      imu_("imu", false, 100'000, repairs) {
  for (const ExternalSensor& sensor : external_sensors())
    external_.emplace_back(std::string(sensor.name), false, 100'000, repairs);
}

void Merger::expect(const Streams& streams) {
  event_camera_ = streams.event_camera;
  event_pace_.expected = streams.events;
  frame_pace_.expected = streams.frames;
  imu_pace_.expected = streams.imu;
}

void Merger::leave_out(Modality unwanted) {
  if (unwanted == Modality::Events) {
    events_.clear();
    event_pace_ = {};
  } else {
    frames_.clear();
    frame_pace_ = {};
  }
  // Its clock may have been ahead of the other clocks.
  begin_ = newest_ = std::max({event_pace_.last, frame_pace_.last, imu_pace_.last});
}

void Merger::push(std::span<const Event> events) {
  events_.push(events);
  note(event_pace_, events_.last());
}

void Merger::push(Frame frame) {
  frames_.push(std::move(frame));
  note(frame_pace_, frames_.last());
}

void Merger::push(const ImuSample& sample) {
  imu_.push(sample);
  note(imu_pace_, imu_.last());
}

void Merger::push(const ExternalSample& sample) { external_[sample.index()].push(sample); }

void Merger::note(Pace& pace, std::optional<Timestamp> last) {
  if (!last) return;
  if (!begin_) begin_ = last;
  newest_ = std::max(newest_.value_or(*last), *last);
  pace = {pace.expected, last, newest_};
}

void Merger::finish() {
  events_.finish();
  frames_.finish();
  imu_.finish();
  for (auto& queue : external_) queue.finish();
  finished_ = true;
}

/// No later input is expected to have an earlier stamp.
Timestamp Merger::horizon() const {
  if (finished_) return Timestamp::max();
  if (!newest_) return Timestamp::min();
  Timestamp settled = Timestamp::max();
  for (const Pace* pace : {&event_pace_, &frame_pace_, &imu_pace_}) {
    if (!pace->expected && !pace->last) continue;
    const bool silent = *newest_ - pace->heard.value_or(*begin_) > kPatience;
    settled = std::min(settled, silent       ? *newest_ - kPatience
                                : pace->last ? *pace->last - kDisorder
                                             : Timestamp::min());
  }
  return std::max({settled, events_.overflow(), frames_.overflow(), imu_.overflow()});
}

ArrivalQueue<ExternalSample>& Merger::next_external() {
  return *std::ranges::min_element(external_, {}, &ArrivalQueue<ExternalSample>::next_stamp);
}

std::optional<Measurement> Merger::pop() {
  const Timestamp ready = horizon();
  ArrivalQueue<ExternalSample>& external = next_external();
  const std::array stamps{imu_.next_stamp(), events_.next_stamp(), frames_.next_stamp(), external.next_stamp()};
  const NextStream next = next_stream(stamps[0], stamps[1], stamps[2], stamps[3]);
  if (std::ranges::min(stamps) >= ready) return std::nullopt;
  switch (next.stream) {
    case NextStream::Stream::External:
      return external.pop();
    case NextStream::Stream::Imu:
      return imu_.pop();
    case NextStream::Stream::Frame:
      return frames_.pop();
    case NextStream::Stream::Events:
      return take_events(std::min({next.events_end, events_.next_stamp() + kLongestBatch, ready}));
    case NextStream::Stream::None:
      break;
  }
  return std::nullopt;
}

EventBatch Merger::take_events(Timestamp end) { return {event_camera_, events_.pop_before(end, kMostInBatch)}; }

}  // namespace edged
