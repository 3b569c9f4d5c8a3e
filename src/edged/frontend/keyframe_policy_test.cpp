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

TEST(KeyframePolicy, TakesTheFirstInstant) { EXPECT_EQ(keyframe_reason({}, {}), KeyframeReason::First); }

TEST(KeyframePolicy, NamesTheRuleThatHolds) {
  const KeyframeConfig config;
  EXPECT_EQ(keyframe_reason(since(80, 0.5, 3, 0.2), config), KeyframeReason::None);
  EXPECT_EQ(keyframe_reason(since(59, 0.5, 3, 0.2), config), KeyframeReason::FewTracks);
  EXPECT_EQ(keyframe_reason(since(80, 1.6, 3, 0.2), config), KeyframeReason::Parallax);
  EXPECT_EQ(keyframe_reason(since(80, 0.0, 11, 0.2), config), KeyframeReason::Rotation);
  EXPECT_EQ(keyframe_reason(since(80, 0.5, 3, 0.6), config), KeyframeReason::Time);
}

TEST(KeyframePolicy, KeepsKeyframesApartInTime) {
  EXPECT_EQ(keyframe_reason(since(0, 9.0, 90, 0.04), {}), KeyframeReason::None);
}

TEST(KeyframePolicy, MakesNoKeyframesAtStandstill) {
  EXPECT_EQ(keyframe_reason(since(100, 0.05, 0.1, 60.0), {}), KeyframeReason::None);
}

TEST(KeyframePolicy, AsksForAKeyframeWhenNoTrackIsLeft) {
  EXPECT_EQ(keyframe_reason(since(0, 0, 0, 0.1), {}), KeyframeReason::FewTracks);
}

}  // namespace
}  // namespace edged
