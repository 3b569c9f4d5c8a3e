// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/input/sequencer.hpp"

#include <algorithm>
#include <tuple>
#include <type_traits>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/core/measurements/stream_order.hpp"

namespace edged {
namespace {

constexpr Duration kNextTick(1);

std::size_t bytes_of(const EventBatch& batch) { return batch.events.size() * sizeof(Event); }
std::size_t bytes_of(const Frame& frame) { return frame.image.total() * frame.image.elemSize(); }
// Samples are bounded by their number: none is dropped for an image.
std::size_t bytes_of(const ImuSample&) { return 0; }
std::size_t bytes_of(const ExternalSample&) { return 0; }

template <typename Queues>
auto& queue_of(Queues& queues, const std::string& camera) {
  const auto found = std::ranges::find_if(queues, [&](const auto& queue) { return queue.camera == camera; });
  EDGED_CHECK(found != queues.end(), "a measurement of camera '{}', which is not used", camera);
  return *found;
}

}  // namespace

void SensorDelays::validate() const {
  for (const auto& [name, delay] :
       {std::pair("events_s", events_s), {"frames_s", frames_s}, {"imu_s", imu_s}, {"external_s", external_s}}) {
    if (!(delay >= 0.0 && delay <= 10.0))
      throw InputError::format("delay {} is {}, outside its range 0 .. 10 s", name, delay);
  }
}

Sequencer::Sequencer(const Rig& cameras, const SensorDelays& delays, std::size_t max_bytes)
    : max_bytes_(max_bytes), imu_{"", {}} {
  Duration least(0);  // maximum of t_imu - t_cam: the clock that is farthest ahead
  for (const RigCamera& camera : cameras.cameras) least = std::min(least, camera.time_offset);
  // The lag of a clock behind that adds to the lag of its sensor.
  const auto delay = [&](double seconds, Duration offset) {
    return delays == kInOrder ? Duration(0) : duration_from_seconds(seconds) + offset - least;
  };
  for (const RigCamera& camera : cameras.cameras) {
    if (camera.modality == Modality::Events) {
      events_.push_back({camera.name, delay(delays.events_s, camera.time_offset)});
    } else {
      frames_.push_back({camera.name, delay(delays.frames_s, camera.time_offset)});
    }
  }
  imu_.delay = delay(delays.imu_s, Duration(0));
  for (const ExternalSensor& sensor : external_sensors())
    external_.push_back({std::string(sensor.name), delay(delays.external_s, Duration(0))});
}

bool Sequencer::add(Measurement measurement) {
  if (finished_) return false;
  const std::optional<Timestamp> last = last_stamp(measurement);
  if (!last) return true;
  const bool external = std::holds_alternative<ExternalSample>(measurement);
  const bool taken = std::visit(
      [&](auto& item) {
        using Item = std::decay_t<decltype(item)>;
        if constexpr (std::is_same_v<Item, ImuSample>) {
          return push(imu_, std::move(item), *last);
        } else if constexpr (std::is_same_v<Item, ExternalSample>) {
          auto& queue = external_[item.index()];
          return push(queue, std::move(item), *last);
        } else {
          auto& queues = std::get<std::vector<Queue<Item>>&>(std::tie(events_, frames_));
          auto& queue = queue_of(queues, item.camera);
          return push(queue, std::move(item), *last);
        }
      },
      measurement);
  // An external sensor with another clock must not make all others late.
  if (taken && !external) newest_ = std::max(newest_.value_or(*last), *last);
  return taken;
}

std::size_t Sequencer::waiting() const {
  std::size_t sum = imu_.waiting.size();
  for (const Queue<ExternalSample>& queue : external_) sum += queue.waiting.size();
  for (const Queue<EventBatch>& queue : events_) sum += queue.waiting.size();
  for (const Queue<Frame>& queue : frames_) sum += queue.waiting.size();
  return sum;
}

template <typename T>
bool Sequencer::push(Queue<T>& queue, T item, Timestamp last) {
  const std::size_t bytes = bytes_of(item);
  if (bytes == 0 ? queue.waiting.size() >= kPipelineTuning.max_queued_samples : bytes_ + bytes > max_bytes_)
    return false;
  bytes_ += bytes;
  queue.newest = std::max(queue.newest.value_or(last), last);
  queue.waiting.push_back(std::move(item));
  return true;
}

/// The lower bound of the queue's next stamp: that of its first queued measurement, else of the earliest that can still
/// arrive.
template <typename T>
Timestamp Sequencer::earliest(const Queue<T>& queue) const {
  if (!queue.waiting.empty()) {
    if constexpr (std::is_same_v<T, EventBatch>) {
      return queue.waiting.front().events[queue.events_out].t;
    } else {
      return time_of(queue.waiting.front());
    }
  }
  if (finished_ || bytes_ > max_bytes_ / 2) return Timestamp::max();
  if (std::is_same_v<T, ExternalSample> && !queue.newest) return Timestamp::max();  // such a sensor may be missing
  const Timestamp not_too_late = *newest_ - queue.delay + kNextTick;
  if (!queue.newest) return not_too_late;
  const Duration step = std::is_same_v<T, EventBatch> ? Duration(0) : kNextTick;  // two batches may share a stamp
  return std::max(*queue.newest + step, not_too_late);
}

/// The queue with the earliest stamp; ties in the order of the cameras. Null without any.
template <typename T>
Sequencer::Queue<T>* Sequencer::first_of(std::vector<Queue<T>>& queues) {
  const auto first = std::ranges::min_element(queues, {}, [this](const Queue<T>& queue) { return earliest(queue); });
  return first == queues.end() ? nullptr : &*first;
}

std::optional<Measurement> Sequencer::next() {
  if (!newest_) return std::nullopt;
  Queue<EventBatch>* const events = first_of(events_);
  Queue<Frame>* const frames = first_of(frames_);
  Queue<ExternalSample>* const external = first_of(external_);
  const NextStream next = next_stream(earliest(imu_), events ? earliest(*events) : Timestamp::max(),
                                      frames ? earliest(*frames) : Timestamp::max(), earliest(*external));
  switch (next.stream) {
    case NextStream::Stream::External:
      return pop(*external);
    case NextStream::Stream::Imu:
      return pop(imu_);
    case NextStream::Stream::Frame:
      return pop(*frames);
    case NextStream::Stream::Events:
      return pop_events(*events, next.events_end);
    case NextStream::Stream::None:
      break;
  }
  return std::nullopt;
}

template <typename T>
std::optional<Measurement> Sequencer::pop(Queue<T>& queue) {
  if (queue.waiting.empty()) return std::nullopt;  // it may still arrive
  T item = std::move(queue.waiting.front());
  queue.waiting.pop_front();
  bytes_ -= bytes_of(item);
  return item;
}

std::optional<Measurement> Sequencer::pop_events(Queue<EventBatch>& queue, Timestamp end) {
  if (queue.waiting.empty()) return std::nullopt;
  EventBatch& batch = queue.waiting.front();
  if (queue.events_out == 0 && batch.events.back().t < end) return pop(queue);
  const auto begin = batch.events.begin() + static_cast<std::ptrdiff_t>(queue.events_out);
  const auto cut = std::partition_point(begin, batch.events.end(), [end](const Event& event) { return event.t < end; });
  EventBatch part{batch.camera, {begin, cut}};
  queue.events_out += part.events.size();
  if (cut == batch.events.end()) {
    bytes_ -= bytes_of(batch);
    queue.waiting.pop_front();
    queue.events_out = 0;
  }
  return part;
}

}  // namespace edged
