// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A recording read by a thread of its own into a bounded queue, so that decoding runs in parallel.
#pragma once

#include <exception>
#include <functional>
#include <optional>
#include <stop_token>
#include <thread>

#include "edged/dataset.hpp"
#include "edged/live/measurement_queue.hpp"
#include "edged/timing.hpp"

namespace edged {

/// The measurements, and their order, are those of the dataset, without those that the queue drops.
class ReadAhead {
 public:
  /// May delay a measurement, in the thread, and drop events of it. Returns when it was due. stopped: whether to give
  /// up.
  using Pace = std::function<MeasurementQueue::Clock::time_point(Measurement&, const std::function<bool()>& stopped)>;

  /// Only the thread may use `dataset` until stop, except info(). Ends at once when `interrupted` returns true.
  ReadAhead(Dataset& dataset, const QueueConfig& config, WhenFull when_full, std::function<bool()> interrupted,
            Pace pace = {});
  ~ReadAhead() { stop(); }

  /// As Dataset::next; rethrows errors of the dataset after all measurements before them.
  std::optional<Measurement> next();

  /// Ends the thread; measurements read ahead are dropped.
  void stop();

  const MeasurementQueue& queue() const { return queue_; }
  /// Durations of Dataset::next per call, and the thread's processor time. After stop.
  const StageTiming& reading() const { return reading_; }

 private:
  void read(const std::stop_token& stop);
  void read_until(const std::function<bool()>& stopped);

  Dataset& dataset_;
  std::function<bool()> interrupted_;
  Pace pace_;
  MeasurementQueue queue_;
  StageTiming reading_;
  std::exception_ptr failure_;  // set before the queue is closed
  std::jthread thread_;         // last member: it uses the others
};

}  // namespace edged
