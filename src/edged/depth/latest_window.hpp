// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A thread that works on the newest window of events only: for live use, where a late result is worse than none.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include "edged/depth/depth_prior.hpp"

namespace edged {

/// Runs `measure` on windows in a thread of its own. put and take never wait for it.
class LatestWindowThread {
 public:
  using Measure = std::function<std::optional<DepthEstimate>(const std::vector<Event>&)>;

  explicit LatestWindowThread(Measure measure);

  /// A window that has not been started when the next one arrives is skipped.
  void put(std::vector<Event> window);

  /// The measurements since the last call, in the order of the windows. Throws what `measure` threw.
  std::vector<DepthEstimate> take();

  /// Waits until all windows have been measured or skipped.
  void finish();

 private:
  void work(const std::stop_token& stop);

  Measure measure_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<std::vector<Event>> waiting_;
  bool busy_ = false;
  std::vector<DepthEstimate> measured_;
  std::exception_ptr failure_;
  std::jthread thread_;  // last member: it ends before the members that it uses
};

}  // namespace edged
