// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/dense/dense_worker.hpp"

#include <chrono>
#include <utility>

namespace edged {
namespace {

constexpr std::size_t kMostWithout = 16 * DenseWorker::kCapacity;  // instants, most of them without images

}  // namespace

DenseWorker::DenseWorker(const DenseConfig& config, DenseOverload overload, std::function<void(const DepthMap&)> on_map)
    : overload_(overload), on_map_(std::move(on_map)), mapper_(config), thread_([this] { work(); }) {}

DenseWorker::~DenseWorker() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    queue_.clear();
  }
  more_.notify_one();
}

void DenseWorker::add(DenseInstant instant) {
  std::unique_lock lock(mutex_);
  if (overload_ == DenseOverload::Wait) less_.wait(lock, [this] { return queue_.size() < kCapacity || failure_; });
  if (failure_) return;
  instant.restart |= std::exchange(restart_, false);
  if (queue_.size() >= kCapacity) {
    dropped_keyframes_ += instant.keyframe;
    instant.images.clear();  // its poses still refine those of others
    if (queue_.size() >= kMostWithout) {
      restart_ = instant.restart;
      return;
    }
  }
  queue_.push_back(std::move(instant));
  lock.unlock();
  more_.notify_one();
}

void DenseWorker::finish() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  more_.notify_one();
  if (thread_.joinable()) thread_.join();
  if (failure_) std::rethrow_exception(failure_);
}

void DenseWorker::work() {
  using Clock = std::chrono::steady_clock;
  try {
    for (bool more = true; more;) {
      std::unique_lock lock(mutex_);
      more_.wait(lock, [this] { return closed_ || !queue_.empty(); });
      more = !queue_.empty();
      DenseInstant instant;
      if (more) {
        instant = std::move(queue_.front());
        queue_.pop_front();
      }
      lock.unlock();
      less_.notify_one();
      const Clock::time_point begin = Clock::now();
      const double cpu_begin_s = thread_cpu_s();
      if (more)
        mapper_.add(std::move(instant));
      else
        mapper_.finish();
      for (; on_map_ && shown_ < mapper_.maps().size(); ++shown_) on_map_(mapper_.maps()[shown_]);
      timing_.add(std::chrono::duration<double>(Clock::now() - begin).count(), thread_cpu_s() - cpu_begin_s);
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    less_.notify_one();
  }
}

}  // namespace edged
