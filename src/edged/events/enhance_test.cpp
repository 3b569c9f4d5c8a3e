// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Algorithm 1 on images whose edges are known.
#include "edged/events/enhance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "edged/core/check.hpp"

namespace edged {
namespace {

constexpr int kSize = 64;

/// Only the edge map, of the plain image.
EnhanceConfig edges_only(EdgeMethod method) {
  EnhanceConfig config;
  config.method = method;
  config.blur_sigma_px = 0.0;
  config.clahe_clip = 0.0;
  config.edge_gain = 1.0;
  config.event_weight = 0.0;
  config.edge_weight = 1.0;
  return config;
}

/// Grey value a * x + b * y + c.
cv::Mat ramp(double a, double b, double c) {
  cv::Mat image(kSize, kSize, CV_8UC1);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) image.at<uchar>(y, x) = cv::saturate_cast<uchar>(a * x + b * y + c);
  }
  return image;
}

/// Random dots, blurred, as an event frame has them.
cv::Mat texture(int seed) {
  cv::RNG random(static_cast<std::uint64_t>(seed));
  cv::Mat image = cv::Mat::zeros(kSize, kSize, CV_8UC1);
  for (int i = 0; i < 60; ++i) image.at<uchar>(random.uniform(0, kSize), random.uniform(0, kSize)) = 255;
  cv::GaussianBlur(image, image, cv::Size(), 1.0);
  return image * 3;
}

constexpr EdgeMethod kMethods[] = {EdgeMethod::None,      EdgeMethod::Clahe, EdgeMethod::Canny,
                                   EdgeMethod::Laplacian, EdgeMethod::Sobel, EdgeMethod::Scharr};

double largest_difference(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF); }

TEST(Enhance, PassesTheEventFrameItselfWithoutAMethod) {
  const cv::Mat image = texture(1);
  EXPECT_EQ(enhance(image, EnhanceConfig()).data, image.data);
}

TEST(Enhance, GivesTheSlopeOfARampInGreyLevelsPerPixel) {
  for (const EdgeMethod method : {EdgeMethod::Sobel, EdgeMethod::Scharr}) {
    const cv::Mat edges = enhance(ramp(3, 0, 10), edges_only(method));
    EXPECT_EQ(edges.at<uchar>(20, 30), 3);
    EXPECT_EQ(edges.at<uchar>(40, 12), 3);
  }
}

TEST(Enhance, MeasuresADiagonalSlopeByTheChosenNorm) {
  for (const EdgeMethod method : {EdgeMethod::Sobel, EdgeMethod::Scharr}) {
    EnhanceConfig config = edges_only(method);
    config.edge_gain = 10.0;
    EXPECT_EQ(enhance(ramp(2, 1, 10), config).at<uchar>(20, 30), 22);  // 10 sqrt(5)
    config.norm = MagnitudeNorm::L1;
    EXPECT_EQ(enhance(ramp(2, 1, 10), config).at<uchar>(20, 30), 30);
  }
}

TEST(Enhance, LaplacianIsZeroOnARampAndTheCurvatureOfAParabola) {
  EXPECT_EQ(enhance(ramp(2, 1, 10), edges_only(EdgeMethod::Laplacian)).at<uchar>(20, 30), 0);
  cv::Mat parabola(kSize, kSize, CV_8UC1);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) parabola.at<uchar>(y, x) = cv::saturate_cast<uchar>((x - 32) * (x - 32));
  }
  EnhanceConfig config = edges_only(EdgeMethod::Laplacian);
  config.edge_gain = 5.0;
  EXPECT_EQ(enhance(parabola, config).at<uchar>(20, 34), 10);
  EXPECT_EQ(enhance(cv::Scalar(255) - parabola, config).at<uchar>(20, 34), 10);
}

