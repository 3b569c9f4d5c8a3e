// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The mapper in front of a wall, with odometry that is off by a known shift.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "edged/pipeline/mapping/test_wall.hpp"

namespace edged {
namespace {

TEST_F(MapperBeforeAWall, CorrectsTheDriftByWhatWasSeenBefore) {
  Mapper mapper{MapConfig{}, kLostAfter_s};
  EXPECT_FALSE(mapper.started());
  mapper.restart(SE3(), now(0.0, SE3()));
  EXPECT_TRUE(mapper.started());
  add_keyframe(mapper, 5.0, SE3());
  const SE3 T_M_B = shift(0.05, 0.02, 0.0), T_O_B = shift(0.05, 0.03, 0.0);
  EXPECT_FALSE(localize(mapper, 12.0, T_O_B, T_M_B)) << "there was no loss";
  EXPECT_GT(mapper.map_matches(second(12.0)).size(), 20U);
  EXPECT_TRUE(mapper.map_matches(second(11.0)).empty());
  const SE3 corrected = mapper.odom_to_map().T_M_O() * T_O_B;
  const Eigen::Vector3d wall_B(2.0, 0.0, 0.0);  // in front of it translation and rotation are hard to separate
  EXPECT_LT((corrected * wall_B - T_M_B * wall_B).norm(), 0.006) << "it was off by 0.01";
}

TEST_F(MapperBeforeAWall, MatchesAViewOnce) {
  Mapper mapper{MapConfig{}, kLostAfter_s};
  mapper.restart(SE3(), now(0.0, SE3()));
  add_keyframe(mapper, 5.0, SE3());
  const SE3 drift = shift(0.0, 0.01, 0.0);
  localize(mapper, 12.0, drift, SE3());
  const SE3 once = mapper.odom_to_map().T_M_O();
  EXPECT_GT(once.translation().norm(), 0.0);
  const SE3 nearly = shift(0.0, 0.02, 0.0), beside = shift(0.0, 0.06, 0.0);  // 2 and 6 px
  for (int i = 1; i < 20; ++i) localize(mapper, 12.0 + i, drift * nearly, nearly);
  EXPECT_EQ(mapper.odom_to_map().T_M_O().translation(), once.translation()) << "its errors would be the same";
  EXPECT_LT(mapper.unmatched_s(), 1e-9);
  localize(mapper, 32.0, drift * beside, beside);
  EXPECT_GT(mapper.map_matches(second(32.0)).size(), 20U);
}

TEST_F(MapperBeforeAWall, IsAsSureOfThePlaceAfterARest) {
  const auto corrected = [this](Motion motion) {
    Mapper mapper{MapConfig{}, kLostAfter_s};
    mapper.restart(SE3(), now(0.0, SE3()));
    add_keyframe(mapper, 5.0, SE3());
    for (int i = 0; i < 100; ++i) mapper.predict(now(6.0 + i, SE3()), motion);
    localize(mapper, 106.0, SE3(), shift(0.0, 0.01, 0.0));
    return mapper.odom_to_map().T_M_O().translation().norm();
  };
  EXPECT_LT(corrected(Motion::None), 0.3 * corrected(Motion::Any)) << "odometry does not drift at rest";
}

TEST_F(MapperBeforeAWall, KeepsNoKeyframeSoonAfterAStart) {
  Mapper mapper{MapConfig{}, kLostAfter_s};
  mapper.restart(SE3(), now(0.0, SE3()));
  add_keyframe(mapper, 1.0, SE3());
  EXPECT_TRUE(mapper.save()->keyframes.empty()) << "its scale is poor";
  add_keyframe(mapper, 5.0, SE3());
  const std::optional<SavedMap> saved = mapper.save();
  ASSERT_EQ(saved->keyframes.size(), 1U);
  const MapPoint& point = saved->keyframes.front().views.front().points.front();
  EXPECT_EQ(point.inverse_depth, 0.5);
  EXPECT_EQ(point.point, scene_.camera().pixel_to_point(point.pixel));
}

TEST_F(MapperBeforeAWall, RelocalizesAfterALoss) {
  Mapper mapper{MapConfig{}, kLostAfter_s};
  mapper.restart(SE3(), now(0.0, SE3()));
  add_keyframe(mapper, 5.0, SE3());
  mapper.add_pose(now(6.0, SE3()));
  const SE3 T_new_old(so3::exp({0, 0, 0.5}), {3, 2, 1}), off = shift(0.0, 0.02, 0.01);
  mapper.restart(T_new_old, now(10.0, T_new_old * off));
  EXPECT_TRUE(localize(mapper, 10.1, T_new_old * off, SE3()));
  const SE3 T_M_B = mapper.odom_to_map().T_M_O() * T_new_old * off;
  EXPECT_LT(T_M_B.translation().norm(), 0.01) << "dead reckoning was off by 0.022";
  EXPECT_FALSE(localize(mapper, 11.0, T_new_old * off, SE3())) << "only once";
  EXPECT_EQ(mapper.final_trajectory().keyframes.size(), 1U);
}

TEST_F(MapperBeforeAWall, RelocalizesAfterALossBeforeThereIsAMap) {
  for (const bool last_chance : {false, true}) {
    Mapper mapper{MapConfig{}, kLostAfter_s};
    mapper.restart(SE3(), now(0.0, SE3()));
    add_keyframe(mapper, 1.0, SE3());
    add_keyframe(mapper, 2.0, SE3(), last_chance);
    EXPECT_EQ(mapper.save()->keyframes.size(), last_chance ? 2U : 0U) << "what had left the window, too";
    const SE3 off = shift(0.0, 0.02, 0.01);
    mapper.restart(SE3(), now(5.0, off));
    EXPECT_EQ(localize(mapper, 5.1, off, SE3()), last_chance);
  }
}

TEST_F(MapperBeforeAWall, ForgetsKeyframesOfAReplacedStart) {
  Mapper mapper{MapConfig{}, kLostAfter_s};
  mapper.restart(SE3(), now(0.0, SE3()));
  add_keyframe(mapper, 1.0, SE3());
  mapper.restart(SE3(), now(1.5, SE3()));
  add_keyframe(mapper, 2.0, SE3(), true);
  EXPECT_EQ(mapper.save()->keyframes.size(), 1U);
}

TEST_F(MapperBeforeAWall, TakesNoMatchWhereDeadReckoningIsUncertain) {
  Mapper mapper{MapConfig{}, kLostAfter_s};
  mapper.restart(SE3(), now(0.0, SE3()));
  add_keyframe(mapper, 5.0, SE3());
  mapper.add_pose(now(6.0, SE3()));
  mapper.restart(SE3(), now(10.0, SE3()));
  EXPECT_FALSE(mapper.localized());
  EXPECT_FALSE(localize(mapper, 10.1, SE3(), SE3(), 1.0)) << "it may be by chance";
  EXPECT_TRUE(localize(mapper, 10.4, SE3(), SE3(), 1.0)) << "by the appearance of two images";
  EXPECT_TRUE(mapper.localized());
}

TEST_F(MapperBeforeAWall, FindsItsPlaceInAMapOfAnotherRunByTwoImagesThatAgree) {
  Mapper before{MapConfig{}, kLostAfter_s};
  before.restart(SE3(), now(0.0, SE3()));
  add_keyframe(before, 5.0, SE3());
  std::optional<SavedMap> saved = before.save();
  saved->cameras = {{"cam", 240, 180, 200.0}};
  Mapper mapper{MapConfig{}, kLostAfter_s};
  mapper.load(saved_map_from_bytes(to_bytes(*saved)));
  EXPECT_TRUE(mapper.awaiting_relocalization());
  EXPECT_FALSE(mapper.save());
  const SE3 T_O_B(so3::exp({0, 0, -0.8}), {1.0, 2.0, 0.3});
  mapper.restart(SE3(), now(0.0, T_O_B));
  EXPECT_FALSE(localize(mapper, 0.3, T_O_B, SE3()));
  EXPECT_TRUE(localize(mapper, 0.6, T_O_B, SE3()));
  EXPECT_FALSE(mapper.awaiting_relocalization());
  const SE3 T_M_B = mapper.odom_to_map().T_M_O() * T_O_B;
  EXPECT_LT(T_M_B.translation().norm(), 0.02);
  EXPECT_LT(so3::log(T_M_B.rotation()).norm(), 0.01);
  EXPECT_TRUE(mapper.save());
}

/// The odometry goes around a loop of 40 m, and is back where the keyframe is with this error.
class MapperAfterALoop : public MapperBeforeAWall {
 protected:
  Mapper mapper_{MapConfig{}, kLostAfter_s};

