// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Keeps a bounded number of items, evenly spaced over all added ones.
#pragma once

#include <cstddef>
#include <vector>

namespace edged {

/// Removes each second item. The first one is kept.
template <typename T>
void keep_every_second(std::vector<T>& values) {
  for (std::size_t i = 0; 2 * i < values.size(); ++i) values[i] = values[2 * i];
  values.resize((values.size() + 1) / 2);
}

template <typename T>
class Evenly {
 public:
  explicit Evenly(std::size_t most) : most_(most) {}

  /// True if this call removed half of the kept items.
  bool add(const T& value) {
    if (seen_++ % stride_ != 0) return false;
    kept_.push_back(value);
    if (kept_.size() < most_) return false;
    keep_every_second(kept_);
    stride_ *= 2;
    return true;
  }

  const std::vector<T>& all() const { return kept_; }

 private:
  std::size_t most_, seen_ = 0, stride_ = 1;
  std::vector<T> kept_;
};

}  // namespace edged
