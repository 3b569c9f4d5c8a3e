// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/sequencer.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/measurement_stamps.hpp"
#include "edged/core/stream_order.hpp"

namespace edged {
namespace {

constexpr Duration kNextTick(1);
constexpr std::size_t kMostImu = 1'000'000;

std::size_t bytes_of(const EventBatch& batch) { return batch.events.size() * sizeof(Event); }
std::size_t bytes_of(const Frame& frame) { return frame.image.total() * frame.image.elemSize(); }
std::size_t bytes_of(const ImuSample&) { return 0; }  // bounded by their number: no IMU sample makes way for an image

}  // namespace

void SensorDelays::validate() const {
  for (const auto& [name, delay] : {std::pair("events_s", events_s), {"frames_s", frames_s}, {"imu_s", imu_s}}) {
    if (!(delay >= 0.0 && delay <= 10.0))
      throw InputError::format("delay {} is {}, outside its range 0 .. 10 s", name, delay);
  }
}

Sequencer::Sequencer(Mode mode, const SensorDelays& delays, std::size_t most_bytes)
    : most_bytes_(most_bytes),
      events_{uses(mode, Modality::Events), duration_from_seconds(delays.events_s)},
      frames_{uses(mode, Modality::Frames), duration_from_seconds(delays.frames_s)},
      imu_{true, duration_from_seconds(delays.imu_s)} {}

bool Sequencer::add(Measurement measurement) {
  if (finished_) return false;
  const std::optional<Timestamp> last = last_stamp(measurement);
  if (!last) return true;
  const bool taken = std::visit(
      [&](auto& item) {
        using Item = std::decay_t<decltype(item)>;
        if constexpr (std::is_same_v<Item, EventBatch>) return push(events_, std::move(item), *last);
        if constexpr (std::is_same_v<Item, Frame>) return push(frames_, std::move(item), *last);
        if constexpr (std::is_same_v<Item, ImuSample>) return push(imu_, std::move(item), *last);
      },
      measurement);
  if (taken) newest_ = std::max(newest_.value_or(*last), *last);
  return taken;
}

template <typename T>
bool Sequencer::push(Line<T>& line, T item, Timestamp last) {
  const std::size_t bytes = bytes_of(item);
  if (bytes == 0 ? line.waiting.size() >= kMostImu : bytes_ + bytes > most_bytes_) return false;
  bytes_ += bytes;
  line.newest = std::max(line.newest.value_or(last), last);
  line.waiting.push_back(std::move(item));
  return true;
}

/// Of what the line may still give: of the first that waits, else of the first that can still come.
template <typename T>
Timestamp Sequencer::earliest(const Line<T>& line) const {
  if (!line.waiting.empty()) return first_stamp_of(line.waiting.front());
  if (!line.expected || finished_ || bytes_ > most_bytes_ / 2) return Timestamp::max();
  const Timestamp not_too_late = *newest_ - line.delay + kNextTick;
  if (!line.newest) return not_too_late;
  const Duration step = std::is_same_v<T, EventBatch> ? Duration(0) : kNextTick;  // two batches may share a stamp
  return std::max(*line.newest + step, not_too_late);
}

std::optional<Measurement> Sequencer::next() {
  if (!newest_) return std::nullopt;
  const NextStream next = next_stream(earliest(imu_), earliest(events_), earliest(frames_));
  switch (next.stream) {
    case NextStream::Stream::Imu:
      return pop(imu_);
    case NextStream::Stream::Frame:
      return pop(frames_);
    case NextStream::Stream::Events:
      return pop_events(next.events_end);
    case NextStream::Stream::None:
      break;
  }
  return std::nullopt;
}

template <typename T>
std::optional<Measurement> Sequencer::pop(Line<T>& line) {
  if (line.waiting.empty()) return std::nullopt;  // it may still come
  T item = std::move(line.waiting.front());
  line.waiting.pop_front();
  bytes_ -= bytes_of(item);
  return item;
}

std::optional<Measurement> Sequencer::pop_events(Timestamp end) {
  if (events_.waiting.empty()) return std::nullopt;
  EventBatch& batch = events_.waiting.front();
  if (events_out_ == 0 && batch.events.back().t < end) return pop(events_);
  const auto begin = batch.events.begin() + static_cast<std::ptrdiff_t>(events_out_);
  const auto cut = std::partition_point(begin, batch.events.end(), [end](const Event& event) { return event.t < end; });
  EventBatch part{batch.camera, {begin, cut}};
  events_out_ += part.events.size();
  if (cut == batch.events.end()) {
    bytes_ -= bytes_of(batch);
    events_.waiting.pop_front();
    events_out_ = 0;
  }
  return part;
}

}  // namespace edged
