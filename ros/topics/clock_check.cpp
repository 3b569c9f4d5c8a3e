// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "topics/clock_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace edged::node {
namespace {

constexpr double kLeast_s = 5.0;       // of both clocks: transport lags by some 0.1 s
constexpr double kMostError = 0.2;     // of the ratio of two speeds
constexpr double kLongestGap_s = 1.0;  // after which the comparison begins anew

}  // namespace

std::optional<std::string> ClockCheck::note(const std::string& topic, Timestamp stamp) {
  const std::lock_guard lock(mutex_);
  if (topic == reference_) {
    newest_ = stamp;
    return std::nullopt;
  }
  if (!newest_) return std::nullopt;
  const Pair begin{stamp, *newest_, stamp, *newest_};
  Pair& pair = topics_.try_emplace(topic, begin).first->second;
  const auto restarts = [](Timestamp last, Timestamp now) {
    return now < last || to_seconds(now - last) > kLongestGap_s;
  };
  if (restarts(pair.own_last, stamp) || restarts(pair.reference_last, *newest_)) {
    const bool said = pair.said;
    pair = begin;
    pair.said = said;
  }
  const bool moved = *newest_ != pair.reference_last;  // else the reference may have stopped
  pair.own_last = stamp;
  pair.reference_last = *newest_;
  const double own_s = to_seconds(stamp - pair.own_first), reference_s = to_seconds(*newest_ - pair.reference_first);
  if (pair.said || !moved || std::min(own_s, reference_s) < kLeast_s) return std::nullopt;
  const double speed = own_s / reference_s;
  if (std::abs(speed - 1.0) < kMostError) return std::nullopt;
  pair.said = true;
  return fmt::format(
      "{}: its stamps run {:.2f} times as fast as those of {}: one of the two drivers is wrong (libcaer_driver before "
      "1.5.4 doubles those of IMU and frames)",
      topic, speed, reference_);
}

std::size_t ClockCheck::wrong() const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::size_t>(std::ranges::count_if(topics_, [](const auto& topic) { return topic.second.said; }));
}

}  // namespace edged::node
