// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "overview.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "drawing.hpp"

namespace edged {
namespace {

const cv::Scalar kGrid(228, 228, 228), kTruth(150, 150, 150), kEstimate(200, 90, 20);
constexpr int kMargin = 16, kImageWidth = 400, kPlotSize = 620, kTitleHeight = 44;

/// 1, 2 or 5 times a power of ten, so that five to eight steps fill the extent.
double nice_step(double extent) {
  const double rough = extent / 8.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10.0 * power;
}

/// Two axes of the world mapped into a square of the canvas with one scale.
class PathView {
 public:
  PathView(const Trajectory& trajectory, cv::Rect area) : area_(area) {
    Eigen::Vector3d low = trajectory.front().T.translation(), high = low;
    for (const StampedPose& pose : trajectory) {
      low = low.cwiseMin(pose.T.translation());
      high = high.cwiseMax(pose.T.translation());
    }
    const Eigen::Vector3d size = high - low;
    std::array<int, 3> axes = {0, 1, 2};
    std::sort(axes.begin(), axes.end(), [&size](int a, int b) { return size[a] > size[b]; });
    u_ = std::min(axes[0], axes[1]);
    v_ = std::max(axes[0], axes[1]);
    centre_ = 0.5 * (low + high);
    extent_ = std::max(1.2 * size.maxCoeff(), 0.01);
  }

  double extent() const { return extent_; }
  std::string axes() const { return fmt::format("{}, {} [m]", "xyz"[u_], "xyz"[v_]); }
  double low(int axis) const { return (axis == 0 ? centre_[u_] : centre_[v_]) - 0.5 * extent_; }

  cv::Point2d at(double u, double v) const {
    const double scale = area_.width / extent_;
    return {area_.x + scale * (u - low(0)), area_.y + area_.height - scale * (v - low(1))};
  }

  void draw(cv::Mat& canvas, const Trajectory& trajectory, const cv::Scalar& colour, int thickness) const {
    constexpr int kFractionBits = 4;
    std::vector<cv::Point> line;
    for (const StampedPose& pose : trajectory) {
      const cv::Point2d p = at(pose.T.translation()[u_], pose.T.translation()[v_]);
      line.emplace_back(cvRound(p.x * (1 << kFractionBits)), cvRound(p.y * (1 << kFractionBits)));
    }
    cv::polylines(canvas, line, false, colour, thickness, cv::LINE_AA, kFractionBits);
  }

  void mark_start(cv::Mat& canvas, const Trajectory& trajectory, const cv::Scalar& colour) const {
    const Eigen::Vector3d& p = trajectory.front().T.translation();
    cv::circle(canvas, at(p[u_], p[v_]), 5, colour, cv::FILLED, cv::LINE_AA);
  }

 private:
  cv::Rect area_;
  int u_ = 0, v_ = 1;
  Eigen::Vector3d centre_;
  double extent_ = 1.0;
};

void draw_grid(cv::Mat& canvas, const PathView& view, cv::Rect area) {
  const double step = nice_step(view.extent());
  for (int axis = 0; axis < 2; ++axis) {
    const int last = static_cast<int>(std::floor((view.low(axis) + view.extent()) / step));
    for (int i = static_cast<int>(std::ceil(view.low(axis) / step)); i <= last; ++i) {
      const double value = i * step;
      const cv::Point2d p = axis == 0 ? view.at(value, view.low(1)) : view.at(view.low(0), value);
      const cv::Point2d end = axis == 0 ? cv::Point2d(p.x, area.y) : cv::Point2d(area.x + area.width, p.y);
      cv::line(canvas, p, end, kGrid, 1);
      put_text(canvas, fmt::format("{:.3g}", value), cv::Point(cvRound(p.x) + 3, cvRound(p.y) - 4), 0.38);
    }
  }
  cv::rectangle(canvas, area, kGrid, 1);
}

void draw_paths(cv::Mat& canvas, const OverviewContent& content, cv::Rect area) {
  if (content.estimate.empty()) {
    put_text(canvas, "no pose was estimated", area.tl() + cv::Point(20, 40));
    return;
  }
  const PathView view(content.estimate, area);
  draw_grid(canvas, view, area);
  cv::Mat inside = canvas(area);
  const PathView local(content.estimate, cv::Rect(0, 0, area.width, area.height));
  local.draw(inside, content.truth, kTruth, 3);
  local.draw(inside, content.estimate, kEstimate, 1);
  local.mark_start(inside, content.estimate, kEstimate);
  const cv::Point legend = area.tl() + cv::Point(12, 22);
  cv::line(canvas, legend, legend + cv::Point(26, 0), kEstimate, 2, cv::LINE_AA);
  put_text(canvas, "estimate, from the dot on", legend + cv::Point(34, 4));
  if (!content.truth.empty()) {
    cv::line(canvas, legend + cv::Point(0, 20), legend + cv::Point(26, 20), kTruth, 3, cv::LINE_AA);
    put_text(canvas, "ground truth", legend + cv::Point(34, 24));
  }
  put_text(canvas, view.axes(), cv::Point(area.x + area.width - 86, area.y + 22));
}

void draw_image(cv::Mat& canvas, const cv::Mat& image, const std::string& caption, cv::Point at, int height) {
  put_text(canvas, caption, at + cv::Point(0, -6), 0.42);
  const double scale =
      std::min(static_cast<double>(kImageWidth) / image.cols, static_cast<double>(height) / image.rows);
  cv::Mat colour, sized;
  cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
  cv::resize(colour, sized, {}, scale, scale, scale > 1.0 ? cv::INTER_CUBIC : cv::INTER_AREA);
  sized.copyTo(canvas(cv::Rect(at, sized.size())));
}

}  // namespace

void LiveliestMoment::consider(const Step& step) {
  if (step.status != TrackingStatus::Good) return;
  if (!frame_.empty() && !step.frame) return;  // a moment with both images beats one with events alone
  if (step.event_frame.empty() && !step.frame) return;
  const double score = step.event_frame.empty() ? static_cast<double>(step.frame_tracks.size()) : step.event_rate_hz;
  const bool first_frame = frame_.empty() && step.frame;
  if (score <= score_ && !first_frame) return;
  score_ = score;
  if (step.frame) frame_ = step.frame->image.clone();
  event_frame_ = step.event_frame.clone();
}

cv::Mat draw_overview(const OverviewContent& content) {
  std::vector<std::pair<const cv::Mat*, const char*>> images;
  if (!content.moment.frame().empty()) images.emplace_back(&content.moment.frame(), "standard frame");
  if (!content.moment.event_frame().empty()) {
    images.emplace_back(&content.moment.event_frame(), "events of the same moment, motion-compensated");
  }
  const int plot_x = images.empty() ? kMargin : 2 * kMargin + kImageWidth;
  cv::Mat canvas(kTitleHeight + kPlotSize + kMargin, plot_x + kPlotSize + kMargin, CV_8UC3, kPaper);
  put_text(canvas, content.title, cv::Point(kMargin, 28), 0.55);
  constexpr int kCaption = 18, kImageHeight = kPlotSize / 2 - kCaption;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const int y = kTitleHeight + static_cast<int>(i) * (kPlotSize / 2 + kCaption / 2) + kCaption;
    draw_image(canvas, *images[i].first, images[i].second, cv::Point(kMargin, y), kImageHeight - kCaption / 2);
  }
  draw_paths(canvas, content, cv::Rect(plot_x, kTitleHeight, kPlotSize, kPlotSize));
  return canvas;
}

}  // namespace edged
