// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/places/place.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

namespace edged {
namespace {

/// Points in front of a rotated and tilted camera, some with wrong matches.
struct Scene {
  SE3 T_M_C;
  std::vector<PlaceMatch> matches;
};

/// One random number a statement: compilers evaluate arguments in different orders.
Scene scene(std::uint64_t seed, int right, int wrong) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto any = [&] {
    const double z = unit(random), y = unit(random), x = unit(random);
    return Eigen::Vector3d(x, y, z);
  };
  const Eigen::Quaterniond forward(Eigen::Matrix3d{{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}});
  const Eigen::Vector3d position = 2.0 * any();
  const Eigen::Quaterniond tilt = so3::exp(0.3 * any());
  const Eigen::Quaterniond heading = so3::exp({0.0, 0.0, 3.0 * unit(random)});
  Scene created{SE3(heading * tilt * forward, position), {}};
  for (int i = 0; i < right + wrong; ++i) {
    const double y = 0.4 * unit(random), x = 0.5 * unit(random);
    const Eigen::Vector2d point(x, y);
    const Eigen::Vector3d p_M = created.T_M_C * ((2.5 + unit(random)) * point.homogeneous());
    const double noise_y = 0.001 * unit(random), noise_x = 0.001 * unit(random);
    created.matches.push_back(
        {point + Eigen::Vector2d(noise_x, noise_y), i < right ? p_M : Eigen::Vector3d(p_M + 2.0 * any())});
  }
  return created;
}

TEST(PoseByGravity, IsFoundAmongManyWrongMatches) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Scene created = scene(seed, 20, 40);
    // Of the attitude only the tilt is known: the heading of O is arbitrary.
    const Eigen::Quaterniond R_O_C = so3::exp({0.0, 0.0, 0.37 * static_cast<double>(seed)}) * created.T_M_C.rotation();
    const auto found = pose_by_gravity(created.matches, R_O_C, 0.015);
    ASSERT_TRUE(found);
    EXPECT_GE(found->agreeing, 17U);
    EXPECT_LT((found->T_M_C.translation() - created.T_M_C.translation()).norm(), 0.008) << "seed " << seed;
    EXPECT_LT(so3::log(found->T_M_C.rotation().conjugate() * created.T_M_C.rotation()).norm(), 0.003);
  }
}

TEST(PoseByGravity, AgreesWithFewWhereAllMatchesAreWrong) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Scene created = scene(seed, 0, 60);
    const auto found = pose_by_gravity(created.matches, created.T_M_C.rotation(), 0.015);
    EXPECT_TRUE(!found || found->agreeing < 9U) << "seed " << seed;
  }
}

TEST(PoseByGravity, NeedsTwoMatches) {
  EXPECT_FALSE(pose_by_gravity(scene(1, 1, 0).matches, Eigen::Quaterniond::Identity(), 0.015));
}

/// Grey blobs, rotated about the image centre.
cv::Mat blobs(double turn_deg) {
  cv::Mat image(180, 240, CV_8UC1, cv::Scalar(100));
  cv::RNG random(5);
  for (int i = 0; i < 300; ++i) {
    const cv::Point at(random.uniform(0, 240), random.uniform(0, 180));
    cv::circle(image, at, random.uniform(2, 9), cv::Scalar(random.uniform(0, 255)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, {}, 1.0);
  cv::warpAffine(image, image, cv::getRotationMatrix2D({120.0F, 90.0F}, turn_deg, 1.0), image.size());
  return image;
}

TEST(Describe, IsTheSameForACameraThatIsTurnedAboutItsAxis) {
  const std::vector<Eigen::Vector2d> pixels = {{120, 90}}, points = {{0, 0}};
  const auto upright = describe(blobs(0.0), pixels, points, {0, -1, 0});
  const double turn = 40.0 * M_PI / 180.0;  // of the image, counter-clockwise as displayed
  const auto turned = describe(blobs(40.0), pixels, points, {-std::sin(turn), -std::cos(turn), 0});
  const auto elsewhere = describe(blobs(0.0), std::vector<Eigen::Vector2d>{{70, 100}}, points, {0, -1, 0});
  ASSERT_TRUE(upright[0] && turned[0] && elsewhere[0]);
  EXPECT_LT(distance(*upright[0], *turned[0]), 50);
  EXPECT_GT(distance(*upright[0], *elsewhere[0]), 80);
  EXPECT_EQ(distance(*upright[0], *upright[0]), 0);
}

TEST(Describe, LeavesOutTheRimAndWhatLiesStraightUpOrDown) {
  const std::vector<Eigen::Vector2d> pixels = {{120, 90}, {3, 90}}, points = {{0, 0}, {-0.6, 0}};
  EXPECT_FALSE(describe(blobs(0.0), pixels, points, {0, -1, 0})[1]);
  EXPECT_FALSE(describe(blobs(0.0), pixels, points, {0, 0, -1})[0]) << "looks down";
  EXPECT_TRUE(describe(blobs(0.0), {}, {}, {0, -1, 0}).empty());
  const cv::Mat tiny(6, 8, CV_8UC1, cv::Scalar(90));
  EXPECT_FALSE(
      describe(tiny, std::vector<Eigen::Vector2d>{{4, 3}}, std::vector<Eigen::Vector2d>{{0, 0}}, {0, -1, 0})[0]);
}

}  // namespace
}  // namespace edged