TEST(Enhance, CannyMarksAStepOnceAndCountsItsThresholdsInGreyLevelsPerPixel) {
  cv::Mat step = cv::Mat::zeros(kSize, kSize, CV_8UC1);
  step.colRange(32, kSize).setTo(100);  // 50 grey/px over the two pixels beside the edge
  EnhanceConfig config = edges_only(EdgeMethod::Canny);
  config.canny_low = config.canny_high = 49.0;
  const cv::Mat edges = enhance(step, config);
  EXPECT_EQ(cv::countNonZero(edges.row(20)), 1);
  EXPECT_EQ(cv::countNonZero(edges.row(20).colRange(31, 33)), 1);
  config.canny_low = config.canny_high = 51.0;
  EXPECT_EQ(cv::countNonZero(enhance(step, config)), 0);
}

TEST(Enhance, ClaheAloneIsTheEqualisedFrame) {
  EnhanceConfig config = edges_only(EdgeMethod::Clahe);
  config.clahe_clip = 3.0;
  const cv::Mat image = texture(2) * 0.3;
  const cv::Mat equalised = enhance(image, config);
  cv::Scalar mean, before, after;
  cv::meanStdDev(image, mean, before);
  cv::meanStdDev(equalised, mean, after);
  EXPECT_GT(after[0], 1.3 * before[0]);
}

TEST(Enhance, SharpensInThePapersFormWhatTheEqualisationChanged) {
  EnhanceConfig config = edges_only(EdgeMethod::Clahe);
  config.blur_sigma_px = 0.8;
  config.clahe_clip = 2.0;
  const cv::Mat image = texture(3), clahe = enhance(image, config);
  cv::Mat blur;
  cv::GaussianBlur(image, blur, cv::Size(), config.blur_sigma_px, config.blur_sigma_px, cv::BORDER_REFLECT_101);
  config.sharpening = Sharpening::Paper;
  const cv::Mat sharpened = enhance(image, config);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const int c = clahe.at<uchar>(y, x), b = blur.at<uchar>(y, x);
      EXPECT_EQ(sharpened.at<uchar>(y, x), cv::saturate_cast<uchar>(c + config.sharpen_lambda * (c - b)));
    }
  }
}

TEST(Enhance, UnsharpMaskingRaisesTheContrastOfDetailAndLeavesFlatAreas) {
  EnhanceConfig config = edges_only(EdgeMethod::Clahe);  // which gives what it is given, without equalization
  config.sharpening = Sharpening::Unsharp;
  cv::Mat image(kSize, kSize, CV_8UC1, cv::Scalar(80));
  image(cv::Rect(30, 30, 3, 3)).setTo(120);
  const cv::Mat sharpened = enhance(image, config);
  EXPECT_GT(sharpened.at<uchar>(31, 31), 125);
  EXPECT_LT(sharpened.at<uchar>(31, 34), 80);
  EXPECT_EQ(sharpened.at<uchar>(5, 5), 80);
}

TEST(Enhance, ErosionThinsAThickEdge) {
  cv::Mat step = cv::Mat::zeros(kSize, kSize, CV_8UC1);
  step.colRange(32, kSize).setTo(200);
  EnhanceConfig config = edges_only(EdgeMethod::Sobel);
  config.blur_sigma_px = 2.0;
  const int thick = cv::countNonZero(enhance(step, config).row(20) > 20);
  config.erosion_px = 3;
  const int thin = cv::countNonZero(enhance(step, config).row(20) > 20);
  EXPECT_EQ(thin, thick - 2);
}

TEST(Enhance, BlendsWithFixedWeightsAndSaturates) {
  EnhanceConfig config = edges_only(EdgeMethod::Sobel);
  config.edge_gain = 10.0;
  config.event_weight = 0.5;
  config.edge_weight = 2.0;
  const cv::Mat image = ramp(3, 0, 10), result = enhance(image, config);
  EXPECT_EQ(result.at<uchar>(20, 30), 50 + 60);  // half of 100, twice 10 * 3
  config.edge_weight = 4.0;
  config.edge_gain = 20.0;
  EXPECT_EQ(enhance(image, config).at<uchar>(20, 60), 255);
}

