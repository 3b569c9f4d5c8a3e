// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Flights past a plane: depth, poses that are refined later, several cameras, and inputs without depth.
#include "edged/dense/dense_mapper.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "edged/camera/undistort.hpp"
#include "edged/dense/test_plane.hpp"

namespace edged {
namespace {

constexpr double kStep_m = 0.05;

DenseMapper mapped(int instants, const std::function<DenseInstant(int)>& instant, const DenseConfig& config = {}) {
  DenseMapper mapper(config);
  for (int i = 0; i < instants; ++i) mapper.add(instant(i));
  mapper.finish();
  return mapper;
}

std::size_t points_of(const DenseMapper& mapper) {
  std::size_t count = 0;
  for (const DepthMap& map : mapper.maps()) count += map.points.size();
  return count;
}

TEST(DenseMapper, MapsAPlaneOnce) {
  const TestPlane plane;
  const DenseMapper mapper = mapped(40, [&](int i) { return plane.instant(i, shifted(kStep_m * i)); });
  EXPECT_GE(mapper.counters().keyframes, 5U);
  EXPECT_GT(mapper.counters().with_depth, 6 * mapper.counters().edges / 10);
  EXPECT_LT(plane.median_error(mapper.maps()), 0.004);
  EXPECT_LT(points_of(mapper), 7 * mapper.counters().with_depth / 10) << "fused with later keyframes";
}

TEST(DenseMapper, RectifiesDistortedFrames) {
  const TestPlane plane;
  const CameraModel lens(160, 120, 140.0, 140.0, 79.5, 59.5, DistortionModel::RadTan, {-0.1, 0.01});
  const DenseMapper mapper = mapped(24, [&](int i) {
    DenseInstant instant = plane.instant(i, shifted(kStep_m * i));
    cv::Mat& image = instant.images[0].image;
    cv::Mat distorted(image.size(), CV_8UC1);
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        const Eigen::Vector2d at = TestPlane::pinhole().distort_to_pixel(lens.pixel_to_point({x, y}));
        const cv::Point pixel(std::clamp(cvRound(at.x()), 0, image.cols - 1),
                              std::clamp(cvRound(at.y()), 0, image.rows - 1));
        distorted.at<std::uint8_t>(y, x) = image.at<std::uint8_t>(pixel);
      }
    }
    image = distorted;
    instant.images[0].model = lens;
    return instant;
  });
  ASSERT_FALSE(mapper.maps().empty());
  EXPECT_EQ(mapper.maps()[0].pinhole, ideal_pinhole(lens));
  std::vector<double> errors;
  for (const DepthMap& map : mapper.maps()) {
    for (const DensePoint& point : map.points) {
      const Eigen::Vector2d pixel =
          TestPlane::pinhole().distort_to_pixel(map.pinhole.pixel_to_point({point.x, point.y}));
      errors.push_back(std::abs(1.0 / (point.inverse_depth * plane.depth(map.T_O_C, pixel)) - 1.0));
    }
  }
  ASSERT_GT(errors.size(), 300U);
  std::ranges::sort(errors);
  EXPECT_LT(errors[errors.size() / 2], 0.01);
}

TEST(DenseMapper, UsesThePosesThatTheWindowHasRefined) {
  const TestPlane plane;
  const auto with_errors = [&](int i, bool refined) {
    DenseInstant instant = plane.instant(i, shifted(kStep_m * i));
    instant.T_O_B.translation().x() *= 1.1;
    if (refined && i % 3 == 0 && i >= 9)
      instant.refined.push_back({plane.instant(i - 9, {}).t, shifted(kStep_m * (i - 9))});
    return instant;
  };
  EXPECT_GT(plane.median_error(mapped(36, [&](int i) { return with_errors(i, false); }).maps()), 0.05);
  const DenseMapper mapper = mapped(36, [&](int i) { return with_errors(i, true); });
  std::vector<DepthMap> early = mapper.maps();
  std::erase_if(early, [](const DepthMap& map) { return to_seconds(map.t - Timestamp{}) > 0.8; });
  EXPECT_LT(plane.median_error(early), 0.01);
}

TEST(DenseMapper, TakesAnotherCameraOfTheRigAsOneMoreView) {
  const TestPlane plane;
  const SE3 T_B_right = shifted(0.2);
  // Three places are too few for one camera.
  const auto instant = [&](int i, bool stereo) {
    DenseInstant seen = plane.instant(3 * i, shifted(0.12 * i));
    if (stereo)
      seen.images.push_back(
          {"right", Modality::Frames, TestPlane::pinhole(), T_B_right, plane.image(seen.T_O_B * T_B_right)});
    return seen;
  };
  EXPECT_EQ(mapped(3, [&](int i) { return instant(i, false); }).counters().keyframes, 0U);
  const DenseMapper stereo = mapped(3, [&](int i) { return instant(i, true); });
  EXPECT_GT(stereo.counters().keyframes, 0U);
  EXPECT_GT(points_of(stereo), 200U);
  EXPECT_LT(plane.median_error(stereo.maps()), 0.01);
}

TEST(DenseMapper, HasNoDepthWithoutParallaxTextureOrPoses) {
  const TestPlane plane, blank([](double, double) { return 90.0; });
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const DenseMapper turning = mapped(30, [&](int i) {
    return plane.instant(i, {so3::exp({0.0, 0.01 * i, 0.0}), Eigen::Vector3d::Zero()});
  });
  EXPECT_EQ(turning.counters().keyframes, 0U);
  EXPECT_GT(turning.counters().unmeasured, 0U);
  EXPECT_EQ(points_of(mapped(30, [&](int i) { return blank.instant(i, shifted(kStep_m * i)); })), 0U);
  EXPECT_EQ(points_of(mapped(30,
                             [&](int i) {
                               DenseInstant instant = plane.instant(i, shifted(kStep_m * i));
                               instant.T_O_B.translation().x() = nan;
                               return instant;
                             })),
            0U);
  EXPECT_EQ(points_of(mapped(30,
                             [&](int i) {
                               DenseInstant instant = plane.instant(i, shifted(kStep_m * i));
                               (i % 2 == 0 ? instant.scene_depth : instant.T_O_B.rotation().x()) = nan;
                               return instant;
                             })),
            0U);
  EXPECT_EQ(points_of(mapped(30,
                             [&](int i) {
                               DenseInstant instant = plane.instant(i, shifted(kStep_m * i));
                               instant.images[0].image.release();
                               return instant;
                             })),
            0U);
}

TEST(DenseMapper, DoesNotCompareViewsAcrossARestart) {
  const TestPlane plane;
  const DenseMapper mapper = mapped(40, [&](int i) {
    DenseInstant instant = plane.instant(i, shifted(kStep_m * i));
    instant.restart = i % 3 == 0;
    return instant;
  });
  EXPECT_EQ(mapper.counters().keyframes, 0U);
}

TEST(DenseMapper, KeepsABoundedNumberOfPoints) {
  const TestPlane plane;
  DenseConfig config;
  config.most_points = 500;
  const auto flight = [&](int i) { return plane.instant(i, shifted(kStep_m * i)); };
  EXPECT_GT(points_of(mapped(40, flight)), 500U);
  EXPECT_LE(points_of(mapped(40, flight, config)), 500U);
}

}  // namespace
}  // namespace edged
