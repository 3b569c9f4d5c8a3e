// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Drops stamps that are wrong by half a second or more, so that the items after them are not late. For all formats.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/time.hpp"

namespace edged {

/// Items of one stream of a recording, T with a `time_of`, pass through it one by one. A run of items that begins
/// kAhead after all items before is held. It was a gap if it lasts for kSure or is followed by another gap. It is
/// dropped if an earlier stamp follows: its stamps were wrong. The first item of all is held until the second. A
/// recording can wait for what follows, so a whole run of items is held. JumpGate, for live streams, holds one item.
template <typename T>
class StampJumpFilter {
 public:
  static constexpr Duration kAhead = std::chrono::milliseconds(500);
  static constexpr Duration kSure = std::chrono::milliseconds(100);
  static constexpr std::size_t kMostWaiting = 1'000'000;

  /// Calls pass(T) for each accepted item, and drop(T, Timestamp) for each dropped one with the stamp that contradicts
  /// it.
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
    if (near(t)) return let_through(std::move(item), pass);
    begin_ = end_ = t;
    waiting_.push_back(std::move(item));
  }

  /// True if an item of this stamp passes unchanged: then it counts as accepted, and needs no push().
  bool passes(Timestamp t) {
    if (!near(t)) return false;
    if (t > *newest_) newest_ = t;
    return true;
  }

  /// The number of leading items, of many in order, that pass unchanged.
  std::size_t push_first(std::span<const T> items) {
    if (!items.empty() && passes(time_of(items.back()))) return items.size();
    const auto stop = std::ranges::find_if(items, [this](const T& item) { return !passes(time_of(item)); });
    return static_cast<std::size_t>(stop - items.begin());
  }

  /// The end of the stream.
  template <typename Pass>
  void finish(Pass pass) {
    for (T& item : std::exchange(waiting_, {})) let_through(std::move(item), pass);
  }

  /// The newest stamp of the accepted items.
  std::optional<Timestamp> newest() const { return newest_; }

 private:
  bool near(Timestamp t) const { return waiting_.empty() && newest_ && t <= *newest_ + kAhead; }

  /// newest_ is updated after pass() has run.
  template <typename Pass>
  void let_through(T item, Pass& pass) {
    const Timestamp t = time_of(item);
    pass(std::move(item));
    newest_ = std::max(newest_.value_or(t), t);
  }

  std::vector<T> waiting_;
  Timestamp begin_, end_;  ///< first and newest stamp of the held items
  std::optional<Timestamp> newest_;
};

}  // namespace edged
