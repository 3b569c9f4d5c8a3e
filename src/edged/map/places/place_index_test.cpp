// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/places/place_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace edged {
namespace {

constexpr std::size_t kKeyframesOfIndex = 400, kPointsOfIndex = 40;
constexpr int kAlikeBits = 64;

Descriptor with_noise(Descriptor descriptor, int bits, std::mt19937_64& random) {
  for (int i = 0; i < bits; ++i) descriptor[random() % 4] ^= std::uint64_t{1} << (random() % 64);
  return descriptor;
}

/// Keyframes of random points, of which each shares a third with the one before, and their index.
struct Street {
  std::vector<std::vector<Descriptor>> keyframes;
  PlaceIndex index;

  explicit Street(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    for (std::size_t k = 0; k < kKeyframesOfIndex; ++k) {
      std::vector<Descriptor>& points = keyframes.emplace_back();
      for (std::size_t i = 0; i < kPointsOfIndex; ++i) {
        const bool shared = k > 0 && i < kPointsOfIndex / 3;
        points.push_back(shared ? with_noise(keyframes[k - 1][kPointsOfIndex - 1 - i], 20, random)
                                : Descriptor{random(), random(), random(), random()});
        index.add(k, points.back());
      }
    }
  }

  /// Half of its points with so many wrong bits, as many of nowhere, and one that has none.
  std::vector<std::optional<Descriptor>> image_of(std::size_t keyframe, int bits, std::mt19937_64& random) const {
    std::vector<std::optional<Descriptor>> image = {std::nullopt};
    for (std::size_t i = 0; i < kPointsOfIndex; i += 2) {
      image.emplace_back(with_noise(keyframes[keyframe][i], bits, random));
      image.emplace_back(Descriptor{random(), random(), random(), random()});
    }
    return image;
  }

  /// By comparison with all points: the keyframe that has most that are alike.
  std::size_t match_descriptors(const std::vector<std::optional<Descriptor>>& image) const {
    std::vector<std::ptrdiff_t> alike;
    for (const std::vector<Descriptor>& points : keyframes) {
      alike.push_back(std::ranges::count_if(image, [&](const std::optional<Descriptor>& d) {
        return d && std::ranges::any_of(points, [&](const Descriptor& p) { return distance(*d, p) < kAlikeBits; });
      }));
    }
    return static_cast<std::size_t>(std::ranges::max_element(alike) - alike.begin());
  }
  std::size_t most_votes(const std::vector<std::optional<Descriptor>>& image) const {
    const std::vector<std::uint32_t> votes = index.votes(image, keyframes.size());
    return static_cast<std::size_t>(std::ranges::max_element(votes) - votes.begin());
  }
};

TEST(PlaceIndex, FindsTheKeyframeThatComparisonWithAllFinds) {
  const Street street(1);
  std::mt19937_64 random(2);
  for (std::size_t keyframe = 3; keyframe < kKeyframesOfIndex; keyframe += 19) {
    for (const int bits : {15, 30}) {
      const auto image = street.image_of(keyframe, bits, random);
      EXPECT_EQ(street.match_descriptors(image), keyframe);
      EXPECT_EQ(street.most_votes(image), keyframe) << bits;
    }
  }
}

TEST(PlaceIndex, ForgetsAKeyframe) {
  Street street(1);
  std::mt19937_64 random(2);
  const auto gone = street.image_of(100, 15, random), stays = street.image_of(200, 15, random);
  street.index.remove(100);
  street.keyframes.erase(street.keyframes.begin() + 100);
  EXPECT_EQ(street.most_votes(stays), 199U);
  EXPECT_LT(std::ranges::max(street.index.votes(gone, street.keyframes.size())),
            std::ranges::max(street.index.votes(stays, street.keyframes.size())) / 2);
}

TEST(PlaceIndex, PassesOverBitsThatAreEverywhere) {
  PlaceIndex index;
  constexpr std::uint64_t kBothHalves = 0x100000001;
  const Descriptor common{kBothHalves, 2 * kBothHalves, 3 * kBothHalves, 4 * kBothHalves},
      rare{5 * kBothHalves, 6 * kBothHalves, 7 * kBothHalves, 8 * kBothHalves};
  for (std::size_t i = 0; i < 2500; ++i) index.add(i % 5, common);
  index.add(5, rare);
  const auto votes = index.votes(std::vector<std::optional<Descriptor>>{common, rare}, 6);
  EXPECT_EQ(votes, (std::vector<std::uint32_t>{0, 0, 0, 0, 0, 8}));
}

}  // namespace
}  // namespace edged
