// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A bounded sample of a stream of items, evenly spaced over all of them.
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
class EvenSample {
 public:
  explicit EvenSample(std::size_t most) : most_(most) {}

  void add(const T& value) {
    if (seen_++ % stride_ != 0) return;
    kept_.push_back(value);
    if (kept_.size() < most_) return;
    keep_every_second(kept_);
    stride_ *= 2;
    ++halvings_;
  }

  const std::vector<T>& all() const { return kept_; }
  /// How often each second item has been removed: a reader that has copied some must do the same with its copies.
  std::size_t halvings() const { return halvings_; }

 private:
  std::size_t most_, seen_ = 0, stride_ = 1, halvings_ = 0;
  std::vector<T> kept_;
};

}  // namespace edged
