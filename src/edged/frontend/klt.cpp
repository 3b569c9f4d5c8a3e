// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Pyramidal Lucas-Kanade on OpenCV.
#include "edged/frontend/klt.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "edged/core/check.hpp"
#include "edged/frontend/tuning.hpp"

namespace edged {
namespace {

// OpenCV's eigenvalue is that of the mean squared gradient [grey/px]^2 over 1024 (Scharr gain 32, scale 2^-20).
constexpr double kEigenvalueScale = 1.0 / 1024.0;

}  // namespace

void KltConfig::visit(ConfigFields& fields) {
  fields.add("window_px", window_px, {"px", 5, 61, "Side length of the matched window, odd."});
  fields.add("levels", levels, {"1", 1, 6, "Number of pyramid levels, full size included."});
}

void ImagePyramid::build(const cv::Mat& image, const KltConfig& config) {
  EDGED_CHECK(image.type() == CV_8UC1 && !image.empty(), "type {}, {}x{}", image.type(), image.cols, image.rows);
  cv::buildOpticalFlowPyramid(image, levels_, cv::Size(config.window_px, config.window_px), config.levels - 1, true,
                              cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, false);
}

Flow follow(const ImagePyramid& from, const ImagePyramid& to, const std::vector<cv::Point2f>& points,
            const std::vector<cv::Point2f>& seeds, int top_level, const KltConfig& config, double epsilon_px) {
  EDGED_CHECK(points.size() == seeds.size(), "{} points, {} seeds", points.size(), seeds.size());
  Flow flow{seeds, {}};
  if (points.empty()) return flow;
  const cv::TermCriteria stop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, kFrontendTuning.flow_iterations,
                              epsilon_px);
  const double min_eigenvalue = config.min_gradient * config.min_gradient * kEigenvalueScale;
  cv::calcOpticalFlowPyrLK(from.levels(), to.levels(), points, flow.points, flow.found, cv::noArray(),
                           cv::Size(config.window_px, config.window_px), top_level, stop, cv::OPTFLOW_USE_INITIAL_FLOW,
                           min_eigenvalue);
  return flow;
}

double patch_correlation(const cv::Mat& image_a, const cv::Point2f& a, const cv::Mat& image_b, const cv::Point2f& b) {
  const cv::Size size(kFrontendTuning.appearance_px, kFrontendTuning.appearance_px);
  cv::Mat patch_a, patch_b;
  cv::getRectSubPix(image_a, size, a, patch_a, CV_32F);
  cv::getRectSubPix(image_b, size, b, patch_b, CV_32F);
  const int n = kFrontendTuning.appearance_px * kFrontendTuning.appearance_px;
  const float* pa = patch_a.ptr<float>();
  const float* pb = patch_b.ptr<float>();
  double sum_a = 0, sum_b = 0, sum_aa = 0, sum_bb = 0, sum_ab = 0;
  for (int i = 0; i < n; ++i) {
    const double va = pa[i], vb = pb[i];
    sum_a += va, sum_b += vb, sum_aa += va * va, sum_bb += vb * vb, sum_ab += va * vb;
  }
  const double variance_a = sum_aa - sum_a * sum_a / n, variance_b = sum_bb - sum_b * sum_b / n;
  if (variance_a < 1e-6 * n || variance_b < 1e-6 * n) return 0.0;
  return (sum_ab - sum_a * sum_b / n) / std::sqrt(variance_a * variance_b);
}

}  // namespace edged
