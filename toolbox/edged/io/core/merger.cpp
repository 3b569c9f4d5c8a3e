// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/core/merger.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <type_traits>

#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr Duration kMaxSilence = std::chrono::seconds(1);     // a stream that is silent for longer is not waited for
constexpr Duration kDisorder = std::chrono::milliseconds(1);  // within one stream
constexpr std::size_t kMostInBatch = 65536;

}  // namespace

template <typename T>
void ArrivalQueue<T>::push(T item) {
  jump_filter_.push(
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
    const std::size_t count = jump_filter_.push_first(items.first(count_in_order(items)));
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
  jump_filter_.finish([this](T passed) { insert(std::move(passed)); });
}

template <typename T>
T ArrivalQueue<T>::pop() {
  T item = std::move(sorted_[first_++]);
  drop_popped();
  handed_out_ = time_of(item);
  return item;
}

/// Once they are half of all, so that each item is moved once on average.
template <typename T>
void ArrivalQueue<T>::drop_popped() {
  if (first_ < (sorted_.size() + 1) / 2) return;
  sorted_.erase(sorted_.begin(), sorted_.begin() + static_cast<std::ptrdiff_t>(first_));
  first_ = 0;
}

template <typename T>
std::vector<T> ArrivalQueue<T>::pop_before(Timestamp end, std::size_t most) {
  const std::span<T> held = std::span(sorted_).subspan(first_), first = held.first(std::min(most, held.size()));
  const auto cut = std::ranges::partition_point(first, [end](const T& item) { return time_of(item) < end; });
  std::vector<T> items(first.begin(), cut);
  first_ += items.size();
  drop_popped();
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
  const auto begin = sorted_.begin() + static_cast<std::ptrdiff_t>(first_);
  const auto place = std::upper_bound(begin, sorted_.end(), t, [](Timestamp a, const T& b) { return a < time_of(b); });
  const bool repeated = t == newest() || (place != begin && time_of(*std::prev(place)) == t);
  if (repeated && !stamps_repeat_) return repair("duplicate stamp");
  repair("out of order, sorted in");
  sorted_.insert(place, std::move(item));
}

Merger::Merger(Repairs& repairs) : repairs_(repairs), imu_("imu", true, 100'000, repairs) {
  for (const ExternalSensor& sensor : external_sensors())
    external_.emplace_back(std::string(sensor.name), false, 100'000, repairs);
  expect({});
}

void Merger::expect(const Streams& streams) {
  const auto set = [this]<typename T>(std::vector<Camera<T>>& cameras, std::vector<std::string> names,
                                      const std::string& kind, std::size_t max_held) {
    const bool expected = !names.empty(), stamps_repeat = std::is_same_v<T, Event>;
    if (!expected) names = {kind};
    cameras.clear();
    for (const std::string& name : names)
      cameras.push_back({name, ArrivalQueue<T>(kind, stamps_repeat, max_held, repairs_), {expected, {}, {}}});
  };
  set(events_, streams.events, "events", 4'000'000);
  set(frames_, streams.frames, "frames", 300);
  imu_arrival_.expected = streams.imu;
}

void Merger::leave_out(Modality unwanted) {
  const auto discard = [](auto& cameras) {
    for (auto& camera : cameras) {
      camera.queue.clear();
      camera.arrival = {};
    }
  };
  if (unwanted == Modality::Events) {
    discard(events_);
  } else {
    discard(frames_);
  }
  // Its clock may have been ahead of the other clocks.
  begin_ = newest_ = imu_arrival_.last_stamp;
  for (const auto& camera : events_) begin_ = newest_ = std::max(newest_, camera.arrival.last_stamp);
  for (const auto& camera : frames_) begin_ = newest_ = std::max(newest_, camera.arrival.last_stamp);
}

void Merger::push(std::span<const Event> events, std::size_t camera) {
  auto& [name, queue, arrival] = events_.at(camera);
  queue.push(events);
  note_arrival(arrival, queue.last());
}

void Merger::push(Frame frame, std::size_t camera) {
  auto& [name, queue, arrival] = frames_.at(camera);
  frame.camera = name;
  queue.push(std::move(frame));
  note_arrival(arrival, queue.last());
}

void Merger::push(const ImuSample& sample) {
  imu_.push(sample);
  note_arrival(imu_arrival_, imu_.last());
}

void Merger::push(const ExternalSample& sample) { external_[sample.index()].push(sample); }

void Merger::note_arrival(Arrival& arrival, std::optional<Timestamp> last) {
  if (!last) return;
  if (!begin_) begin_ = last;
  newest_ = std::max(newest_.value_or(*last), *last);
  arrival = {arrival.expected, last, newest_};
}

void Merger::finish() {
  for (auto& camera : events_) camera.queue.finish();
  for (auto& camera : frames_) camera.queue.finish();
  imu_.finish();
  for (auto& queue : external_) queue.finish();
  finished_ = true;
}

/// No later input is expected to have an earlier stamp.
Timestamp Merger::complete_until() const {
  if (finished_) return Timestamp::max();
  if (!newest_) return Timestamp::min();
  Timestamp complete = Timestamp::max(), overflow = imu_.overflow();
  const auto wait_for = [&](const Arrival& arrival) {
    if (!arrival.expected && !arrival.last_stamp) return;
    const bool silent = *newest_ - arrival.newest_then.value_or(*begin_) > kMaxSilence;
    complete = std::min(complete, silent               ? *newest_ - kMaxSilence
                                  : arrival.last_stamp ? *arrival.last_stamp - kDisorder
                                                       : Timestamp::min());
  };
  const auto wait_for_all = [&](const auto& cameras) {
    for (const auto& camera : cameras) {
      wait_for(camera.arrival);
      overflow = std::max(overflow, camera.queue.overflow());
    }
  };
  wait_for_all(events_);
  wait_for_all(frames_);
  wait_for(imu_arrival_);
  return std::max(complete, overflow);
}

ArrivalQueue<ExternalSample>& Merger::next_external() {
  return *std::ranges::min_element(external_, {}, &ArrivalQueue<ExternalSample>::next_stamp);
}

std::optional<Measurement> Merger::pop() {
  const auto next_of = [](auto& cameras) -> auto& {  // of equal stamps the first camera
    return *std::ranges::min_element(cameras, {}, [](const auto& camera) { return camera.queue.next_stamp(); });
  };
  const Timestamp ready = complete_until();
  Camera<Event>& events = next_of(events_);
  Camera<Frame>& frames = next_of(frames_);
  ArrivalQueue<ExternalSample>& external = next_external();
  const std::array stamps{imu_.next_stamp(), events.queue.next_stamp(), frames.queue.next_stamp(),
                          external.next_stamp()};
  const NextStream next = next_stream(stamps[0], stamps[1], stamps[2], stamps[3]);
  if (std::ranges::min(stamps) >= ready) return std::nullopt;
  switch (next.stream) {
    case NextStream::Stream::External:
      return external.pop();
    case NextStream::Stream::Imu:
      return imu_.pop();
    case NextStream::Stream::Frame:
      return frames.queue.pop();
    case NextStream::Stream::Events:
      return take_events(events, std::min({next.events_end, stamps[1] + kLongestBatch, ready}));
    case NextStream::Stream::None:
      break;
  }
  return std::nullopt;
}

EventBatch Merger::take_events(Camera<Event>& camera, Timestamp end) {
  return {camera.name, camera.queue.pop_before(end, kMostInBatch)};
}

}  // namespace edged
