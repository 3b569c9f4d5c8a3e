// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Finds sensors whose stamps do not run at the speed of the others'.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "edged/time.hpp"

namespace edged::node {

/// Drivers exist whose IMU samples and frames had stamps that ran at twice the speed of the events' (libcaer_driver
/// before 1.5.4). From any thread.
class ClockCheck {
 public:
  /// reference: the topic that the others are compared with.
  explicit ClockCheck(std::string reference) : reference_(std::move(reference)) {}

  /// Newest stamp of a topic. Returns what is wrong with it, once.
  std::optional<std::string> note(const std::string& topic, Timestamp stamp);
  /// Topics with a wrong speed so far.
  std::size_t wrong() const;

 private:
  struct Pair {
    Timestamp own_first, reference_first;
    Timestamp own_last, reference_last;
    bool said = false;
  };
  const std::string reference_;
  mutable std::mutex mutex_;
  std::optional<Timestamp> newest_;  ///< stamp of the reference
  std::map<std::string, Pair> topics_;
};

}  // namespace edged::node
