// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/depth/network_depth.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"
#include "edged/depth/tuning.hpp"
#include "edged/events/voxel_grid.hpp"

namespace edged {
namespace {

DepthFilterConfig with_time_constant(DepthFilterConfig filter, double time_constant_s) {
  filter.time_constant_s = time_constant_s;
  return filter;
}

}  // namespace

void NetworkDepthConfig::visit(ConfigFields& fields) {
  fields.add("model", model, {.effect = "Name of a network in config/depth, or path of an .onnx file."});
  fields.add("margin_px", margin_px, {"px", 0, 4096, "The network's input exceeds the region by this on each side."});
  fields.choice("region_value", region_value, {{"median", RegionValue::Median}, {"mean", RegionValue::Mean}},
                {.effect = "Depth of the region: median of its pixels, or mean as in the paper."});
  fields.add("time_constant_s", time_constant_s,
             {"s", 0, 60,
              "Time constant of the low-pass filter of the network's ln depth, in place of filter.time_constant_s."});
}

NetworkDepth::NetworkDepth(const CameraModel& camera, double region_share, const NetworkDepthConfig& config,
                           const DepthFilterConfig& filter, Inference inference)
    : config_(config),
      network_(find_depth_model(config.model)),
      window_(duration_from_seconds(network_.model().window_s)),
      filter_(with_time_constant(filter, config.time_constant_s)) {
  const cv::Size image(camera.width(), camera.height());
  const cv::Rect region = central_region(image, region_share);
  seen_ = grown_region(region, config.margin_px, image);
  region_ = region - seen_.tl();
  const int least = network_.model().shrink * network_.model().multiple;
  if (seen_.width < least || seen_.height < least)
    throw InputError::format(
        "option 'network.margin_px' leaves {} x {} pixels to the depth network, which needs {} x {}", seen_.width,
        seen_.height, least, least);
  if (network_.model().focal_px > 0.0) scale_ = camera.mean_focal() / network_.model().focal_px;
  if (inference == Inference::OwnThread)
    thread_.emplace([this](const std::vector<Event>& window) { return measure(window); });
}

void NetworkDepth::add_events(std::span<const Event> events) {
  for (const Event& event : events) {
    if (!events_.empty() && event.t < events_.back().t) continue;
    if (!events_.empty() && event.t - events_.front().t >= window_) end_window();
    events_.push_back(event);
  }
  if (!thread_) return;
  for (const DepthEstimate& measured : thread_->take()) take(measured);
}

void NetworkDepth::end_window() {
  std::vector<Event> window = std::exchange(events_, {});
  if (thread_) return thread_->put(std::move(window));
  if (const auto measured = measure(window)) take(*measured);
}

void NetworkDepth::finish() {
  if (!thread_) return;
  thread_->finish();
  for (const DepthEstimate& measured : thread_->take()) take(measured);
}

void NetworkDepth::take(const DepthEstimate& measured) {
  ++inferences_;
  measured_ = measured;
  filter_.add(measured);
}

std::optional<DepthEstimate> NetworkDepth::measure(const std::vector<Event>& window) {
  if (seen_until_ && window.front().t - *seen_until_ > kSceneDepthTuning.memory) network_.reset();
  seen_until_ = window.back().t;
  const auto is_seen = [this](const Event& event) { return seen_.contains(cv::Point(event.x, event.y)); };
  if (static_cast<double>(std::count_if(window.begin(), window.end(), is_seen)) <
      kSceneDepthTuning.min_events_per_pixel * seen_.area())
    return std::nullopt;
  cv::Mat grid = voxel_grid(window, seen_, network_.model().bins);
  normalise_voxels(grid);
  const cv::Mat depth = network_.infer(grid)(region_);
  std::vector<double> logs;
  logs.reserve(depth.total());
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) logs.push_back(std::log(scale_ * static_cast<double>(depth.at<float>(y, x))));
  const double middle = median(logs);
  const double value = config_.region_value == RegionValue::Mean ? scale_ * cv::mean(depth)[0] : std::exp(middle);
  return DepthEstimate{window.back().t, value, network_.model().sigma_ln, robust_deviation(logs, middle)};
}

}  // namespace edged
