// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/places/place_index.hpp"

namespace edged {

/// Table 0 takes the lowest bits of the first half of the first word, and so on.
std::size_t PlaceIndex::bucket(std::size_t table, const Descriptor& descriptor) {
  const std::uint64_t bits = descriptor[table / 2] >> (32 * (table % 2));
  return table * kBuckets + (bits & (kBuckets - 1));
}

void PlaceIndex::add(std::size_t keyframe, const Descriptor& descriptor) {
  for (std::size_t table = 0; table < kTables; ++table)
    tables_[bucket(table, descriptor)].push_back(static_cast<std::uint32_t>(keyframe));
}

void PlaceIndex::remove(std::size_t keyframe) {
  for (std::vector<std::uint32_t>& keyframes : tables_) {
    std::erase(keyframes, keyframe);
    for (std::uint32_t& other : keyframes) other -= other > keyframe ? 1 : 0;
  }
}

std::vector<std::uint32_t> PlaceIndex::votes(std::span<const std::optional<Descriptor>> descriptors,
                                             std::size_t keyframes) const {
  std::vector<std::uint32_t> votes(keyframes, 0);
  for (const std::optional<Descriptor>& descriptor : descriptors) {
    if (!descriptor) continue;
    for (std::size_t table = 0; table < kTables; ++table) {
      const std::vector<std::uint32_t>& found = tables_[bucket(table, *descriptor)];
      if (found.size() > kMostInBucket) continue;
      for (const std::uint32_t keyframe : found) ++votes[keyframe];
    }
  }
  return votes;
}

}  // namespace edged
