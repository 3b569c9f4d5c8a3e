// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/overview.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "common/files.hpp"
#include "common/pictures.hpp"
#include "common/step_facts.hpp"
#include "run/run_observer.hpp"

namespace edged {
namespace {

const cv::Scalar kGrid(228, 228, 228), kTruth(40, 30, 20), kEstimate(235, 160, 90), kWrong(40, 30, 190);
const cv::Scalar kNotSure(205, 235, 250), kLostTime(210, 210, 250), kNotYet(236, 236, 236);
constexpr int kMargin = 16, kImageWidth = 400, kPlaneSize = 430, kCurveHeight = 150, kTitleHeight = 70;
constexpr int kAxisLeft = 56, kAxisBelow = 40;
constexpr double kTickText = 0.38;

/// 1, 2 or 5 times a power of ten, so that five to eight steps fill the extent.
double nice_step(double extent) {
  const double rough = extent / 8.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10.0 * power;
}

int text_width(const std::string& text, double size) {
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, nullptr).width;
}

/// A window of two quantities mapped into an area of the canvas.
struct Axes {
  cv::Rect area;
  Eigen::Vector2d low, size;
  bool v_ticks = true;

  cv::Point2d at(double u, double v) const {
    return {area.x + area.width * (u - low.x()) / size.x(), area.br().y - area.height * (v - low.y()) / size.y()};
  }
};

/// Ticks left of the area and below it; no text lies in it.
void draw_axes(cv::Mat& canvas, const Axes& axes, const std::string& u_name, const std::string& v_name) {
  const cv::Rect& area = axes.area;
  for (int axis = 0; axis < (axes.v_ticks ? 2 : 1); ++axis) {
    const double room = axis == 0 ? area.width : 2.0 * area.height;  // heights of text need less
    const double step = nice_step(axes.size[axis] * std::max(1.0, kPlaneSize / room));
    const int last = static_cast<int>(std::floor((axes.low[axis] + axes.size[axis]) / step));
    for (int i = static_cast<int>(std::ceil(axes.low[axis] / step)); i <= last; ++i) {
      const std::string text = fmt::format("{:.4g}", i * step);
      const cv::Point2d p = axis == 0 ? axes.at(i * step, axes.low.y()) : axes.at(axes.low.x(), i * step);
      cv::line(canvas, p, axis == 0 ? cv::Point2d(p.x, area.y) : cv::Point2d(area.br().x, p.y), kGrid, 1);
      const int width = text_width(text, kTickText);
      const cv::Point below(cvRound(p.x) - width / 2, area.br().y + 16), left(area.x - width - 6, cvRound(p.y) + 4);
      put_text(canvas, text, axis == 0 ? below : left, kTickText);
    }
  }
  cv::rectangle(canvas, area, kGrid, 1);
  put_text(canvas, u_name, {area.x + (area.width - text_width(u_name, 0.42)) / 2, area.br().y + 34}, 0.42);
  put_text(canvas, v_name, {area.x - kAxisLeft + 8, area.y - 14}, 0.42);  // clear of a tick at the top
}

void draw_line(cv::Mat& canvas, const std::vector<cv::Point2d>& line, const cv::Scalar& colour, int thickness) {
  constexpr int kFractionBits = 4;
  std::vector<cv::Point> points;
  for (const cv::Point2d& p : line) points.emplace_back(cvRound(p.x * 16), cvRound(p.y * 16));
  cv::polylines(canvas, points, false, colour, thickness, cv::LINE_AA, kFractionBits);
}

/// Whether the path has a break before a pose: after a loss, or at a relocalization.
bool begins_anew(const OverviewContent& content, const Trajectory& path, std::size_t i) {
  constexpr Duration kGap = std::chrono::milliseconds(500);
  if (i == 0) return true;
  if (path[i].t - path[i - 1].t > kGap) return true;
  return std::ranges::any_of(content.changes, [&](const StatusChange& change) {
    return change.relocalized && change.t > path[i - 1].t && change.t <= path[i].t;
  });
}

void draw_path(cv::Mat& canvas, const Axes& axes, int v, const OverviewContent& content, bool truth) {
  const Trajectory& path = truth ? content.truth : content.estimate;
  const cv::Scalar& colour = truth ? kTruth : kEstimate;
  const int thickness = truth ? 1 : 3;  // above the estimate, which it would hide
  std::vector<cv::Point2d> line;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!truth && begins_anew(content, path, i)) draw_line(canvas, std::exchange(line, {}), colour, thickness);
    line.push_back(axes.at(path[i].T.translation().x(), path[i].T.translation()[v]));
  }
  draw_line(canvas, line, colour, thickness);
}

