// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/dense/dense_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>
#include <utility>

#include "edged/camera/binning.hpp"
#include "edged/camera/undistort.hpp"

namespace edged {
namespace {

constexpr std::size_t kFewestLandmarks = 8;
constexpr std::size_t kFewestViews = 4;
constexpr double kLensMoved_px = 0.05;

bool is_finite(const SE3& T) { return T.translation().allFinite() && T.rotation().coeffs().allFinite(); }

double baseline(const SE3& a, const SE3& b) { return (a.translation() - b.translation()).norm(); }

double turn(const SE3& a, const SE3& b) { return a.rotation().angularDistance(b.rotation()); }

/// Whether any of nine pixels has left its place.
bool has_moved(const CameraModel& before, const CameraModel& now) {
  for (const double x : {0.0, 0.5, 1.0}) {
    for (const double y : {0.0, 0.5, 1.0}) {
      const Eigen::Vector2d pixel(x * (now.width() - 1), y * (now.height() - 1));
      if ((before.distort_to_pixel(now.pixel_to_point(pixel)) - pixel).norm() > kLensMoved_px) return true;
    }
  }
  return false;
}

/// Means of n x n pixels.
cv::Mat binned(const cv::Mat& image, int n) {
  if (n == 1) return image;
  const cv::Size size(image.cols / n, image.rows / n);
  cv::Mat coarse;
  cv::resize(image(cv::Rect(cv::Point(), size * n)), coarse, size, 0.0, 0.0, cv::INTER_AREA);
  return coarse;
}

/// Depths of the landmarks that the camera shows: their median, and a range with room on both sides.
struct SceneDepths {
  double median;
  InverseDepthRange range;
};

SceneDepths depths_of(const DenseInstant& instant, const DenseView& view) {
  const SE3 T_C_O = view.T_O_C.inverse();
  std::vector<double> depths;
  for (const Eigen::Vector3d& p_O : instant.landmarks_O) {
    const Eigen::Vector3d p_C = T_C_O * p_O;
    const auto pixel = view.pinhole.project(p_C);
    if (pixel && view.pinhole.contains(*pixel)) depths.push_back(p_C.z());
  }
  if (depths.size() < kFewestLandmarks)
    return {instant.scene_depth, {0.2 / instant.scene_depth, 4.0 / instant.scene_depth}};
  std::ranges::sort(depths);
  const auto at = [&](double share) {
    return depths[static_cast<std::size_t>(share * static_cast<double>(depths.size() - 1))];
  };
  return {at(0.5), {0.4 / at(0.95), 1.7 / at(0.05)}};
}

}  // namespace

void DenseMapper::add(DenseInstant instant) {
  if (instant.restart) {
    finish();
    poses_ = {};
    views_.clear();
  }
  if (instant.keyframe) poses_.add_keyframe({instant.t, instant.T_O_B});
  for (const StampedPose& pose : instant.refined) poses_.refine(pose);
  const Timestamp now = instant.t;
  if (instant.scene_depth > 0.0 && is_finite(instant.T_O_B)) {
    std::erase_if(instant.images,
                  [](const DenseImage& image) { return image.image.empty() || !is_finite(image.T_B_C); });
    for (const Modality modality : {Modality::Events, Modality::Frames}) {
      const DenseModality& config = modality == Modality::Events ? config_.events : config_.frames;
      if (!keep(instant, modality, views_.try_emplace(modality, Views{config, {}}).first->second))
        std::erase_if(instant.images, [&](const DenseImage& image) { return image.modality == modality; });
    }
    if (!instant.images.empty()) delayed_.push_back(std::move(instant));
  }
  while (!delayed_.empty() &&
         (poses_.known_until() >= delayed_.front().t || to_seconds(now - delayed_.front().t) > config_.most_delay_s)) {
    release(std::move(delayed_.front()));
    delayed_.pop_front();
  }
}

void DenseMapper::finish() {
  for (DenseInstant& instant : delayed_) release(std::move(instant));
  delayed_.clear();
  for (auto& [modality, views] : views_) {
    for (const Reference& reference : views.waiting) measure(reference, views);
    views.waiting.clear();
  }
}

/// Whether the images of a modality are worth to be kept: of keyframes, and of places that are new.
bool DenseMapper::keep(const DenseInstant& instant, Modality modality, Views& views) const {
  if (std::ranges::count(instant.images, modality, &DenseImage::modality) == 0) return false;
  const bool moved =
      !views.last_kept || baseline(*views.last_kept, instant.T_O_B) > config_.view_spacing * instant.scene_depth;
  if (moved) views.last_kept = instant.T_O_B;
  return moved || instant.keyframe;
}

void DenseMapper::release(DenseInstant instant) {
  instant.T_O_B = poses_({instant.t, instant.T_O_B});
  for (auto& [modality, views] : views_) {
    bool first = true;
    for (const DenseImage& image : instant.images) {
      if (image.modality != modality) continue;
      add_image(instant, image, first, views);
      first = false;
    }
    while (!views.waiting.empty() && is_complete(views.waiting.front(), views, instant.t)) {
      measure(views.waiting.front(), views);
      views.waiting.pop_front();
    }
    while (views.all.size() > config_.kept_views) views.all.pop_front();
  }
}

/// first: only one camera of the rig has references. The others are one more view of the same instant.
void DenseMapper::add_image(const DenseInstant& instant, const DenseImage& image, bool first, Views& views) {
  DenseView view = view_of(instant, image, views.config.edges);
  const auto before = std::ranges::find(views.all.rbegin(), views.all.rend(), image.camera, &DenseView::camera);
  if (before != views.all.rend()) {
    const Eigen::Vector2d middle(0.5 * view.pinhole.width(), 0.5 * view.pinhole.height());
    const Eigen::Vector3d p_C = instant.scene_depth * view.pinhole.pixel_to_point(middle).homogeneous();
    if (const auto earlier = view.pinhole.project(before->T_O_C.inverse() * (view.T_O_C * p_C)))
      view.flow = middle - *earlier;
  }
  if (first && instant.keyframe &&
      (!views.last_reference ||
       baseline(*views.last_reference, view.T_O_C) > config_.reference_spacing * instant.scene_depth ||
       turn(*views.last_reference, view.T_O_C) > config_.reference_turn_rad)) {
    const SceneDepths depths = depths_of(instant, view);
    views.waiting.push_back({view, depths.range, depths.median});
    views.last_reference = view.T_O_C;
  }
  views.all.push_back(std::move(view));
}

DenseView DenseMapper::view_of(const DenseInstant& instant, const DenseImage& image, const EdgeConfig& edges) {
  Camera& camera = cameras_[image.camera];
  if (camera.given != image.model) {
    camera.given = image.model;
    camera.bin = bin_for(image.model.width(), config_.widest_px);
    camera.lens = binned(image.model, camera.bin);
  }
  if (camera.pinhole.width() == 0) camera.pinhole = ideal_pinhole(camera.lens);
  const bool as_it_is = camera.lens == camera.pinhole;
  if (!as_it_is && (!camera.rectifier || has_moved(camera.rectifier->lens(), camera.lens)))
    camera.rectifier.emplace(camera.lens, camera.pinhole);
  const cv::Mat coarse = binned(image.image, camera.bin);
  const cv::Mat rectified = as_it_is ? coarse : (*camera.rectifier)(coarse);
  return {instant.t,
          image.camera,
          image.modality,
          camera.pinhole,
          instant.T_O_B * image.T_B_C,
          rectified,
          smoothed(rectified, edges)};
}

bool DenseMapper::is_complete(const Reference& reference, const Views& views, Timestamp now) const {
  if (to_seconds(now - reference.view.t) > config_.most_wait_s) return true;
  const std::size_t after = static_cast<std::size_t>(
      std::ranges::count_if(views.all, [&](const DenseView& view) { return view.t > reference.view.t; }));
  return 2 * after >= views.all.size() && after >= views.config.views / 2 &&
         baseline(views.all.back().T_O_C, reference.view.T_O_C) > 0.5 * config_.most_baseline * reference.depth;
}

std::vector<const DenseView*> DenseMapper::views_for(const Reference& reference, const Views& views) const {
  std::vector<std::pair<double, const DenseView*>> all;
  for (const DenseView& view : views.all) {
    const double away = baseline(view.T_O_C, reference.view.T_O_C) / reference.depth;
    const bool moves_alike = view.flow.dot(reference.view.flow) >=
                             views.config.least_flow_cos * view.flow.norm() * reference.view.flow.norm();
    if (moves_alike && away >= config_.least_baseline && away <= config_.most_baseline &&
        turn(view.T_O_C, reference.view.T_O_C) <= config_.most_turn_rad)
      all.emplace_back(away, &view);
  }
  std::ranges::stable_sort(all, {}, [](const auto& view) { return view.first; });
  std::vector<const DenseView*> chosen;
  const std::size_t count = std::min(views.config.views, all.size());
  for (std::size_t i = 0; i < count; ++i)
    chosen.push_back(all[count == 1 ? 0 : i * (all.size() - 1) / (count - 1)].second);
  return chosen;
}

void DenseMapper::measure(const Reference& reference, Views& views) {
  const std::vector<const DenseView*> chosen = views_for(reference, views);
  if (chosen.size() < kFewestViews) {
    ++counters_.unmeasured;
    return;
  }
  DepthMap map = estimate_depth(reference.view, chosen, reference.range, views.config.search, views.config.edges);
  cull(map, config_.cull);
  ++counters_.keyframes;
  counters_.edges += map.edges;
  counters_.with_depth += map.points.size();
  for (const std::size_t older : views.latest) {
    points_ -= maps_[older].points.size();
    fuse(maps_[older], map, config_.cull);
    points_ += maps_[older].points.size();
  }
  points_ += map.points.size();
  views.latest.push_back(maps_.size());
  if (views.latest.size() > config_.fused_keyframes) views.latest.erase(views.latest.begin());
  maps_.push_back(std::move(map));
  while (points_ > config_.most_points) thin_out();
}

void DenseMapper::thin_out() {
  points_ = 0;
  for (DepthMap& map : maps_) {
    std::size_t number = 0;
    std::erase_if(map.points, [&](const DensePoint&) { return number++ % 2 == 1; });
    points_ += map.points.size();
  }
}

}  // namespace edged
