// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/stereo_matcher.hpp"

#include <gtest/gtest.h>

#include "edged/frontend/test_scene.hpp"

namespace edged {
namespace {

/// Two cameras 11 cm apart, a little turned to each other, in front of a plane.
class StereoPair : public testing::Test {
 protected:
  StereoMatcher matcher(const StereoConfig& config = {}) const {
    return {{scene_.camera(), left_}, {scene_.camera(), right_}, T_W_right_.inverse(), config};
  }

  PlaneScene scene_{davis_like_pinhole(), 2.0};
  SE3 T_W_right_{so3::exp(Eigen::Vector3d(0.01, -0.015, 0.02)), Eigen::Vector3d(0.11, 0.004, -0.01)};
  cv::Mat left_ = scene_.image(SE3()), right_ = scene_.image(T_W_right_);
};

TEST_F(StereoPair, FindsFeaturesWithAndWithoutADepthWhateverTheGain) {
  right_.convertTo(right_, CV_8U, 0.6, 40.0);
  for (const std::optional<double> depth : {std::optional<double>(), std::optional(2.0), std::optional(2.3)}) {
    int seen = 0, found = 0;
    for (double y = 20.0; y < 165.0; y += 12.0) {
      for (double x = 20.0; x < 225.0; x += 12.0) {
        const Eigen::Vector2d feature(x + 0.3, y + 0.2), truth = *scene_.moved(feature, SE3(), T_W_right_);
        if (!scene_.camera().contains(truth, 8.0)) continue;
        ++seen;
        const auto match = matcher().match(feature, depth);
        if (!match) continue;
        ++found;
        EXPECT_LT((*match - truth).norm(), 0.2) << feature.transpose();
      }
    }
    EXPECT_GT(found, 0.9 * seen) << "of " << seen << ", depth " << depth.value_or(0.0);
  }
}

TEST_F(StereoPair, RefusesWhatIsNotInViewOrIsAnother) {
  EXPECT_FALSE(matcher().match({6.5, 90.0}, std::nullopt)) << "the patch leaves the image";
  EXPECT_FALSE(matcher().match({12.0, 90.0}, 0.5)) << "the other camera does not see it";
  EXPECT_FALSE(matcher().match({120.0, 90.0}, 8.0)) << "not at that depth";
  right_ = random_texture(240, 180, 9);
  int tried = 0, found = 0;
  for (double x = 60.0; x < 220.0; x += 5.0) {
    for (double y = 20.0; y < 170.0; y += 10.0, ++tried) found += matcher().match({x, y}, std::nullopt).has_value();
  }
  EXPECT_LT(found, tried / 20) << "another scene";
}

TEST_F(StereoPair, RefusesARepeatedPattern) {
  T_W_right_ = SE3(Eigen::Quaterniond::Identity(), {0.11, 0.0, 0.0});
  for (int x = 0; x < left_.cols; ++x) {
    for (int y = 0; y < left_.rows; ++y)
      left_.at<unsigned char>(y, x) = static_cast<unsigned char>(128 + 50 * std::sin(0.5 * x) + 50 * std::sin(0.4 * y));
  }
  right_ = left_;
  EXPECT_FALSE(matcher().match({150.0, 90.0}, std::nullopt));
}

TEST_F(StereoPair, MeasuresTheDistanceFromTheEpipolarLine) {
  const CameraModel& camera = scene_.camera();
  const Eigen::Vector2d feature(130.0, 70.0), seen = *scene_.moved(feature, SE3(), T_W_right_);
  const Eigen::Vector2d point = camera.pixel_to_point(feature);
  EXPECT_NEAR(matcher().epipolar_px(point, camera.pixel_to_point(seen)), 0.0, 1e-6);
  EXPECT_NEAR(matcher().epipolar_px(point, camera.pixel_to_point(seen + Eigen::Vector2d(0.0, 3.0))), 3.0, 0.05);
  EXPECT_LT(matcher().epipolar_px(point, camera.pixel_to_point(seen + Eigen::Vector2d(3.0, 0.0))), 0.3);
}

}  // namespace
}  // namespace edged