  void go_around() {
    mapper_.restart(SE3(), now(0.0, SE3()));
    add_keyframe(mapper_, 5.0, SE3());
  }
  /// Images along the wall, the first at t_s.
  void return_to_the_wall(double t_s, const SE3& error, int images) {
    for (int i = 1; i <= 40; ++i) {
      const double a = 2.0 * M_PI * i / 40.0;
      mapper_.predict(now(6.0 + i, error * shift(-6.4 * std::sin(a), 6.4 * (std::cos(a) - 1.0), 0.0)));
    }
    for (int i = 0; i < images; ++i) {
      const SE3 T_M_B = shift(0.0, 0.32 * i - 0.32, 0.0);  // features of the grid fall on one another
      localize(mapper_, t_s + 0.6 * i, error * T_M_B, T_M_B);
    }
  }
  /// On the wall: in front of it translation and rotation are hard to separate.
  double error_m(const SE3& error) const {
    const Eigen::Vector3d wall(2.0, 0.0, 0.0);
    return (mapper_.odom_to_map().T_M_O() * error * wall - wall).norm();
  }
};

TEST_F(MapperAfterALoop, ClosesItByImagesOfSeveralPlacesThatAgree) {
  const SE3 error = SE3(so3::exp({0, 0, 0.02}), {0.3, -0.4, 0.1});
  go_around();
  return_to_the_wall(60.0, error, 2);
  EXPECT_EQ(mapper_.odom_to_map().T_M_O().translation().norm(), 0.0) << "two are not enough";
  localize(mapper_, 61.2, error * shift(0.0, 0.32, 0.0), shift(0.0, 0.32, 0.0));
  EXPECT_LT(error_m(error), 0.03) << "it was off by 0.5";
  EXPECT_GT(mapper_.map_matches(second(61.2)).size(), 20U);
}

TEST_F(MapperAfterALoop, RefusesALoopThatDriftDoesNotExplain) {
  go_around();
  return_to_the_wall(60.0, shift(0.0, 2.5, 0.0), 5);
  EXPECT_EQ(mapper_.odom_to_map().T_M_O().translation().norm(), 0.0);
}

TEST_F(MapperAfterALoop, RefusesOneOfTwoPlacesThatLookTheSame) {
  go_around();
  add_keyframe(mapper_, 6.0, shift(0.0, 0.8, 0.0), image(SE3()));
  return_to_the_wall(60.0, shift(0.0, 0.4, 0.0), 5);
  EXPECT_EQ(mapper_.odom_to_map().T_M_O().translation().norm(), 0.0);
}

class MapperOfTwoCameras : public MapperBeforeAWall {
 protected:
  /// The second camera is 10 cm to the right of the first.
  const SE3 T_B_C2_ = shift(0.0, -0.1, 0.0) * T_B_C_;

