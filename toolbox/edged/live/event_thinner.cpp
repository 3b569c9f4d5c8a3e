// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/event_thinner.hpp"

#include <algorithm>
#include <cmath>

namespace edged {
namespace {

constexpr unsigned kBlockBits = 3;
// Of sensors up to 1280 x 800 each block has a sum of its own. In larger ones some share one, which is still even.
constexpr std::size_t kColumns = 160, kSums = 1U << 15U;
constexpr std::uint32_t kWhole = 1U << 16U;

std::size_t place(const Event& event) {
  const std::size_t column = event.x >> kBlockBits, row = event.y >> kBlockBits;
  return (2 * (row * kColumns + column) + static_cast<std::size_t>(event.positive)) % kSums;
}

}  // namespace

/// Blocks begin with different sums: else all would keep an event at the same time.
EventThinner::EventThinner() : sums_(kSums) {
  constexpr std::uint32_t kGolden = 40503;  // of kWhole: multiples of it are spread evenly
  for (std::size_t i = 0; i < kSums; ++i) sums_[i] = static_cast<std::uint16_t>(i * kGolden);
}

std::size_t EventThinner::thin(std::vector<Event>& events, double share) {
  const auto step = static_cast<std::uint32_t>(std::clamp(share, 0.0, 1.0) * kWhole);
  if (step == kWhole) return 0;
  std::size_t kept = 0;
  for (const Event& event : events) {
    std::uint16_t& sum = sums_[place(event)];
    const std::uint32_t next = sum + step;
    sum = static_cast<std::uint16_t>(next);
    events[kept] = event;
    kept += next / kWhole;
  }
  const std::size_t dropped = events.size() - kept;
  events.resize(kept);
  return dropped;
}

double OverloadShare::next(double delay, double passed_s, double least) {
  constexpr double kRemembered_s = 0.1;  // in which a delay of 2 lowers the lasting share by its e-fold
  constexpr double kWorst = 3.0;         // a longer delay does not change it faster
  lasting_ *= std::exp(passed_s / kRemembered_s * (1.0 - std::min(delay, kWorst)));
  lasting_ = std::clamp(lasting_, least, 1.0);
  return std::max(least, lasting_ / std::max(delay, 1.0));
}

OverloadThinner::OverloadThinner(double max_age_s) : free_delay_s_(free_delay_s(max_age_s)) {}

void OverloadThinner::thin(EventBatch& batch, double delay_s, double read) {
  if (batch.events.empty()) return;
  const double passed_s = to_seconds(batch.events.back().t - batch.events.front().t);
  const double least = std::min(1.0, OverloadShare::kLeastKept / read);
  const std::lock_guard lock(mutex_);
  dropped_ += thinners_[batch.camera].thin(batch.events, share_.next(delay_s / free_delay_s_, passed_s, least));
}

std::size_t OverloadThinner::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

}  // namespace edged
