// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/event_thinner.hpp"

#include <algorithm>

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
  const std::size_t left_out = events.size() - kept;
  events.resize(kept);
  return left_out;
}

}  // namespace edged