  /// covered: that camera has a black image without features.
  std::vector<PosedImage> images(const SE3& T_O_B, const SE3& T_M_B, const std::string& covered = "") const {
    std::vector<PosedImage> posed = {{image_at(T_M_B * T_B_C_, "cam"), T_O_B * T_B_C_},
                                     {image_at(T_M_B * T_B_C2_, "cam2"), T_O_B * T_B_C2_}};
    for (PosedImage& each : posed) {
      if (each.image.camera != covered) continue;
      each.image.image.setTo(0);
      each.image.tracks.clear();
    }
    return posed;
  }

  /// With keyframes of both cameras, at the origin of M.
  void map_wall(Mapper& mapper) const {
    mapper.restart(SE3(), now(0.0, SE3()));
    const std::vector<PosedImage> seen = images(SE3(), SE3());
    mapper.predict(now(5.0, SE3()));
    mapper.keyframe(second(5.0), seen);
    MarginalizedKeyframe record{second(5.0), SE3(), {{"cam", T_B_C_, {}}, {"cam2", T_B_C2_, {}}}};
    for (std::size_t camera = 0; camera < 2; ++camera) {
      for (const Track& track : seen[camera].image.tracks)
        record.views[camera].points.push_back({track.id, track.point, 0.5, 0.005});
    }
    mapper.add_keyframe(record);
  }

  bool localize_both(Mapper& mapper, double t_s, const SE3& T_O_B, const SE3& T_M_B,
                     const std::string& covered = "") const {
    mapper.predict(now(t_s, T_O_B));
    return mapper.localize(second(t_s), images(T_O_B, T_M_B, covered));
  }

