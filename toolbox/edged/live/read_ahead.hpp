// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A recording read by a thread of its own into a bounded queue, so that decoding goes on while others work.
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

/// The measurements, and their order, are those of the dataset, but for what a queue that sheds leaves out.
class ReadAhead {
 public:
  /// May hold back what has been read, in the thread; the function says whether to give up.
  using Pace = std::function<void(const Measurement&, const std::function<bool()>& stopped)>;

  /// `dataset` is the thread's until stop, but for info(). The end comes at once when `interrupted` says so.
  ReadAhead(Dataset& dataset, const QueueConfig& config, WhenFull when_full, std::function<bool()> interrupted,
            Pace pace = {});
  ~ReadAhead() { stop(); }

  /// As Dataset::next; throws what the dataset threw, after all that came before.
  std::optional<Measurement> next();

  /// Ends the thread; what has been read and not handed out is forgotten.
  void stop();

  const MeasurementQueue& queue() const { return queue_; }
  /// Of Dataset::next, call by call, and the thread's processor time. After stop.
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
  std::jthread thread_;         // last: it uses the others
};

}  // namespace edged
