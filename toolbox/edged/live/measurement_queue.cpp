// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/measurement_queue.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

std::size_t bytes_of(const Frame& frame) { return frame.image.total() * frame.image.elemSize(); }

template <typename Line>
std::uint64_t first_place(const Line& line) {
  return line.empty() ? std::numeric_limits<std::uint64_t>::max() : line.front().place;
}

template <typename Line>
auto first_due(const Line& line) {
  return line.empty() ? MeasurementQueue::Clock::time_point::max() : line.front().due;
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

bool MeasurementQueue::push(Measurement measurement, Clock::time_point due) {
  {
    std::unique_lock lock(mutex_);
    const bool must_stay = when_full_ == WhenFull::Wait || camera_of(measurement) == nullptr;
    if (must_stay && full()) less_.wait(lock, [this] { return closed_ || half_empty(); });
    if (closed_) return false;
    if (!last_stamp(measurement)) return true;  // an empty batch
    newest_ = std::max(newest_, due);
    add(std::move(measurement), due);
    if (when_full_ == WhenFull::Drop) {
      drop_events();
      drop_frames();
    }
    update_peaks();
  }
  more_.notify_one();
  return true;
}

/// Whether a measurement that may not be dropped has to wait.
bool MeasurementQueue::full() const {
  return samples_.size() >= static_cast<std::size_t>(config_.max_imu_samples) ||
         (when_full_ == WhenFull::Wait && bytes() >= room());
}

bool MeasurementQueue::half_empty() const {
  return samples_.size() <= static_cast<std::size_t>(config_.max_imu_samples) / 2 &&
         (when_full_ == WhenFull::Drop || bytes() <= room() / 2);
}

void MeasurementQueue::add(Measurement measurement, Clock::time_point due) {
  const std::uint64_t place = next_place_++;
  if (auto* batch = std::get_if<EventBatch>(&measurement)) {
    events_ += batch->events.size();
    batches_.push_back({place, due, std::move(*batch)});
  } else if (auto* frame = std::get_if<Frame>(&measurement)) {
    frame_bytes_ += bytes_of(*frame);
    frames_.push_back({place, due, std::move(*frame)});
  } else {
    samples_.push_back({place, due, std::move(measurement)});
  }
}

bool MeasurementQueue::is_older(Clock::time_point due, double age_s) const {
  return newest_ - due > duration_from_seconds(age_s);
}

/// The oldest events that have waited too long, or are too many beside the frames.
void MeasurementQueue::drop_events() {
  const std::size_t allowed = (room() - std::min(room(), frame_bytes_)) / sizeof(Event);
  while (!batches_.empty()) {
    std::vector<Event>& events = batches_.front().measurement.events;
    const std::size_t too_many =
        is_older(batches_.front().due, config_.max_age_s) ? events.size() : events_ - std::min(events_, allowed);
    const std::size_t n = std::min(too_many, events.size());
    if (n == 0) return;
    events_ -= n;
    dropped_.events += n;
    events.erase(events.begin(), events.begin() + static_cast<std::ptrdiff_t>(n));
    if (!events.empty()) return;
    batches_.pop_front();
  }
}

void MeasurementQueue::drop_frames() {
  while (!frames_.empty() && (is_older(frames_.front().due, 2.0 * config_.max_age_s) || frame_bytes_ > room())) {
    frame_bytes_ -= bytes_of(frames_.front().measurement);
    ++dropped_.frames;
    frames_.pop_front();
  }
}

void MeasurementQueue::update_peaks() {
  peaks_.events = std::max(peaks_.events, events_);
  peaks_.frames = std::max(peaks_.frames, frames_.size());
  peaks_.imu = std::max(peaks_.imu, samples_.size());
  peaks_.bytes = std::max(peaks_.bytes, bytes());
  const Clock::time_point oldest = std::min(first_due(batches_), first_due(frames_));
  if (oldest < newest_) peaks_.age_s = std::max(peaks_.age_s, to_seconds(newest_ - oldest));
}

std::optional<MeasurementQueue::Clock::time_point> MeasurementQueue::waits_since() const {
  const std::lock_guard lock(mutex_);
  const Clock::time_point oldest = std::min({first_due(batches_), first_due(frames_), first_due(samples_)});
  return oldest == Clock::time_point::max() ? std::nullopt : std::optional(oldest);
}

std::optional<Measurement> MeasurementQueue::pop(std::optional<Clock::duration> longest) {
  std::optional<Measurement> first;
  bool goes_on = false;
  {
    std::unique_lock lock(mutex_);
    const auto ready = [this] { return closed_ || !batches_.empty() || !frames_.empty() || !samples_.empty(); };
    longest ? static_cast<void>(more_.wait_for(lock, *longest, ready)) : more_.wait(lock, ready);
    first = take();
    goes_on = half_empty();
  }
  if (goes_on) less_.notify_one();
  return first;
}

std::optional<Measurement> MeasurementQueue::take() {
  const std::uint64_t batch = first_place(batches_), frame = first_place(frames_), sample = first_place(samples_);
  if (batch < std::min(frame, sample)) {
    events_ -= batches_.front().measurement.events.size();
    return take_first(batches_);
  }
  if (frame < sample) {
    frame_bytes_ -= bytes_of(frames_.front().measurement);
    return take_first(frames_);
  }
  if (samples_.empty()) return std::nullopt;
  return take_first(samples_);
}

template <typename T>
Measurement MeasurementQueue::take_first(Line<T>& line) {
  Measurement first = std::move(line.front().measurement);
  line.pop_front();
  return first;
}

void MeasurementQueue::close() { end(false); }

void MeasurementQueue::interrupt() { end(true); }

void MeasurementQueue::end(bool drop_waiting) {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    if (drop_waiting) {
      batches_.clear();
      frames_.clear();
      samples_.clear();
      events_ = frame_bytes_ = 0;
    }
  }
  more_.notify_all();
  less_.notify_all();
}

DropCounters MeasurementQueue::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

QueuePeaks MeasurementQueue::peaks() const {
  const std::lock_guard lock(mutex_);
  return peaks_;
}

}  // namespace edged