TEST(Enhance, ScalesByNothingThatTheFrameHolds) {
  // The same patch, alone and beside a bright one, gives the same edge map.
  cv::Mat alone = cv::Mat::zeros(kSize, kSize, CV_8UC1);
  cv::circle(alone, {16, 16}, 6, cv::Scalar(60), cv::FILLED, cv::LINE_AA);
  cv::Mat beside = alone.clone();
  cv::circle(beside, {48, 48}, 6, cv::Scalar(255), cv::FILLED, cv::LINE_AA);
  const cv::Rect patch(0, 0, 32, 32);
  for (const EdgeMethod method : kMethods) {
    const EnhanceConfig config = edges_only(method);
    EXPECT_EQ(largest_difference(enhance(alone, config)(patch), enhance(beside, config)(patch)), 0.0)
        << static_cast<int>(method);
  }
}

TEST(Enhance, GivesAnImageOfTheSameSizeWithAllStepsOn) {
  EnhanceConfig config;
  config.method = EdgeMethod::Scharr;
  config.sharpening = Sharpening::Unsharp;
  config.erosion_px = 3;
  const cv::Mat image = texture(4), enhanced = enhance(image, config);
  EXPECT_EQ(enhanced.type(), CV_8UC1);
  EXPECT_EQ(enhanced.size(), image.size());
  EXPECT_GT(largest_difference(enhanced, image), 0.0);
}

TEST(Enhance, NeverChangesItsInput) {
  const cv::Mat image = texture(5), copy = image.clone();
  for (const EdgeMethod method : kMethods) {
    EnhanceConfig config;
    config.method = method;
    enhance(image, config);
    EXPECT_EQ(largest_difference(image, copy), 0.0);
  }
}

struct Contradiction {
  std::string name;
  std::string says;
  std::function<void(EnhanceConfig&)> make;
};

std::string in_group(std::string_view key) { return "enhance." + std::string(key); }

class RefusedEnhancement : public testing::TestWithParam<Contradiction> {};

TEST_P(RefusedEnhancement, SaysWhy) {
  EnhanceConfig config;
  config.method = EdgeMethod::Sobel;
  EXPECT_NO_THROW(config.validate(in_group));
  GetParam().make(config);
  try {
    config.validate(in_group);
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find(GetParam().says), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("enhance."), std::string::npos) << e.what();
  }
}

INSTANTIATE_TEST_SUITE_P(
    Enhance, RefusedEnhancement,
    testing::Values(
        Contradiction{"ErosionOfCannyEdges", "one pixel wide",
                      [](EnhanceConfig& c) { c.method = EdgeMethod::Canny, c.erosion_px = 3; }},
        Contradiction{"ErosionWithoutEdges", "no edge map",
                      [](EnhanceConfig& c) { c.method = EdgeMethod::Clahe, c.erosion_px = 3; }},
        Contradiction{"NoWeightAtAll", "black image", [](EnhanceConfig& c) { c.event_weight = c.edge_weight = 0.0; }},
        Contradiction{"EvenKernel", "odd", [](EnhanceConfig& c) { c.erosion_px = 2; }},
        Contradiction{"CannyThresholdsSwapped", "canny_high",
                      [](EnhanceConfig& c) { c.method = EdgeMethod::Canny, c.canny_low = 90, c.canny_high = 30; }},
        Contradiction{"ClaheWithoutEqualisation", "clahe_clip",
                      [](EnhanceConfig& c) { c.method = EdgeMethod::Clahe, c.clahe_clip = 0.0; }},
        Contradiction{"PapersSharpeningOfNothing", "unsharp",
                      [](EnhanceConfig& c) { c.sharpening = Sharpening::Paper, c.clahe_clip = 0.0; }},
        Contradiction{"SharpeningOfStrengthZero", "sharpen_lambda",
                      [](EnhanceConfig& c) { c.sharpening = Sharpening::Unsharp, c.sharpen_lambda = 0.0; }}),
    [](const auto& tested) { return tested.param.name; });

TEST(Enhance, AcceptsErosionOfThickEdges) {
  for (const EdgeMethod method : {EdgeMethod::Laplacian, EdgeMethod::Sobel, EdgeMethod::Scharr}) {
    EnhanceConfig config;
    config.method = method;
    config.erosion_px = 3;
    EXPECT_NO_THROW(config.validate(in_group));
  }
}

}  // namespace
}  // namespace edged
