// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/events/accumulate.hpp"

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "edged/core/check.hpp"

namespace edged {
namespace {

/// Adds events of weight one to the image of their polarity; both have a border of one pixel on each side.
class BilinearSplat {
 public:
  BilinearSplat(cv::Mat& positive, cv::Mat& negative)
      : data_{negative.ptr<float>(), positive.ptr<float>()},
        stride_(static_cast<std::ptrdiff_t>(positive.step1())),
        max_x_(static_cast<float>(positive.cols - 1)),
        max_y_(static_cast<float>(positive.rows - 1)) {}

  void prefetch(float x, float y, bool positive) const {
    const float px = x + 1.0F, py = y + 1.0F;
    if (!inside(px, py)) return;
    const float* top = data_[positive] + static_cast<int>(py) * stride_ + static_cast<int>(px);
    __builtin_prefetch(top, 1);
    __builtin_prefetch(top + stride_, 1);
  }

  /// x, y [px] in the image without its border.
  void operator()(float x, float y, bool positive) const {
    const float px = x + 1.0F, py = y + 1.0F;
    if (!inside(px, py)) return;
    const int column = static_cast<int>(px), row = static_cast<int>(py);
    const float fx = px - static_cast<float>(column), fy = py - static_cast<float>(row);
    float* top = data_[positive] + row * stride_ + column;
    float* bottom = top + stride_;
    const float lower = fx * fy, right = fx - lower, left = fy - lower;
    top[0] += 1.0F - fx - left;
    top[1] += right;
    bottom[0] += left;
    bottom[1] += lower;
  }

 private:
  bool inside(float px, float py) const { return px >= 0.0F && py >= 0.0F && px < max_x_ && py < max_y_; }

  float* data_[2];
  std::ptrdiff_t stride_;
  float max_x_, max_y_;
};

/// The sum of the squares of an event's weights along one axis, mean over all subpixels: weights 1 - f and f, blurred.
double spread_along_axis(double blur_sigma_px) {
  constexpr double kSame = 2.0 / 3.0, kNext = 1.0 / 6.0;  // means of (1 - f)^2 + f^2 and of f (1 - f)
  if (blur_sigma_px <= 0.0) return kSame;
  const cv::Mat kernel = cv::getGaussianKernel(2 * cvCeil(4.0 * blur_sigma_px) + 1, blur_sigma_px, CV_64F);
  const cv::Mat later = kernel.rowRange(1, kernel.rows), earlier = kernel.rowRange(0, kernel.rows - 1);
  return kSame * kernel.dot(kernel) + 2.0 * kNext * later.dot(earlier);
}

}  // namespace

double image_variance(const cv::Mat& image) {
  if (image.empty()) return 0.0;
  EDGED_CHECK(image.channels() == 1, "image has {} channels", image.channels());
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  return deviation[0] * deviation[0];
}

void EventFrameConfig::visit(ConfigFields& fields) {
  fields.choice("interpolation", interpolation,
                {{"piecewise", WarpInterpolation::Piecewise},
                 {"single_twist", WarpInterpolation::SingleTwist},
                 {"none", WarpInterpolation::None}},
                {.effect = "Camera pose at the time of an event: interpolated between IMU poses, one constant twist "
                           "per packet, or no motion compensation."});
  fields.add(
      "saturation_events", saturation_events,
      {"events", 0.1, 1000, "This many events on one pixel are white. Fewer give more contrast and more noise."});
  fields.choice("depth", depth, {{"scene", EventDepth::Scene}, {"landmarks", EventDepth::Landmarks}},
                {.effect = "Depth for the motion compensation: one for the scene, or that of the nearest landmark."});
  fields.add("blur_sigma_px", blur_sigma_px,
             {"px", 0, 10, "Gaussian blur of the event frame, which gives the tracker smoother gradients. 0: off."});
}

EventFrameRenderer::EventFrameRenderer(UndistortTable table, const EventFrameConfig& config)
    : table_(std::move(table)),
      config_(config),
      spread_(std::pow(spread_along_axis(config.blur_sigma_px), 2)),
      positive_(table_.height() + 2, table_.width() + 2, CV_32FC1),
      negative_(positive_.size(), CV_32FC1) {
  EDGED_CHECK(config_.saturation_events > 0.0, "saturation_events is {}", config_.saturation_events);
}

cv::Mat EventFrameRenderer::accumulate(std::span<const Event> events, const CameraMotion& motion, double depth,
                                       const DepthGrid* depths) {
  positive_.setTo(0.0F);
  negative_.setTo(0.0F);
  if (!events.empty()) {
    const WarpSettings settings{config_.interpolation, depth};
    const EventWarp warp(table_.ideal(), motion, settings, events.front().t, events.back().t);
    const BilinearSplat splat(positive_, negative_);
    if (depths != nullptr) {
      warp.for_each(events, table_, *depths, splat);
    } else {
      warp.for_each(events, table_, splat);
    }
  }
  cv::add(positive_, negative_, sum_);
  return sum_(cv::Rect(1, 1, table_.width(), table_.height()));
}

EventFrame EventFrameRenderer::render(std::span<const Event> events, const CameraMotion& motion, double depth,
                                      const DepthGrid* depths, double weight) {
  const cv::Mat sum = accumulate(events, motion, depth, depths);
  cv::subtract(positive_, negative_, difference_);
  const double scale = weight * 255.0 / config_.saturation_events;
  const cv::Mat difference = difference_(cv::Rect(1, 1, table_.width(), table_.height()));
  EventFrame frame{finish(sum, scale, 0.0), finish(difference, 0.5 * scale, 128.0)};
  const double mean = cv::mean(frame.image)[0];
  if (mean > 0.0) frame.structure = image_variance(frame.increments) / (0.25 * scale * spread_ * mean);
  return frame;
}

cv::Mat EventFrameRenderer::finish(const cv::Mat& sum, double scale, double zero) {
  cv::Mat finished;
  if (config_.blur_sigma_px > 0.0) {
    cv::GaussianBlur(sum, blurred_, cv::Size(), config_.blur_sigma_px, config_.blur_sigma_px,
                     cv::BORDER_REFLECT_101 | cv::BORDER_ISOLATED);
    blurred_.convertTo(finished, CV_8U, scale, zero);
  } else {
    sum.convertTo(finished, CV_8U, scale, zero);
  }
  return finished;
}

}  // namespace edged