/// Along x, and along v: y or z.
void draw_plane(cv::Mat& canvas, const OverviewContent& content, const cv::Rect& area, int v) {
  Eigen::Vector3d low = content.estimate.front().T.translation(), high = low;
  for (const Trajectory* path : {&content.estimate, &content.truth}) {
    for (const StampedPose& pose : *path) {
      low = low.cwiseMin(pose.T.translation());
      high = high.cwiseMax(pose.T.translation());
    }
  }
  const double extent = std::max(1.1 * (high - low).maxCoeff(), 0.01);
  const Eigen::Vector3d corner = 0.5 * (low + high) - Eigen::Vector3d::Constant(0.5 * extent);
  const Axes axes{area, {corner.x(), corner[v]}, {extent, extent}};
  draw_axes(canvas, axes, "x [m]", fmt::format("{} [m]", "xyz"[v]));
  draw_path(canvas, axes, v, content, false);
  draw_path(canvas, axes, v, content, true);
  const Eigen::Vector3d& start = content.estimate.front().T.translation();
  cv::circle(canvas, axes.at(start.x(), start[v]), 5, kEstimate, cv::FILLED, cv::LINE_AA);
}

void shade_status(cv::Mat& canvas, const OverviewContent& content, const Axes& axes, Timestamp origin) {
  for (std::size_t i = 0; i < content.changes.size(); ++i) {
    const TrackingStatus status = content.changes[i].status;
    if (status == TrackingStatus::Good) continue;
    const Timestamp until = i + 1 < content.changes.size() ? content.changes[i + 1].t : content.end;
    const cv::Point2d from = axes.at(to_seconds(content.changes[i].t - origin), axes.low.y() + axes.size.y());
    const cv::Point2d to = axes.at(to_seconds(until - origin), axes.low.y());
    const cv::Scalar& colour = status == TrackingStatus::Lost       ? kLostTime
                               : status == TrackingStatus::Degraded ? kNotSure
                                                                    : kNotYet;
    cv::rectangle(canvas, from, to, colour, cv::FILLED);
  }
}

/// A covered lens, or the dark.
bool shows_nothing(const cv::Mat& frame) {
  constexpr double kLeastContrast = 4.0;  // grey levels
  cv::Scalar mean, deviation;
  cv::meanStdDev(frame, mean, deviation);
  return deviation[0] < kLeastContrast;
}

/// In mm below 10 cm.
void draw_error(cv::Mat& canvas, const OverviewContent& content, const cv::Rect& area) {
  double most = 0.0;
  for (const double error : content.error_m) most = std::isfinite(error) ? std::max(most, error) : most;
  const bool small = most < 0.1;
  const double unit = small ? 1e3 : 1.0;
  const Timestamp origin = content.changes.empty() ? content.estimate.front().t : content.changes.front().t;
  const double end_s = std::max(to_seconds(std::max(content.end, content.estimate.back().t) - origin), 0.1);
  const bool compared = !content.error_m.empty();
  const Axes axes{area, {0.0, 0.0}, {end_s, std::max(1.1 * unit * most, 1e-3)}, compared};
  shade_status(canvas, content, axes, origin);
  const std::string what = compared ? fmt::format("position error [{}]", small ? "mm" : "m") : "no ground truth";
  draw_axes(canvas, axes, "time [s]", what + "; shaded: yellow degraded, red lost, grey not started");
  std::vector<cv::Point2d> line;
  for (std::size_t i = 0; i < content.error_m.size(); ++i) {
    const bool known = std::isfinite(content.error_m[i]);
    if (!known || begins_anew(content, content.estimate, i)) draw_line(canvas, std::exchange(line, {}), kEstimate, 1);
    if (known) line.push_back(axes.at(to_seconds(content.estimate[i].t - origin), unit * content.error_m[i]));
  }
  draw_line(canvas, line, kEstimate, 1);
}

void draw_legend(cv::Mat& canvas, const OverviewContent& content, cv::Point at) {
  cv::line(canvas, at, at + cv::Point(26, 0), kEstimate, 3, cv::LINE_AA);
  put_text(canvas, "estimate, from the dot on", at + cv::Point(34, 4));
  if (content.truth.empty()) return;
  cv::line(canvas, at + cv::Point(250, 0), at + cv::Point(276, 0), kTruth, 1, cv::LINE_AA);
  put_text(canvas, "ground truth", at + cv::Point(284, 4));
}

/// Returns its height.
int draw_image(cv::Mat& canvas, const cv::Mat& image, const std::string& caption, cv::Point at, int height) {
  put_text(canvas, caption, at + cv::Point(0, -6), 0.42);
  const double scale =
      std::min(static_cast<double>(kImageWidth) / image.cols, static_cast<double>(height) / image.rows);
  cv::Mat colour, sized;
  cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
  cv::resize(colour, sized, {}, scale, scale, scale > 1.0 ? cv::INTER_CUBIC : cv::INTER_AREA);
  sized.copyTo(canvas(cv::Rect(at, sized.size())));
  return sized.rows;
}

class OverviewFile : public RunObserver {
 public:
  explicit OverviewFile(const RunContext& run) : run_(run) {}
  void on_step(const Step& step) override { moment_.consider(step); }
  void on_end(const RunEnd& end) override {
    write_picture(run_.folder / "overview.png", draw_overview(content_of(end)));
  }

