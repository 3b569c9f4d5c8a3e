// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A DenseMapper in a thread of its own, which a bounded queue feeds.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
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

  DenseWorker(const DenseConfig& config, DenseOverload overload);
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