  static std::size_t matches_of(const Mapper& mapper, double t_s, const std::string& camera) {
    const std::vector<MapMatch> all = mapper.map_matches(second(t_s));
    return static_cast<std::size_t>(std::ranges::count(all, camera, &MapMatch::camera));
  }
};

TEST_F(MapperOfTwoCameras, MatchesTheMapInTheImagesOfBoth) {
  Mapper mapper{MapConfig{}, kLostAfter_s};
  map_wall(mapper);
  EXPECT_EQ(mapper.save()->keyframes.size(), 1U);
  const SE3 T_M_B = shift(0.05, 0.02, 0.0), T_O_B = shift(0.05, 0.03, 0.0);
  localize_both(mapper, 12.0, T_O_B, T_M_B);
  EXPECT_GT(matches_of(mapper, 12.0, "cam"), 20U);
  EXPECT_GT(matches_of(mapper, 12.0, "cam2"), 20U);
  const Eigen::Vector3d wall_B(2.0, 0.0, 0.0);
  EXPECT_LT((mapper.odom_to_map().T_M_O() * T_O_B * wall_B - T_M_B * wall_B).norm(), 0.006) << "it was off by 0.01";
}

TEST_F(MapperOfTwoCameras, GoesOnWithTheOneThatIsNotCovered) {
  for (const auto& [covered, other] : {std::pair{"cam", "cam2"}, {"cam2", "cam"}}) {
    Mapper mapper{MapConfig{}, kLostAfter_s};
    map_wall(mapper);
    localize_both(mapper, 12.0, shift(0.0, 0.01, 0.0), SE3(), covered);
    EXPECT_EQ(matches_of(mapper, 12.0, covered), 0U);
    EXPECT_GT(matches_of(mapper, 12.0, other), 20U) << other;
    const std::optional<SavedMap> saved = mapper.save();
    for (const MapView& view : saved->keyframes.front().views)
      for (const MapPoint& point : view.points)
        EXPECT_TRUE(view.camera == other || point.searched == 0) << "points do not count as missed under a cover";
  }
}

TEST_F(MapperOfTwoCameras, IsRelocalizedByTheOneThatIsNotCovered) {
  Mapper before{MapConfig{}, kLostAfter_s};
  map_wall(before);
  std::optional<SavedMap> saved = before.save();
  saved->cameras = {{"cam", 240, 180, 200.0}, {"cam2", 240, 180, 200.0}};
  for (const char* covered : {"", "cam", "cam2"}) {
    Mapper mapper{MapConfig{}, kLostAfter_s};
    mapper.load(saved_map_from_bytes(to_bytes(*saved)));
    const SE3 T_O_B(so3::exp({0, 0, -0.8}), {1.0, 2.0, 0.3});
    mapper.restart(SE3(), now(0.0, T_O_B));
    EXPECT_FALSE(localize_both(mapper, 0.3, T_O_B, SE3(), covered)) << "two cameras at one instant are not enough";
    EXPECT_TRUE(localize_both(mapper, 0.6, T_O_B, SE3(), covered)) << covered;
    EXPECT_LT((mapper.odom_to_map().T_M_O() * T_O_B).translation().norm(), 0.02) << covered;
  }
}

TEST_F(MapperBeforeAWall, GoesOnFromWhereTheBodyIsInANewTime) {
  Mapper mapper{MapConfig{}, kLostAfter_s};
  mapper.restart(SE3(), now(0.0, SE3()));
  mapper.restart(shift(1.0, 0.0, 0.0), now(3.0, SE3()));
  const SE3 T_M_O = mapper.odom_to_map().T_M_O();
  EXPECT_NEAR(T_M_O.translation().x(), -1.0, 1e-12);
  mapper.begin_epoch();
  EXPECT_FALSE(mapper.started());
  EXPECT_EQ(mapper.odom_to_map().T_M_O().translation(), T_M_O.translation());
}

TEST_F(MapperBeforeAWall, RelocalizesFartherOffAfterAGapOfAllSensors) {
  for (const auto& [gap_s, relocalized] : {std::pair(0.0, false), {1.5, true}}) {
    Mapper mapper{MapConfig{}, kLostAfter_s};
    mapper.restart(SE3(), now(0.0, SE3()));
    add_keyframe(mapper, 5.0, SE3());
    const SE3 off(so3::exp({0, 0, 0.5}), {0.0, 3.0, 0.0});
    mapper.reset_uncertainty(now(6.0, off), gap_s);
    EXPECT_FALSE(localize(mapper, 6.1, off, SE3()));
    EXPECT_EQ(localize(mapper, 6.4, off, SE3()), relocalized) << gap_s;
  }
}

TEST_F(MapperBeforeAWall, RelocalizesAsFarOffAsDeadReckoningCanBeByTheTimeAfterWhichALossIsReported) {
  for (const auto& [lost_after_s, relocalized] : {std::pair(2.5, false), {6.0, true}}) {
    Mapper mapper{MapConfig{}, lost_after_s};
    mapper.restart(SE3(), now(0.0, SE3()));
    add_keyframe(mapper, 5.0, SE3());
    const SE3 off = shift(0.0, 3.0, 0.0);
    mapper.restart(SE3(), now(6.0, off));
    EXPECT_FALSE(localize(mapper, 6.1, off, SE3()));
    EXPECT_EQ(localize(mapper, 6.4, off, SE3()), relocalized) << lost_after_s;
  }
}

}  // namespace
}  // namespace edged
