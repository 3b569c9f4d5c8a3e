// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/outliers.hpp"

#include <gtest/gtest.h>

#include <random>

#include "edged/se3.hpp"

namespace edged {
namespace {

constexpr double kFocal = 200.0;

struct Scene {
  std::vector<Correspondence> pairs;
  std::vector<char> right;  // 0: a wrong match
};

double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1.0p-53;
}

// Points at 1..6 m, two images of a 240x180 camera with uniform noise of +-noise_px, and wrong matches anywhere.
Scene make_scene(const SE3& T_ref_cur, int right, int wrong, double noise_px, std::uint64_t seed = 7) {
  std::mt19937_64 random(seed);
  const auto noise = [&] { return uniform(random, -noise_px, noise_px) / kFocal; };
  const auto anywhere = [&] { return Eigen::Vector2d(uniform(random, -0.6, 0.6), uniform(random, -0.45, 0.45)); };
  Scene scene;
  while (static_cast<int>(scene.pairs.size()) < right) {
    const Eigen::Vector2d reference = anywhere();
    const Eigen::Vector3d p_cur = T_ref_cur.inverse() * (uniform(random, 1.0, 6.0) * reference.homogeneous());
    if (p_cur.z() < 0.2) continue;
    scene.pairs.push_back({reference, p_cur.hnormalized() + Eigen::Vector2d(noise(), noise())});
    scene.right.push_back(1);
  }
  for (int i = 0; i < wrong; ++i) scene.pairs.push_back({anywhere(), anywhere()}), scene.right.push_back(0);
  return scene;
}

double kept_right(const Scene& scene, const OutlierResult& result) {
  int kept = 0, all = 0;
  for (std::size_t i = 0; i < scene.right.size(); ++i) all += scene.right[i], kept += scene.right[i] & result.inlier[i];
  return static_cast<double>(kept) / all;
}

double rejected_wrong(const Scene& scene, const OutlierResult& result) {
  int rejected = 0, all = 0;
  for (std::size_t i = 0; i < scene.right.size(); ++i) {
    if (scene.right[i]) continue;
    ++all;
    rejected += 1 - result.inlier[i];
  }
  return static_cast<double>(rejected) / all;
}

const SE3 kMotion(so3::exp({0.05, -0.08, 0.1}), {0.25, 0.05, 0.1});
const SE3 kTurn(so3::exp({0.05, -0.2, 0.1}), Eigen::Vector3d::Zero());

// Averages over many scenes: a wrong match lies on its epipolar line by chance at times.
struct Quality {
  double kept = 0, rejected = 0;
};
Quality average(const SE3& T_ref_cur, const std::optional<Eigen::Matrix3d>& R, OutlierModel expected) {
  Quality q;
  const int scenes = 20;
  for (int s = 0; s < scenes; ++s) {
    const Scene scene = make_scene(T_ref_cur, 70, 30, 0.7, 100 + static_cast<std::uint64_t>(s));
    const OutlierResult result = find_inliers(scene.pairs, R, kFocal, {});
    EXPECT_EQ(result.model, expected) << "scene " << s;
    q.kept += kept_right(scene, result) / scenes;
    q.rejected += rejected_wrong(scene, result) / scenes;
  }
  return q;
}

TEST(Outliers, WithTheGyrosRotationRejectsWrongAndKeepsRightMatches) {
  const Quality q = average(kMotion, kMotion.R(), OutlierModel::Translation);
  EXPECT_GT(q.kept, 0.95);
  EXPECT_GT(q.rejected, 0.95);
}

TEST(Outliers, ToleratesAGyroRotationThatIsAQuarterDegreeOff) {
  const Eigen::Matrix3d off = kMotion.R() * so3::exp({0.003, -0.003, 0.002}).toRotationMatrix();
  const Quality q = average(kMotion, off, OutlierModel::Translation);
  EXPECT_GT(q.kept, 0.9);
  EXPECT_GT(q.rejected, 0.9);
}

TEST(Outliers, FivePointWorksWithoutARotation) {
  const Quality q = average(kMotion, std::nullopt, OutlierModel::FivePoint);
  EXPECT_GT(q.kept, 0.95);
  EXPECT_GT(q.rejected, 0.9);  // with five parameters more wrong matches fit by chance
}

TEST(Outliers, FivePointTakesOverWhenTheGyroIsFarOff) {
  const Eigen::Matrix3d off = kMotion.R() * so3::exp({0.3, 0.0, 0.2}).toRotationMatrix();
  const Quality q = average(kMotion, off, OutlierModel::FivePoint);
  EXPECT_GT(q.kept, 0.95);
  EXPECT_GT(q.rejected, 0.9);
}

TEST(Outliers, PureRotationKillsNoTracks) {
  for (const std::optional<Eigen::Matrix3d>& R :
       {std::optional<Eigen::Matrix3d>(kTurn.R()), std::optional<Eigen::Matrix3d>()}) {
    const Quality q = average(kTurn, R, OutlierModel::RotationOnly);
    EXPECT_DOUBLE_EQ(q.kept, 1.0);
    EXPECT_GT(q.rejected, 0.95);
  }
}

TEST(Outliers, StandstillKillsNoTracks) {
  const Scene scene = make_scene(SE3(), 80, 0, 0.3);
  const OutlierResult result = find_inliers(scene.pairs, Eigen::Matrix3d::Identity(), kFocal, {});
  EXPECT_EQ(result.inliers, 80);
}

TEST(Outliers, KeepsFarPointsWhoseParallaxDrownsInNoise) {
  std::mt19937_64 random(3);
  Scene scene = make_scene(kMotion, 60, 20, 0.5);
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector2d reference(uniform(random, -0.5, 0.5), uniform(random, -0.4, 0.4));
    const Eigen::Vector3d p_cur = kMotion.inverse() * (300.0 * reference.homogeneous());
    const Eigen::Vector2d noise(uniform(random, -0.5, 0.5), uniform(random, -0.5, 0.5));
    scene.pairs.push_back({reference, p_cur.hnormalized() + noise / kFocal});
    scene.right.push_back(1);
  }
  const OutlierResult result = find_inliers(scene.pairs, kMotion.R(), kFocal, {});
  EXPECT_GT(kept_right(scene, result), 0.97);
  EXPECT_GT(rejected_wrong(scene, result), 0.9);
}

