// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A DenseMapper in a thread of its own, which a bounded queue feeds.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "edged/dense/dense_mapper.hpp"
#include "edged/timing.hpp"

namespace edged {

/// What happens to an instant while the queue is full.
enum class DenseOverload {
  Wait,  ///< add blocks: no image is left out, and the result does not depend on timing
  Drop   ///< its images are left out; add never blocks
};

class DenseWorker {
 public:
  static constexpr std::size_t kCapacity = 64;  // instants with images: two seconds

  /// on_map: gets each depth map when it has been measured, from the thread of the worker; later keyframes may still
  /// change the one that mapper() has. May be empty.
  DenseWorker(const DenseConfig& config, DenseOverload overload, std::function<void(const DepthMap&)> on_map = {});
  ~DenseWorker();

  /// In order of time, from one thread, before finish.
  void add(DenseInstant instant);
  /// Waits until all is done; rethrows what ended the thread.
  void finish();

  // After finish:
  const DenseMapper& mapper() const { return mapper_; }
  const StageTiming& timing() const { return timing_; }
  std::size_t dropped_keyframes() const { return dropped_keyframes_; }

 private:
  void work();

  const DenseOverload overload_;
  const std::function<void(const DepthMap&)> on_map_;
  std::size_t shown_ = 0;  // maps, of the thread
  DenseMapper mapper_;
  StageTiming timing_;
  std::mutex mutex_;
  std::condition_variable more_, less_;
  std::deque<DenseInstant> queue_;
  bool closed_ = false, restart_ = false;
  std::size_t dropped_keyframes_ = 0;
  std::exception_ptr failure_;  // set by the thread; read after its end
  std::jthread thread_;         // last member: it uses the others
};

}  // namespace edged
