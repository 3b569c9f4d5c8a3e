// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/events/accumulate.hpp"

#include <opencv2/imgproc.hpp>
#include <utility>

#include "edged/core/check.hpp"

namespace edged {
namespace {

/// Adds events of weight one to an image that has a border of one pixel on each side.
class BilinearSplat {
 public:
  explicit BilinearSplat(cv::Mat& padded)
      : data_(padded.ptr<float>()),
        stride_(static_cast<std::ptrdiff_t>(padded.step1())),
        max_x_(static_cast<float>(padded.cols - 1)),
        max_y_(static_cast<float>(padded.rows - 1)) {}

  /// x, y [px] in the image without its border.
  void operator()(float x, float y) const {
    const float px = x + 1.0F, py = y + 1.0F;
    if (!(px >= 0.0F && py >= 0.0F && px < max_x_ && py < max_y_)) return;
    const int column = static_cast<int>(px), row = static_cast<int>(py);
    const float fx = px - static_cast<float>(column), fy = py - static_cast<float>(row);
    float* top = data_ + row * stride_ + column;
    float* bottom = top + stride_;
    const float lower = fx * fy, right = fx - lower, left = fy - lower;
    top[0] += 1.0F - fx - left;
    top[1] += right;
    bottom[0] += left;
    bottom[1] += lower;
  }

 private:
  float* data_;
  std::ptrdiff_t stride_;
  float max_x_, max_y_;
};

}  // namespace

void EventFrameConfig::visit(ConfigFields& fields) {
  fields.choice("interpolation", interpolation,
                {{"piecewise", WarpInterpolation::Piecewise},
                 {"single_twist", WarpInterpolation::SingleTwist},
                 {"none", WarpInterpolation::None}},
                {.effect = "how the camera's pose is read at each event's time: between the IMU poses around it, with "
                           "one constant twist per packet, or not at all (no motion compensation)"});
  fields.add("saturation_events", saturation_events,
             {"events", 0.1, 1000, "events on one pixel that make it white; fewer give more contrast and more noise"});
  fields.choice("depth", depth, {{"scene", EventDepth::Scene}, {"landmarks", EventDepth::Landmarks}},
                {.effect = "depth that events are moved at: one of the whole scene, or that of the nearest landmark"});
  fields.add("depth_cell_px", depth_grid.cell_px, {"px", 1, 64, "depth = landmarks: side of a cell of equal depth"});
  fields.add("depth_reach_px", depth_grid.reach_px,
             {"px", 0, 1000, "depth = landmarks: cells further from any landmark have the scene's depth"});
  fields.add("blur_sigma_px", blur_sigma_px,
             {"px", 0, 10, "Gaussian blur of the event frame: smoother gradients for the tracker; 0 is off"});
}

EventFrameRenderer::EventFrameRenderer(UndistortTable table, const EventFrameConfig& config)
    : table_(std::move(table)), config_(config), padded_(table_.height() + 2, table_.width() + 2, CV_32FC1) {
  EDGED_CHECK(config_.saturation_events > 0.0, "saturation_events is {}", config_.saturation_events);
}

cv::Mat EventFrameRenderer::accumulate(std::span<const Event> events, const CameraMotion& motion, double depth,
                                       const DepthGrid* depths) {
  padded_.setTo(0.0F);
  if (!events.empty()) {
    const WarpSettings settings{config_.interpolation, depth};
    const EventWarp warp(table_.ideal(), motion, settings, events.front().t, events.back().t);
    if (depths != nullptr) {
      warp.for_each(events, table_, *depths, BilinearSplat(padded_));
    } else {
      warp.for_each(events, table_, BilinearSplat(padded_));
    }
  }
  return padded_(cv::Rect(1, 1, table_.width(), table_.height()));
}

cv::Mat EventFrameRenderer::render(std::span<const Event> events, const CameraMotion& motion, double depth,
                                   const DepthGrid* depths, double weight) {
  cv::Mat sum = accumulate(events, motion, depth, depths);
  if (config_.blur_sigma_px > 0.0) {
    cv::GaussianBlur(sum, blurred_, cv::Size(), config_.blur_sigma_px, config_.blur_sigma_px,
                     cv::BORDER_REFLECT_101 | cv::BORDER_ISOLATED);
    sum = blurred_;
  }
  cv::Mat frame;
  sum.convertTo(frame, CV_8U, weight * 255.0 / config_.saturation_events);
  return frame;
}

cv::Mat render_event_frame(std::span<const Event> events, const CameraMotion& motion, double depth,
                           const UndistortTable& table, const EventFrameConfig& config) {
  return EventFrameRenderer(table, config).render(events, motion, depth);
}

}  // namespace edged
