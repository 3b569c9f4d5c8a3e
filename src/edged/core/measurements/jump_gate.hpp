// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Rejects a damaged stamp in the future, so that the measurements after it do not count as late.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/time.hpp"

namespace edged {

/// Items of one stream, T with a `time_of`, within 146 years of zero, go through it one by one. One far
/// ahead of all before is held until another confirms it; it is dropped when the next contradicts it. It holds one
/// item, because live streams cannot wait. StampJumpFilter, for recordings, holds a run of items and finds jumps of
/// half a second.
template <typename T>
class JumpGate {
 public:
  static constexpr Duration kJump = std::chrono::seconds(10);

  /// first_waits: the first item also needs a confirmation.
  explicit JumpGate(bool first_waits) : first_waits_(first_waits) {}

  /// Calls pass(T) for each accepted item, and drop(T, Timestamp) for each dropped one with the stamp that contradicts
  /// it.
  template <typename Pass, typename Drop>
  void push(T item, Pass pass, Drop drop) {
    if (waiting_) {
      T before = *std::exchange(waiting_, std::nullopt);
      if (time_of(item) > time_of(before) - kJump) {
        let_through(std::move(before), pass);
      } else {
        drop(std::move(before), time_of(item));
      }
    }
    if (is_far_ahead(time_of(item))) {
      waiting_ = std::move(item);
    } else {
      let_through(std::move(item), pass);
    }
  }

  /// True if items up to this stamp pass unchanged: then they count as accepted, and need no push().
  bool passes(Timestamp t) {
    if (waiting_ || !newest_ || is_far_ahead(t)) return false;
    newest_ = std::max(*newest_, t);
    return true;
  }

  /// Another stream, on the same clock as far as it is known, has reached t: items that are held near t are confirmed,
  /// and later items near t are not far ahead.
  template <typename Pass>
  void confirm(Timestamp t, Pass pass) {
    newest_of_others_ = std::max(newest_of_others_, t);
    if (waiting_ && std::chrono::abs(time_of(*waiting_) - t) <= kJump) finish(pass);
  }

  /// The end of the stream.
  template <typename Pass>
  void finish(Pass pass) {
    if (waiting_) let_through(*std::exchange(waiting_, std::nullopt), pass);
  }

  bool waits() const { return waiting_.has_value(); }
  /// The newest stamp of the accepted items.
  std::optional<Timestamp> newest() const { return newest_; }

 private:
  bool is_far_ahead(Timestamp t) const {
    return newest_ ? t - std::max(*newest_, newest_of_others_) > kJump : first_waits_;
  }
  template <typename Pass>
  void let_through(T item, Pass& pass) {
    const Timestamp t = time_of(item);
    pass(std::move(item));
    newest_ = std::max(newest_.value_or(t), t);
  }

  bool first_waits_;
  std::optional<T> waiting_;
  std::optional<Timestamp> newest_;
  Timestamp newest_of_others_ = Timestamp::min();
};

}  // namespace edged
