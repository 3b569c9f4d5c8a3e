// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/measurement_queue.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

std::size_t bytes_of(const Frame& frame) { return frame.image.total() * frame.image.elemSize(); }

template <typename Line>
std::uint64_t place_of_first(const Line& line) {
  return line.empty() ? std::numeric_limits<std::uint64_t>::max() : line.front().first;
}

template <typename Line>
Measurement take_first(Line& line) {
  Measurement first = std::move(line.front().second);
  line.pop_front();
  return first;
}

}  // namespace

void QueueConfig::visit(ConfigFields& fields) {
  fields.add(
      "max_age_s", max_age_s,
      {"s", 0.001, 3600,
       "--live: events that wait longer are dropped, oldest first; frames at twice that. From 8 % of it on events "
       "are thinned, evenly over the image."});
  fields.add("max_megabytes", max_megabytes,
             {"MB", 1, 65536, "--live: size of waiting events and frames; beyond it the oldest events are dropped"});
  fields.add("max_imu_samples", max_imu_samples,
             {"", 1000, 1e9, "--live: number of waiting IMU samples; none is dropped, beyond it reading pauses"});
}

bool MeasurementQueue::push(Measurement measurement) {
  const std::optional<Timestamp> stamp = last_stamp(measurement);
  {
    std::unique_lock lock(mutex_);
    const bool must_stay = when_full_ == WhenFull::Wait || camera_of(measurement) == nullptr;
    if (must_stay && full()) less_.wait(lock, [this] { return closed_ || half_empty(); });
    if (closed_) return false;
    if (!stamp) return true;  // an empty batch
    newest_ = std::max(newest_, *stamp);
    add(std::move(measurement));
    if (when_full_ == WhenFull::Shed) {
      shed_events();
      shed_frames();
    }
    note_peaks();
  }
  more_.notify_one();
  return true;
}

/// Of measurements that are not shed.
bool MeasurementQueue::full() const {
  return samples_.size() >= static_cast<std::size_t>(config_.max_imu_samples) ||
         (when_full_ == WhenFull::Wait && bytes() >= room());
}

bool MeasurementQueue::half_empty() const {
  return samples_.size() <= static_cast<std::size_t>(config_.max_imu_samples) / 2 &&
         (when_full_ == WhenFull::Shed || bytes() <= room() / 2);
}

void MeasurementQueue::add(Measurement measurement) {
  const std::uint64_t place = next_place_++;
  if (auto* batch = std::get_if<EventBatch>(&measurement)) {
    events_ += batch->events.size();
    batches_.emplace_back(place, std::move(*batch));
  } else if (auto* frame = std::get_if<Frame>(&measurement)) {
    frame_bytes_ += bytes_of(*frame);
    frames_.emplace_back(place, std::move(*frame));
  } else {
    samples_.emplace_back(place, std::move(measurement));
  }
}

/// The oldest events that are too old, or too many beside the frames.
void MeasurementQueue::shed_events() {
  const std::size_t allowed = (room() - std::min(room(), frame_bytes_)) / sizeof(Event);
  const Timestamp oldest_allowed = newest_ - duration_from_seconds(config_.max_age_s);
  while (!batches_.empty()) {
    std::vector<Event>& events = batches_.front().second.events;
    const auto young = std::lower_bound(events.begin(), events.end(), oldest_allowed,
                                        [](const Event& event, Timestamp t) { return event.t < t; });
    const auto too_many = static_cast<std::ptrdiff_t>(std::min(events_ - std::min(events_, allowed), events.size()));
    const std::ptrdiff_t n = std::max(young - events.begin(), too_many);
    if (n == 0) return;
    events_ -= static_cast<std::size_t>(n);
    shed_.events += static_cast<std::size_t>(n);
    events.erase(events.begin(), events.begin() + n);
    if (!events.empty()) return;
    batches_.pop_front();
  }
}

void MeasurementQueue::shed_frames() {
  const Timestamp oldest_allowed = newest_ - 2 * duration_from_seconds(config_.max_age_s);
  while (!frames_.empty() && (frames_.front().second.t < oldest_allowed || frame_bytes_ > room())) {
    frame_bytes_ -= bytes_of(frames_.front().second);
    ++shed_.frames;
    frames_.pop_front();
  }
}

void MeasurementQueue::note_peaks() {
  peaks_.events = std::max(peaks_.events, events_);
  peaks_.frames = std::max(peaks_.frames, frames_.size());
  peaks_.imu = std::max(peaks_.imu, samples_.size());
  peaks_.bytes = std::max(peaks_.bytes, bytes());
  if (const auto t = oldest()) peaks_.age_s = std::max(peaks_.age_s, to_seconds(newest_ - *t));
}

std::optional<Timestamp> MeasurementQueue::oldest() const {
  if (batches_.empty() && frames_.empty()) return std::nullopt;
  const Timestamp event = batches_.empty() ? Timestamp::max() : batches_.front().second.events.front().t;
  return frames_.empty() ? event : std::min(event, frames_.front().second.t);
}

std::optional<Timestamp> MeasurementQueue::waits_since() const {
  const std::lock_guard lock(mutex_);
  std::optional<Timestamp> t = oldest();
  if (!samples_.empty()) t = std::min(t.value_or(Timestamp::max()), *first_stamp(samples_.front().second));
  return t;
}

std::optional<Measurement> MeasurementQueue::pop() {
  std::optional<Measurement> first;
  bool goes_on = false;
  {
    std::unique_lock lock(mutex_);
    more_.wait(lock, [this] { return closed_ || !batches_.empty() || !frames_.empty() || !samples_.empty(); });
    first = take();
    goes_on = half_empty();
  }
  if (goes_on) less_.notify_one();
  return first;
}

std::optional<Measurement> MeasurementQueue::take() {
  const std::uint64_t batch = place_of_first(batches_), frame = place_of_first(frames_),
                      sample = place_of_first(samples_);
  if (batch < std::min(frame, sample)) {
    events_ -= batches_.front().second.events.size();
    return take_first(batches_);
  }
  if (frame < sample) {
    frame_bytes_ -= bytes_of(frames_.front().second);
    return take_first(frames_);
  }
  if (samples_.empty()) return std::nullopt;
  return take_first(samples_);
}

void MeasurementQueue::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  more_.notify_all();
  less_.notify_all();
}

void MeasurementQueue::interrupt() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    batches_.clear();
    frames_.clear();
    samples_.clear();
    events_ = frame_bytes_ = 0;
  }
  more_.notify_all();
  less_.notify_all();
}

ShedCounters MeasurementQueue::shed() const {
  const std::lock_guard lock(mutex_);
  return shed_;
}

QueuePeaks MeasurementQueue::peaks() const {
  const std::lock_guard lock(mutex_);
  return peaks_;
}

}  // namespace edged
