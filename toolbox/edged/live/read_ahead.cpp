// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/read_ahead.hpp"

#include <utility>

namespace edged {

ReadAhead::ReadAhead(Dataset& dataset, const QueueConfig& config, WhenFull when_full, std::function<bool()> interrupted,
                     Pace pace)
    : dataset_(dataset),
      interrupted_(std::move(interrupted)),
      pace_(std::move(pace)),
      queue_(config, when_full),
      thread_([this](const std::stop_token& stop) { read(stop); }) {}

void ReadAhead::read(const std::stop_token& stop) {
  try {
    read_until([&] { return stop.stop_requested() || interrupted_(); });
  } catch (...) {
    failure_ = std::current_exception();
  }
  reading_.add_cpu(thread_cpu_s());
  if (interrupted_()) return queue_.interrupt();
  queue_.close();
}

void ReadAhead::read_until(const std::function<bool()>& stopped) {
  using Clock = MeasurementQueue::Clock;
  while (!stopped()) {
    const Clock::time_point begin = Clock::now();
    std::optional<Measurement> measurement = dataset_.next();
    reading_.add(std::chrono::duration<double>(Clock::now() - begin).count());
    if (!measurement) return;
    const Clock::time_point due = pace_ ? pace_(*measurement, stopped) : Clock::now();
    if (!queue_.push(std::move(*measurement), due)) return;
  }
}

std::optional<Measurement> ReadAhead::next() {
  std::optional<Measurement> measurement = queue_.pop();
  if (!measurement && failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return measurement;
}

void ReadAhead::stop() {
  thread_.request_stop();
  queue_.interrupt();
  if (thread_.joinable()) thread_.join();
}

}  // namespace edged