 private:
  OverviewContent content_of(const RunEnd& end) const {
    const ReportPath& path = end.path;
    OverviewContent content;
    content.title = fmt::format("{}, {}", end.summary.recording, end.summary.mode);
    if (!end.summary.verdict.plain()) content.wrong = end.summary.verdict.text;
    content.moment = moment_;
    content.changes = run_.album.changes();
    content.end = run_.album.last();
    const Duration clock =
        path.body.empty() ? Duration(0) : path.shown.front().t - path.body.front().t;  // that sensor's
    for (StatusChange& change : content.changes) change.t += clock;
    content.estimate = path.shown;
    content.truth = path.true_path;
    if (path.evaluation) {
      const Evaluation& e = *path.evaluation;
      content.title += fmt::format(": ATE {:.1f} mm over {:.1f} m", 1e3 * e.ate_m.rmse, e.path_length_m);
      content.error_m = path.error_m;
    }
    return content;
  }

  const RunContext& run_;
  LiveliestMoment moment_;
};

}  // namespace

void LiveliestMoment::consider(const Step& step) {
  const KindNumbers events = numbers_of(step, Modality::Events);
  const auto image_of = [&step](Modality modality) {
    const CameraStep* camera = step.find(modality);
    return camera ? camera->image : cv::Mat();
  };
  const cv::Mat event_frame = image_of(Modality::Events), frame = image_of(Modality::Frames);
  const double age_s = last_ ? to_seconds(step.t - *last_) : 0.0;
  usual_rate_hz_ += (last_ ? 1.0 - std::exp(-age_s) : 1.0) * (events.event_rate_hz - usual_rate_hz_);
  last_ = step.t;
  if (events.event_rate_hz > 4.0 * usual_rate_hz_) return;  // a flash or a burst of noise
  if (!frame_.empty() && frame.empty()) return;  // a moment with both images is preferred to one with events alone
  if (event_frame.empty() && frame.empty()) return;
  const double liveliness =
      event_frame.empty() ? static_cast<double>(numbers_of(step, Modality::Frames).tracks) : events.event_rate_hz;
  const bool good = step.status == TrackingStatus::Good && (frame.empty() || !shows_nothing(frame));
  const double score = good ? 1.0 + liveliness : -1.0 / (1.0 + liveliness);
  const bool first_frame = frame_.empty() && !frame.empty();
  if (score <= score_ && !first_frame) return;
  score_ = score;
  if (!frame.empty()) frame_ = frame.clone();
  event_frame_ = event_frame.clone();
}

cv::Mat draw_overview(const OverviewContent& content) {
  std::vector<std::pair<const cv::Mat*, const char*>> images;
  if (!content.moment.frame().empty()) images.emplace_back(&content.moment.frame(), "standard frame");
  if (!content.moment.event_frame().empty()) {
    images.emplace_back(&content.moment.event_frame(), "events of the same moment, motion-compensated");
  }
  constexpr int kPlots = 2 * (kAxisLeft + kPlaneSize) + kMargin;
  const int plot_x = images.empty() ? kMargin : 2 * kMargin + kImageWidth;
  constexpr int kPlotY = kTitleHeight + 40, kCurveY = kPlotY + kPlaneSize + kAxisBelow + 32;
  constexpr int kHeight = kCurveY + kCurveHeight + kAxisBelow + kMargin / 2;
  cv::Mat canvas(kHeight, plot_x + kPlots + kMargin, CV_8UC3, kPaper);
  put_text(canvas, content.title, cv::Point(kMargin, 28), 0.55);
  const double wrong_size =
      std::min(0.5, 0.5 * (canvas.cols - 2 * kMargin) / std::max(1, text_width(content.wrong, 0.5)));
  put_text(canvas, content.wrong, cv::Point(kMargin, 54), std::max(0.35, wrong_size), kWrong);
  constexpr int kCaption = 18, kImageHeight = (kHeight - kTitleHeight) / 2 - kCaption - kMargin;
  int image_y = kTitleHeight + kCaption;
  for (const auto& [image, caption] : images) {
    image_y += draw_image(canvas, *image, caption, cv::Point(kMargin, image_y), kImageHeight) + kCaption + kMargin;
  }
  const int first_x = plot_x + kAxisLeft, second_x = first_x + kPlaneSize + kMargin + kAxisLeft;
  if (content.estimate.empty()) {
    put_text(canvas, "no pose was estimated", cv::Point(first_x, kPlotY), 0.5, kWrong);
    return images.empty() ? canvas.rowRange(0, kPlotY + kAxisBelow) : canvas;
  }
  draw_legend(canvas, content, cv::Point(first_x, kTitleHeight + 6));
  draw_plane(canvas, content, cv::Rect(first_x, kPlotY, kPlaneSize, kPlaneSize), 1);
  draw_plane(canvas, content, cv::Rect(second_x, kPlotY, kPlaneSize, kPlaneSize), 2);
  const int curve_x = images.size() < 2 ? kMargin + kAxisLeft : first_x;  // also below a single image
  draw_error(canvas, content, cv::Rect(curve_x, kCurveY, second_x + kPlaneSize - curve_x, kCurveHeight));
  return canvas;
}

std::unique_ptr<RunObserver> observe_overview(RunContext& run) { return std::make_unique<OverviewFile>(run); }

}  // namespace edged
