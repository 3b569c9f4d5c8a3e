// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// For tests: a camera at rest in flickering light, with far more events than can be processed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <thread>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/dataset.hpp"

namespace edged {

/// Generated on the fly, one millisecond per batch; IMU samples at 1 kHz, at rest; a frame every 40 ms.
class EventStorm : public Dataset {
 public:
  EventStorm(std::string event_camera, std::string frame_camera, cv::Size size, double events_per_s, int duration_ms)
      : event_camera_(std::move(event_camera)),
        frame_camera_(std::move(frame_camera)),
        size_(size),
        batch_(static_cast<std::size_t>(1e-3 * events_per_s)),
        duration_ms_(duration_ms) {
    info_.name = "storm";
    info_.has_events = info_.has_frames = info_.has_imu = true;
    info_.event_sensor = size;
  }

  const DatasetInfo& info() const override { return info_; }

  /// IMU, events and, if due, a frame of every millisecond.
  std::optional<Measurement> next() override {
    const Timestamp begin = Timestamp() + std::chrono::milliseconds(ms_);
    if (ms_ > duration_ms_) return std::nullopt;
    const int turn = turn_++;
    if (turn == 0) return ImuSample{begin, {0, 0, 0}, {0, 0, 9.81}};
    if (turn == 1) return batch(begin);
    turn_ = 0;
    ++ms_;
    if (ms_ % 40 != 1) return next();
    return Frame{begin + std::chrono::microseconds(999), frame_camera_, cv::Mat(size_, CV_8UC1, cv::Scalar(ms_ % 255))};
  }

  /// Events, frames and IMU samples given out up to the end.
  std::size_t events() const { return batch_ * static_cast<std::size_t>(duration_ms_ + 1); }
  std::size_t frames() const { return static_cast<std::size_t>(duration_ms_ / 40 + 1); }
  std::size_t imu_samples() const { return static_cast<std::size_t>(duration_ms_ + 1); }

 private:
  EventBatch batch(Timestamp begin) {
    EventBatch result{event_camera_, std::vector<Event>(batch_)};
    for (std::size_t i = 0; i < batch_; ++i) {
      Event& event = result.events[i];
      event.t = begin + std::chrono::microseconds(998 * i / batch_);
      random_ = random_ * 6364136223846793005U + 1442695040888963407U;
      event.x = static_cast<std::uint16_t>((random_ >> 33U) % static_cast<std::uint64_t>(size_.width));
      event.y = static_cast<std::uint16_t>((random_ >> 48U) % static_cast<std::uint64_t>(size_.height));
      event.positive = ms_ / 5 % 2 == 0;  // 100 Hz flicker
    }
    return result;
  }

  DatasetInfo info_;
  std::string event_camera_, frame_camera_;
  cv::Size size_;
  std::size_t batch_;
  int duration_ms_;
  int ms_ = 0, turn_ = 0;
  std::uint64_t random_ = 1;
};

/// A storm that takes that many milliseconds to read a batch of events.
class SlowStorm : public Dataset {
 public:
  SlowStorm(EventStorm storm, int batch_ms) : storm_(std::move(storm)), batch_time_(batch_ms) {}
  const DatasetInfo& info() const override { return storm_.info(); }
  std::optional<Measurement> next() override {
    std::optional<Measurement> measurement = storm_.next();
    const auto* batch = measurement ? std::get_if<EventBatch>(&*measurement) : nullptr;
    if (!batch) return measurement;
    if ((sum_ += skip_share_) >= 1.0) {
      sum_ -= 1.0;
      skipped_ += batch->events.size();
      return next();
    }
    std::this_thread::sleep_for(batch_time_);
    return measurement;
  }
  std::size_t skip_events(double share) override {
    skip_share_ = share;
    return skipped_;
  }

 private:
  EventStorm storm_;
  std::chrono::milliseconds batch_time_;
  double skip_share_ = 0.0, sum_ = 0.0;
  std::size_t skipped_ = 0;
};

/// A storm whose recording ends in an error.
class BrokenStorm : public Dataset {
 public:
  BrokenStorm(EventStorm storm, std::string error) : storm_(std::move(storm)), error_(std::move(error)) {}
  const DatasetInfo& info() const override { return storm_.info(); }
  std::optional<Measurement> next() override {
    if (auto measurement = storm_.next()) return measurement;
    throw InputError(error_);
  }

 private:
  EventStorm storm_;
  std::string error_;
};

}  // namespace edged
