// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Keeps stamps that are wrong by half a second or more from making all that follows them late, alike in all formats.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "edged/core/measurement_stamps.hpp"
#include "edged/time.hpp"

namespace edged {

/// Items of one stream of a recording, T with a `time_of`, go through it one by one. A run of items that begins kAhead
/// after all before waits: once it lasts for kSure, or goes on even farther, it was a gap. When an item from before it
/// comes, its stamps were wrong, and it is dropped. The first item of all waits for the second.
template <typename T>
class AheadGate {
 public:
  static constexpr Duration kAhead = std::chrono::milliseconds(500);
  static constexpr Duration kSure = std::chrono::milliseconds(100);
  static constexpr std::size_t kMostWaiting = 1'000'000;

  /// pass(T) is given what goes on, drop(T, Timestamp) what is dropped and the stamp that contradicts it.
  template <typename Pass, typename Drop>
  void push(T item, Pass pass, Drop drop) {
    const Timestamp t = time_of(item);
    if (!waiting_.empty() && t < begin_ - kSure) {
      for (T& wrong : std::exchange(waiting_, {})) drop(std::move(wrong), t);
    } else if (!waiting_.empty() && t <= end_ + kAhead) {
      end_ = std::max(end_, t);
      waiting_.push_back(std::move(item));
      if (!newest_ || end_ - begin_ >= kSure || waiting_.size() >= kMostWaiting) finish(pass);
      return;
    } else {
      finish(pass);
    }
    if (goes_on(t)) return pass(std::move(item));
    begin_ = end_ = t;
    waiting_.push_back(std::move(item));
  }

  /// Whether an item of this stamp passes at once; it counts as passed then.
  bool goes_on(Timestamp t) {
    if (!waiting_.empty() || !newest_ || t > *newest_ + kAhead) return false;
    newest_ = std::max(*newest_, t);
    return true;
  }

  /// Many at once: how many of the first go on as they are.
  std::size_t push_first(std::span<const T> items) {
    const auto stop = std::ranges::find_if(items, [this](const T& item) { return !goes_on(time_of(item)); });
    return static_cast<std::size_t>(stop - items.begin());
  }

  /// Nothing more will come.
  template <typename Pass>
  void finish(Pass pass) {
    for (T& item : std::exchange(waiting_, {})) {
      newest_ = std::max(newest_.value_or(time_of(item)), time_of(item));
      pass(std::move(item));
    }
  }

  /// Of what went on.
  std::optional<Timestamp> newest() const { return newest_; }

 private:
  std::vector<T> waiting_;
  Timestamp begin_, end_;  ///< of what waits
  std::optional<Timestamp> newest_;
};

}  // namespace edged
