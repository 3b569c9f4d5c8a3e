// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/undistort.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "edged/core/check.hpp"

namespace edged {
namespace {

using Eigen::Vector2d;

CameraModel davis240c() {
  return CameraModel(240, 180, 199.3714, 199.7079, 133.7544, 113.9922, DistortionModel::RadTan,
                     {-0.382899, 0.189336, -0.0010025, -0.00056378, 0.0});
}

CameraModel mvsec_left() {
  return CameraModel(346, 260, 226.38018, 226.15003, 173.64708, 133.73271, DistortionModel::Equidistant,
                     {-0.048031, 0.011331, -0.055378, 0.021501, 0.0});
}

CameraModel pincushion() {
  return CameraModel(640, 480, 500, 505, 310, 250, DistortionModel::RadTan, {0.12, 0.05, 0.004, -0.006, 0.03});
}

TEST(IdealPinhole, OfAPinholeIsItself) {
  const CameraModel raw(320, 240, 250, 260, 158.5, 121.25);
  const CameraModel ideal = ideal_pinhole(raw);
  EXPECT_NEAR(ideal.fx(), raw.fx(), 1e-9);
  EXPECT_NEAR(ideal.fy(), raw.fy(), 1e-9);
  EXPECT_NEAR(ideal.cx(), raw.cx(), 1e-9);
  EXPECT_NEAR(ideal.cy(), raw.cy(), 1e-9);
}

TEST(IdealPinhole, OfTheDavisIsCloseToOpenCvsAlphaZero) {
  const CameraModel ideal = ideal_pinhole(davis240c());
  // OpenCV samples a 9 x 9 grid; ours reads every border pixel.
  EXPECT_NEAR(ideal.fx(), 170.477, 2.0);
  EXPECT_NEAR(ideal.fy(), 179.719, 2.0);
  EXPECT_NEAR(ideal.cx(), 137.357, 2.0);
  EXPECT_NEAR(ideal.cy(), 117.737, 2.0);
  EXPECT_EQ(ideal.distortion(), DistortionModel::None);
  EXPECT_EQ(ideal.width(), 240);
  EXPECT_EQ(ideal.height(), 180);
}

TEST(IdealPinhole, IsFilledEntirelyAndTouchesAllFourBorders) {
  for (const CameraModel& raw : {davis240c(), mvsec_left(), pincushion()}) {
    const CameraModel ideal = ideal_pinhole(raw);
    double nearest[4] = {1e9, 1e9, 1e9, 1e9};  // raw distance of the ideal border to left, right, top, bottom [px]
    for (int y = 0; y < ideal.height(); ++y) {
      for (int x = 0; x < ideal.width(); ++x) {
        if (x > 0 && y > 0 && x < ideal.width() - 1 && y < ideal.height() - 1) continue;
        const Vector2d pixel = raw.distort_to_pixel(ideal.pixel_to_point(Vector2d(x, y)));
        nearest[0] = std::min(nearest[0], pixel.x());
        nearest[1] = std::min(nearest[1], raw.width() - 1 - pixel.x());
        nearest[2] = std::min(nearest[2], pixel.y());
        nearest[3] = std::min(nearest[3], raw.height() - 1 - pixel.y());
      }
    }
    for (const double distance : nearest) {
      EXPECT_GT(distance, -0.05);
      EXPECT_LT(distance, 0.1);
    }
  }
}

TEST(IdealPinhole, NeverHasFocalLengthsThatAreNotPositive) {
  // Where the new camera matrix of the reference implementation turned negative or exploded: an error or a sane camera.
  int errors = 0, cameras = 0;
  for (double k1 = -0.8; k1 <= 0.8; k1 += 0.1) {
    for (double k2 = -0.6; k2 <= 0.6; k2 += 0.1) {
      for (const DistortionModel model : {DistortionModel::RadTan, DistortionModel::Equidistant}) {
        try {
          const CameraModel raw(346, 260, 180, 180, 160, 140, model, {k1, k2, 0, 0, 0});
          const CameraModel ideal = ideal_pinhole(raw);
          ++cameras;
          EXPECT_GT(ideal.fx(), 0.0);
          EXPECT_GT(ideal.fy(), 0.0);
          EXPECT_TRUE(ideal.contains({ideal.cx(), ideal.cy()})) << ideal.cx() << " " << ideal.cy();
          EXPECT_TRUE(raw.contains(raw.distort_to_pixel(ideal.pixel_to_point({0, 0})), -0.1));
        } catch (const InputError&) {
          ++errors;
        }
      }
    }
  }
  EXPECT_GT(errors, 50);
  EXPECT_GT(cameras, 50);
}

TEST(UndistortTable, HoldsWhatTheModelsSayForEveryPixel) {
  for (const CameraModel& raw : {davis240c(), mvsec_left()}) {
    const CameraModel ideal = ideal_pinhole(raw);
    const UndistortTable table(raw, ideal);
    ASSERT_EQ(table.width(), raw.width());
    ASSERT_EQ(table.height(), raw.height());
    EXPECT_EQ(table.ideal(), ideal);
    for (int y = 0; y < raw.height(); ++y) {
      for (int x = 0; x < raw.width(); ++x) {
        const Vector2d back = raw.distort_to_pixel(ideal.pixel_to_point(table.at(x, y).cast<double>()));
        ASSERT_LT((back - Vector2d(x, y)).norm(), 1e-4);  // a float of a few hundred pixels keeps 3e-5
      }
    }
  }
}

TEST(UndistortTable, AgreesWithOpenCv) {
  const CameraModel raw = davis240c();
  const CameraModel ideal = ideal_pinhole(raw);
  const UndistortTable table(raw, ideal);
  std::vector<cv::Point2d> pixels, undistorted;
  for (int y = 0; y < raw.height(); ++y) {
    for (int x = 0; x < raw.width(); ++x) pixels.emplace_back(x, y);
  }
  const auto& k = raw.coefficients();
  cv::undistortPoints(pixels, undistorted, cv::Matx33d(raw.fx(), 0, raw.cx(), 0, raw.fy(), raw.cy(), 0, 0, 1),
                      std::vector<double>(k.begin(), k.end()), cv::noArray(),
                      cv::Matx33d(ideal.fx(), 0, ideal.cx(), 0, ideal.fy(), ideal.cy(), 0, 0, 1),
                      cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-12));
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Eigen::Vector2f& ours = table.at(static_cast<int>(pixels[i].x), static_cast<int>(pixels[i].y));
    ASSERT_NEAR(ours.x(), undistorted[i].x, 1e-3);
    ASSERT_NEAR(ours.y(), undistorted[i].y, 1e-3);
  }
}

TEST(IdealPinhole, LeavesOutWhatTheMaskOfTheLensDoes) {
  const CameraModel lens = davis240c();
  std::vector<std::uint8_t> used(240 * 180, 255);
  for (int y = 0; y < 180; ++y) std::fill_n(used.begin() + y * 240, 60, std::uint8_t{0});
  const CameraModel raw = lens.masked(used), ideal = ideal_pinhole(raw);
  ASSERT_TRUE(ideal.is_masked());
  const UndistortTable table(raw, ideal);
  for (int y = 5; y < 175; y += 5)
    for (int x = 5; x < 235; x += 5) {
      const Eigen::Vector2d seen = raw.distort_to_pixel(ideal.pixel_to_point({x, y}));
      if (std::abs(seen.x() - 59.5) > 1.0) {
        EXPECT_EQ(ideal.uses(x, y), seen.x() > 59.5) << x << ' ' << y;
      }
      EXPECT_EQ(std::isfinite(table.at(x, y).x()), x >= 60) << "an event there is not rendered";
    }
}

}  // namespace
}  // namespace edged
