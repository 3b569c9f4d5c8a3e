// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/low_light.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "edged/frontend/klt.hpp"
#include "edged/frontend/test_scene.hpp"

namespace edged {
namespace {

/// A texture between dark and bright grey levels, moved to the right by dx.
cv::Mat texture(double dark, double bright, double dx, double noise, unsigned seed) {
  cv::Mat image(180, 240, CV_32F);
  std::mt19937 random(seed);
  std::normal_distribution<float> read_noise(0.0F, static_cast<float>(std::max(noise, 1e-9)));
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double u = x - dx;
      const double wave =
          std::sin(0.31 * u + 0.1 * y) * std::sin(0.27 * y + 0.07 * u) + 0.5 * std::sin(0.11 * u - 0.19 * y);
      const double share = std::clamp(0.5 + 0.35 * wave, 0.0, 1.0);
      image.at<float>(y, x) =
          static_cast<float>(dark + (bright - dark) * share) + (noise > 0.0 ? read_noise(random) : 0.0F);
    }
  }
  cv::Mat grey;
  image.convertTo(grey, CV_8U);
  return grey;
}

TEST(LowLight, LeavesALitImageAsItIs) {
  LowLightNormalizer stretch({});
  const cv::Mat lit = texture(20, 200, 0, 1.0, 1);
  EXPECT_EQ(stretch(lit).data, lit.data);
}

TEST(LowLight, StretchesAFewGreyLevelsToMany) {
  LowLightNormalizer stretch({});
  const cv::Mat out = stretch(texture(2, 20, 0, 1.2, 1));
  double least = 0, most = 0;
  cv::minMaxLoc(out, &least, &most);
  EXPECT_GT(most - least, 120.0);
  EXPECT_LT(most, 255.0);
}

TEST(LowLight, HoldsItsGainWhileTheLightFlickers) {
  LowLightNormalizer stretch({});
  stretch(texture(2, 20, 0, 0.0, 1));
  const cv::Mat a = stretch(texture(2, 20, 0, 0.0, 1)), b = stretch(texture(2, 21, 0, 0.0, 1));
  EXPECT_LT(cv::norm(a, b, cv::NORM_INF), 16.0);  // one level times a gain of 9: no more than the light did
}

TEST(LowLight, MakesOpticalFlowPossibleInNoise) {
  constexpr double kShift_px = 3.3;
  KltConfig klt;
  LowLightNormalizer stretch({});
  const auto median_error = [&](const cv::Mat& from, const cv::Mat& to, std::size_t& found) {
    ImagePyramid a, b;
    a.build(from, klt);
    b.build(to, klt);
    std::vector<cv::Point2f> points;
    for (int y = 30; y < 160; y += 20) {
      for (int x = 30; x < 200; x += 20) points.emplace_back(static_cast<float>(x), static_cast<float>(y));
    }
    const Flow flow = follow(a, b, points, points, klt.levels - 1, klt);
    std::vector<double> errors;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (flow.found[i])
        errors.push_back(std::hypot(flow.points[i].x - points[i].x - kShift_px, flow.points[i].y - points[i].y));
    }
    found = errors.size();
    std::sort(errors.begin(), errors.end());
    return errors.empty() ? 1e9 : errors[errors.size() / 2];
  };
  const cv::Mat from = texture(1, 15, 0, 1.2, 1), to = texture(1, 15, kShift_px, 1.2, 2);
  std::size_t dim = 0, stretched = 0;
  median_error(from, to, dim);
  const cv::Mat bright_from = stretch(from), bright_to = stretch(to);
  EXPECT_LT(median_error(bright_from, bright_to, stretched), 0.4);
  EXPECT_GT(stretched, dim);
}

}  // namespace
}  // namespace edged
