// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The mapper that only localizes in a loaded map.
#include <gtest/gtest.h>

#include <string>

#include "edged/pipeline/mapping/test_wall.hpp"

namespace edged {
namespace {

class MapperThatOnlyLocalizes : public MapperBeforeAWall {
 protected:
  MapperThatOnlyLocalizes() {
    Mapper before{MapConfig{}, kLostAfter_s};
    before.restart(SE3(), now(0.0, SE3()));
    add_keyframe(before, 5.0, SE3());
    SavedMap saved = *before.save();
    saved.cameras = {{"cam", 240, 180, 200.0}};
    map_ = to_bytes(saved);
    MapConfig config;
    config.localize_only = true;
    mapper_ = Mapper(config, kLostAfter_s);
    mapper_.load(saved_map_from_bytes(map_));
  }
  std::string map_now() const {
    SavedMap saved = *mapper_.save();
    saved.cameras = {{"cam", 240, 180, 200.0}};
    return to_bytes(saved);
  }
  /// At rest at the origin of M.
  void relocalize(double t_s) {
    EXPECT_FALSE(localize(mapper_, t_s, T_O_B_, SE3()));
    EXPECT_FALSE(mapper_.localized());
    EXPECT_TRUE(localize(mapper_, t_s + 0.3, T_O_B_, SE3()));
    EXPECT_TRUE(mapper_.localized());
  }

  const SE3 T_O_B_{so3::exp({0, 0, -0.8}), {1.0, 2.0, 0.3}};
  std::string map_;
  Mapper mapper_{MapConfig{}, kLostAfter_s};
};

TEST_F(MapperThatOnlyLocalizes, NeverChangesTheMap) {
  EXPECT_EQ(map_now(), map_) << "awaiting relocalization";
  mapper_.restart(SE3(), now(0.0, T_O_B_));
  relocalize(0.3);
  const SE3 T_O_M = T_O_B_;
  for (double t = 5.0; t < 8.0; t += 0.5) {
    add_keyframe(mapper_, t, T_O_M);
    const SE3 T_M_B = shift(0.0, 0.1 * (t - 4.5), 0.0), drift = shift(0.01, 0.0, 0.0);
    localize(mapper_, t + 0.25, drift * T_O_M * T_M_B, T_M_B);
    EXPECT_GT(mapper_.map_matches(second(t + 0.25)).size(), 20U);
  }
  EXPECT_EQ(map_now(), map_);
  EXPECT_EQ(mapper_.final_trajectory().keyframes.size(), 1U);
}

TEST_F(MapperThatOnlyLocalizes, ForgetsThePlaceWithoutMatchesButNotAtRest) {
  mapper_.restart(SE3(), now(0.0, T_O_B_));
  relocalize(0.3);
  for (double t = 1.0; t < 20.0; t += 1.0) mapper_.predict(now(t, T_O_B_), Motion::None);
  EXPECT_TRUE(mapper_.localized());
  mapper_.predict(now(23.0, T_O_B_));
  EXPECT_TRUE(mapper_.localized());
  mapper_.predict(now(25.0, T_O_B_));
  EXPECT_FALSE(mapper_.localized());
  EXPECT_NEAR(mapper_.unmatched_s(), 6.0, 1e-9);
  relocalize(25.3);
}

TEST_F(MapperThatOnlyLocalizes, IsRelocalizedNearWhereItWasAfterADoubt) {
  mapper_.restart(SE3(), now(0.0, T_O_B_));
  relocalize(0.3);
  mapper_.reset_uncertainty(now(1.0, T_O_B_));
  EXPECT_FALSE(mapper_.localized());
  EXPECT_TRUE(localize(mapper_, 1.1, T_O_B_, SE3())) << "one image is enough near dead reckoning";
  EXPECT_TRUE(mapper_.localized());
}

TEST_F(MapperThatOnlyLocalizes, KeepsTheMapInANewTime) {
  mapper_.restart(SE3(), now(0.0, T_O_B_));
  relocalize(0.3);
  mapper_.begin_epoch();
  EXPECT_FALSE(mapper_.localized());
  EXPECT_EQ(map_now(), map_);
  mapper_.restart(SE3(), now(0.0, T_O_B_));
  relocalize(0.3);
}

}  // namespace
}  // namespace edged
