// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which keyframes may show what an image shows: hash tables of some bits of the descriptors of their points. Without it
// an image is compared with all points of the map.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "edged/map/places/place.hpp"

namespace edged {

/// The index of the views of one camera.
class PlaceIndex {
 public:
  PlaceIndex() : tables_(kTables * kBuckets) {}

  void add(std::size_t keyframe, const Descriptor& descriptor);
  /// Forgets a keyframe of the map. Those after it get a number less.
  void remove(std::size_t keyframe);
  /// By keyframe, of so many: how often a descriptor is in one bucket with one of its own.
  std::vector<std::uint32_t> votes(std::span<const std::optional<Descriptor>> descriptors, std::size_t keyframes) const;

 private:
  /// Two descriptors of one point that differ in 30 bits are in one bucket of at least one table in 87 % of cases.
  static constexpr std::size_t kTables = 8, kBits = 12, kBuckets = std::size_t{1} << kBits;
  /// A bucket with more says too little for its time.
  static constexpr std::size_t kMostInBucket = 2000;
  static std::size_t bucket(std::size_t table, const Descriptor& descriptor);

  std::vector<std::vector<std::uint32_t>> tables_;  ///< keyframes by table and bucket
};

}  // namespace edged
