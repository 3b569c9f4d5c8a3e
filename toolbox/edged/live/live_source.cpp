// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/live_source.hpp"

#include <spdlog/spdlog.h>

#include <utility>

#include "edged/core/measurement_stamps.hpp"

namespace edged {

LiveSource::LiveSource(Dataset& dataset, const QueueConfig& config, std::function<bool()> interrupted)
    : dataset_(dataset),
      interrupted_(std::move(interrupted)),
      queue_(config),
      thread_([this](const std::stop_token& stop) { play(stop); }) {}

void LiveSource::play(const std::stop_token& stop) {
  const auto stopped = [&] { return stop.stop_requested() || interrupted_(); };
  try {
    while (!stopped()) {
      std::optional<Measurement> measurement = dataset_.next();
      if (!measurement) break;
      if (const auto t = last_stamp(*measurement)) clock_.wait_for(*t, stopped);
      if (!queue_.push(std::move(*measurement))) return;
    }
  } catch (...) {
    failure_ = std::current_exception();
  }
  if (interrupted_()) return queue_.interrupt();
  queue_.close();
}

std::optional<Measurement> LiveSource::next() {
  std::optional<Measurement> measurement = queue_.pop();
  if (const auto line = report_.update(queue_.shed(), ShedReport::Clock::now())) spdlog::warn("{}", *line);
  if (!measurement && failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return measurement;
}

void LiveSource::stop() {
  thread_.request_stop();
  queue_.interrupt();
  if (thread_.joinable()) thread_.join();
}

}  // namespace edged
