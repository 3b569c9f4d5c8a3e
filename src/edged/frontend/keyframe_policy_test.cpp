// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/keyframe_policy.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace edged {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

SinceKeyframe since(int alive, double parallax_deg, double rotation_deg, double seconds) {
  SinceKeyframe s;
  s.any = true;
  s.time = duration_from_seconds(seconds);
  s.rotation_rad = rotation_deg * kDegree;
  s.tracks = {100, std::vector<double>(static_cast<std::size_t>(alive), parallax_deg * kDegree)};
  return s;
}

TEST(KeyframePolicy, MakesAKeyframeOfTheFirstInstantAndByEachRule) {
  EXPECT_TRUE(keyframe_due({}, {}));
  EXPECT_FALSE(keyframe_due(since(80, 0.5, 3, 0.2), {}));
  EXPECT_TRUE(keyframe_due(since(59, 0.5, 3, 0.2), {})) << "few tracks";
  EXPECT_TRUE(keyframe_due(since(80, 1.6, 3, 0.2), {})) << "parallax";
  EXPECT_TRUE(keyframe_due(since(80, 0.0, 11, 0.2), {})) << "rotation";
  EXPECT_TRUE(keyframe_due(since(80, 0.5, 3, 0.6), {})) << "time";
  EXPECT_TRUE(keyframe_due(since(0, 0, 0, 0.1), {})) << "no track is left";
}

TEST(KeyframePolicy, KeepsKeyframesApartInTimeAndMakesNoneAtStandstill) {
  EXPECT_FALSE(keyframe_due(since(0, 9.0, 90, 0.04), {}));
  EXPECT_FALSE(keyframe_due(since(100, 0.05, 0.1, 60.0), {}));
}

}  // namespace
}  // namespace edged