TEST(Outliers, RejectsNothingWhenNoMotionHasSupport) {
  const Scene noise = make_scene(kMotion, 0, 60, 0.0);
  const OutlierResult result = find_inliers(noise.pairs, kMotion.R(), kFocal, {});
  EXPECT_EQ(result.model, OutlierModel::None);
  EXPECT_EQ(result.inliers, 60);
}

TEST(Outliers, KeepsAllOfVeryFewPairs) {
  for (const int n : {0, 1, 2, 5}) {
    const Scene scene = make_scene(kMotion, n, 0, 0.0);
    for (const std::optional<Eigen::Matrix3d>& R :
         {std::optional<Eigen::Matrix3d>(kMotion.R()), std::optional<Eigen::Matrix3d>()}) {
      EXPECT_EQ(find_inliers(scene.pairs, R, kFocal, {}).inliers, n);
    }
  }
}

TEST(Outliers, GivesTheSameAnswerTwice) {
  const Scene scene = make_scene(kMotion, 70, 30, 0.7);
  for (const std::optional<Eigen::Matrix3d>& R :
       {std::optional<Eigen::Matrix3d>(kMotion.R()), std::optional<Eigen::Matrix3d>()}) {
    EXPECT_EQ(find_inliers(scene.pairs, R, kFocal, {}).inlier, find_inliers(scene.pairs, R, kFocal, {}).inlier);
  }
}

}  // namespace
}  // namespace edged
