// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A bounded queue of measurements between the thread that reads the sensors and the one that processes them.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "edged/config.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// Bounds of the queue.
struct QueueConfig {
  double max_age_s = 0.25;       ///< of an event, against the newest measurement; of a frame twice that
  int max_megabytes = 64;        ///< of events and frames together
  int max_imu_samples = 200000;  ///< beyond it push blocks, as no IMU sample may be lost

  void visit(ConfigFields& fields);
};

/// The behaviour of a queue at the bounds of QueueConfig.
enum class WhenFull {
  Shed,  ///< the oldest is dropped: late results are worth little
  Wait   ///< the reading thread blocks: no measurement is dropped. Ages do not matter
};

/// Measurements dropped because the queue was full.
struct ShedCounters {
  std::size_t events = 0, frames = 0;
  bool operator==(const ShedCounters&) const = default;
};

/// The maxima of the queue over time, each by itself.
struct QueuePeaks {
  std::size_t events = 0, frames = 0, imu = 0, bytes = 0;
  double age_s = 0.0;  ///< of the oldest event or frame
};

/// First in, first out; when the queue is full, push blocks or the queue sheds, but never the IMU. The oldest events
/// are shed first: there are many, and a late result is worth less than one from fewer events. A frame has more
/// information than the events of its time and costs less, so frames are shed after all events or at twice their age,
/// the oldest first. Samples of the IMU and of external sensors are small and cannot be replaced: with too many of them
/// push blocks.
///
/// One thread may push while another pops. A blocked push waits until the queue is half empty: waking a thread for
/// every measurement costs more than reading it.
class MeasurementQueue {
 public:
  explicit MeasurementQueue(const QueueConfig& config, WhenFull when_full = WhenFull::Shed)
      : config_(config), when_full_(when_full) {}

  /// False, without effect, after close or interrupt.
  bool push(Measurement measurement);
  /// The oldest measurement; waits for one. Nothing at the end.
  std::optional<Measurement> pop();

  /// No more will be pushed; queued measurements can still be popped.
  void close();
  /// Aborts: queued measurements are dropped, and both sides return at once.
  void interrupt();

  /// The stamp of the oldest measurement that waits.
  std::optional<Timestamp> waits_since() const;

  ShedCounters shed() const;
  QueuePeaks peaks() const;

 private:
  /// Measurements of one kind with their positions in the order of all.
  template <typename T>
  using Line = std::deque<std::pair<std::uint64_t, T>>;

  std::size_t room() const { return static_cast<std::size_t>(config_.max_megabytes) << 20U; }
  std::size_t bytes() const { return events_ * sizeof(Event) + frame_bytes_; }
  bool full() const;
  bool half_empty() const;
  void add(Measurement measurement);
  void shed_events();
  void shed_frames();
  void note_peaks();
  std::optional<Measurement> take();
  std::optional<Timestamp> oldest() const;

  const QueueConfig config_;
  const WhenFull when_full_;
  mutable std::mutex mutex_;
  std::condition_variable more_, less_;  ///< to pop; waits, for push to go on
  Line<EventBatch> batches_;             // none empty
  Line<Frame> frames_;
  Line<Measurement> samples_;  // of the IMU and of external sensors
  std::uint64_t next_place_ = 0;
  std::size_t events_ = 0, frame_bytes_ = 0;
  Timestamp newest_ = Timestamp::min();
  ShedCounters shed_;
  QueuePeaks peaks_;
  bool closed_ = false;
};

}  // namespace edged
