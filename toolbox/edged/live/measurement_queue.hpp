// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A bounded queue of measurements between the threads of the sensors and the one that processes them.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

#include "edged/config.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// Bounds of the queue.
struct QueueConfig {
  double max_age_s = 0.25;       ///< longest wait of an event; of a frame twice that
  int max_megabytes = 64;        ///< size of events and frames together
  int max_imu_samples = 200000;  ///< beyond it push blocks, as no IMU sample may be lost

  void visit(ConfigFields& fields);
};

/// The behaviour of a queue at the bounds of QueueConfig.
enum class WhenFull {
  Drop,  ///< the oldest is dropped: late results are worth little
  Wait   ///< the reading thread blocks: no measurement is dropped. Ages do not matter
};

/// Measurements dropped because the odometry was too slow for them.
struct DropCounters {
  std::size_t events = 0, frames = 0;
  std::size_t unread = 0;  ///< of the events: by the reader, which was itself too slow
  bool operator==(const DropCounters&) const = default;
};

/// The maxima of the queue over time, each by itself.
struct QueuePeaks {
  std::size_t events = 0, frames = 0, imu = 0, bytes = 0;
  double age_s = 0.0;  ///< wait of the oldest event or frame
};

/// First in, first out; when the queue is full, push blocks or measurements are dropped, but never those of the IMU.
/// The oldest events are dropped first: there are many, and a late result is worth less than one from fewer events. A
/// frame has more information than the events of its time and costs less, so frames are dropped after all events or at
/// twice their age, the oldest first. Samples of the IMU and of external sensors are small and cannot be replaced: with
/// too many of them push blocks.
///
/// Any threads may push while another pops. A blocked push waits until the queue is half empty: waking a thread for
/// every measurement costs more than reading it.
class MeasurementQueue {
 public:
  using Clock = std::chrono::steady_clock;

  explicit MeasurementQueue(const QueueConfig& config, WhenFull when_full = WhenFull::Drop)
      : config_(config), when_full_(when_full) {}

  /// False, without effect, after close or interrupt. due: when the measurement came, or should have come.
  bool push(Measurement measurement, Clock::time_point due = Clock::now());
  /// The oldest measurement; waits for one, at most so long. Nothing then, or at the end.
  std::optional<Measurement> pop(std::optional<Clock::duration> longest = {});

  /// No more will be pushed; queued measurements can still be popped.
  void close();
  /// Aborts: queued measurements are dropped, and all sides return at once.
  void interrupt();

  /// When the oldest measurement that waits was due.
  std::optional<Clock::time_point> waits_since() const;

  DropCounters dropped() const;
  QueuePeaks peaks() const;

 private:
  template <typename T>
  struct Entry {
    std::uint64_t place;  ///< in the order of all measurements
    Clock::time_point due;
    T measurement;
  };
  template <typename T>
  using Line = std::deque<Entry<T>>;

  std::size_t room() const { return static_cast<std::size_t>(config_.max_megabytes) << 20U; }
  std::size_t bytes() const { return events_ * sizeof(Event) + frame_bytes_; }
  bool full() const;
  bool half_empty() const;
  bool is_older(Clock::time_point due, double age_s) const;
  void add(Measurement measurement, Clock::time_point due);
  void drop_events();
  void drop_frames();
  void update_peaks();
  void end(bool drop_waiting);
  std::optional<Measurement> take();
  template <typename T>
  static Measurement take_first(Line<T>& line);

  const QueueConfig config_;
  const WhenFull when_full_;
  mutable std::mutex mutex_;
  std::condition_variable more_, less_;  ///< to pop; to go on with a blocked push
  Line<EventBatch> batches_;             ///< none empty
  Line<Frame> frames_;
  Line<Measurement> samples_;  ///< from the IMU and external sensors
  std::uint64_t next_place_ = 0;
  std::size_t events_ = 0, frame_bytes_ = 0;
  Clock::time_point newest_ = Clock::time_point::min();  ///< due time
  DropCounters dropped_;
  QueuePeaks peaks_;
  bool closed_ = false;
};

}  // namespace edged
