// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/depth/latest_window.hpp"

#include <utility>

namespace edged {

LatestWindowThread::LatestWindowThread(Measure measure)
    : measure_(std::move(measure)), thread_([this](const std::stop_token& stop) { work(stop); }) {}

void LatestWindowThread::put(std::vector<Event> window) {
  {
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(window);
  }
  changed_.notify_all();
}

std::vector<DepthEstimate> LatestWindowThread::take() {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::exchange(measured_, {});
}

void LatestWindowThread::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !waiting_ && !busy_; });
}

void LatestWindowThread::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return waiting_.has_value(); }) && !stop.stop_requested()) {
    const std::vector<Event> window = *std::exchange(waiting_, std::nullopt);
    busy_ = true;
    lock.unlock();
    std::optional<DepthEstimate> estimate;
    std::exception_ptr failure;
    try {
      estimate = measure_(window);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    busy_ = false;
    if (estimate) measured_.push_back(*estimate);
    if (failure) failure_ = failure;
    changed_.notify_all();
  }
}

}  // namespace edged
