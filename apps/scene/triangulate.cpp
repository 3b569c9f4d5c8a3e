// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Images of a reconstruction with their poses, and points from the observations of their features.
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <optional>

#include "scene/reconstruction.hpp"

namespace edged {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Seen = Reconstruction::Seen;

constexpr double kFarthest_px = 2.0;     // of an observation from its point
constexpr double kMostDepthError = 0.1;  // one sigma over depth
constexpr int kIterations = 8;

const Reconstruction::Observation& observation_of(const Reconstruction& model, const Seen& seen) {
  return model.images[seen.image].observations[seen.observation];
}

/// Residual [px] of an observation and its derivative by the point.
struct Row {
  Vector2d r;
  Eigen::Matrix<double, 2, 3> J;
};

std::optional<Row> row_of(const Reconstruction& model, const Seen& seen, const Vector3d& p_W) {
  const Reconstruction::Image& image = model.images[seen.image];
  const CameraModel& pinhole = model.cameras[image.camera].pinhole;
  const SE3 T_C_W = image.T_W_C.inverse();
  const Vector3d p_C = T_C_W * p_W;
  if (p_C.z() < 1e-3) return std::nullopt;
  Eigen::Matrix<double, 2, 3> by_p_C;
  by_p_C << pinhole.fx() / p_C.z(), 0.0, -pinhole.fx() * p_C.x() / (p_C.z() * p_C.z()),  //
      0.0, pinhole.fy() / p_C.z(), -pinhole.fy() * p_C.y() / (p_C.z() * p_C.z());
  const Vector2d expected = pinhole.distort_to_pixel(p_C.hnormalized());
  return Row{expected - observation_of(model, seen).pixel, by_p_C * T_C_W.R()};
}

/// The point nearest to all rays.
std::optional<Vector3d> nearest_to_rays(const Reconstruction& model, const std::vector<Seen>& all) {
  Matrix3d A = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  for (const Seen& seen : all) {
    const Reconstruction::Image& image = model.images[seen.image];
    const Vector2d point = model.cameras[image.camera].pinhole.pixel_to_point(observation_of(model, seen).pixel);
    const Vector3d ray = (image.T_W_C.rotation() * point.homogeneous()).normalized();
    const Matrix3d across = Matrix3d::Identity() - ray * ray.transpose();
    A += across;
    b += across * image.T_W_C.translation();
  }
  const Vector3d p_W = A.ldlt().solve(b);
  return p_W.allFinite() ? std::optional(p_W) : std::nullopt;
}

/// Least squares over the reprojection errors; nothing where a ray lies behind or the depth is poor.
std::optional<Reconstruction::Point> fitted(const Reconstruction& model, const std::vector<Seen>& all) {
  const std::optional<Vector3d> first = nearest_to_rays(model, all);
  if (!first) return std::nullopt;
  Reconstruction::Point point{.p_W = *first, .seen = all};
  for (int i = 0; i <= kIterations; ++i) {
    Matrix3d H = Matrix3d::Zero();
    Vector3d g = Vector3d::Zero();
    for (const Seen& seen : all) {
      const std::optional<Row> row = row_of(model, seen, point.p_W);
      if (!row) return std::nullopt;
      H += row->J.transpose() * row->J;
      g += row->J.transpose() * row->r;
    }
    point.covariance = H.inverse();
    if (i < kIterations) point.p_W -= H.ldlt().solve(g);
  }
  const Vector3d ray = model.images[all.front().image].T_W_C.translation() - point.p_W;
  const double depth_error = std::sqrt(ray.normalized().dot(point.covariance * ray.normalized()));
  return depth_error < kMostDepthError * ray.norm() ? std::optional(point) : std::nullopt;
}

double error_of(const Reconstruction& model, const Seen& seen, const Vector3d& p_W) {
  const std::optional<Row> row = row_of(model, seen, p_W);
  return row ? row->r.norm() : 2.0 * kFarthest_px;
}

/// Without the observations that are far off: the worst one after another.
std::optional<Reconstruction::Point> agreed(const Reconstruction& model, std::vector<Seen> all) {
  while (all.size() >= 2) {
    std::optional<Reconstruction::Point> point = fitted(model, all);
    if (!point) return std::nullopt;
    std::vector<double> errors;
    for (const Seen& seen : all) errors.push_back(error_of(model, seen, point->p_W));
    const auto worst = std::ranges::max_element(errors);
    if (*worst > kFarthest_px) {
      all.erase(all.begin() + (worst - errors.begin()));
      continue;
    }
    for (const double error : errors) point->error_px += error / static_cast<double>(errors.size());
    for (const Seen& seen : all)
      point->towards_cameras += (model.images[seen.image].T_W_C.translation() - point->p_W).normalized();
    point->towards_cameras.normalize();
    point->grey = observation_of(model, all.front()).grey;
    return point;
  }
  return std::nullopt;
}

}  // namespace

std::vector<Reconstruction::Observation> observations_of(const std::vector<Track>& tracks, const CameraModel& pinhole) {
  std::vector<Reconstruction::Observation> observations;
  for (const Track& track : tracks) {
    const Vector2d pixel = pinhole.distort_to_pixel(track.point);
    if (pinhole.contains(pixel)) observations.push_back({.feature = track.id, .pixel = pixel});
  }
  return observations;
}

void add_images(Reconstruction& model, const Step& step) {
  for (std::size_t camera = 0; camera < model.cameras.size(); ++camera) {
    const CameraStep* seen = step.find(model.cameras[camera].name);
    if (!seen || seen->image.empty()) continue;
    Reconstruction::Image& image = model.images.emplace_back();
    image.t = step.t;
    image.camera = camera;
    image.observations = observations_of(seen->tracks, model.cameras[camera].pinhole);
  }
}

void place(Reconstruction& model, const Trajectory& poses, const Rig& rig) {
  std::erase_if(model.images, [&](Reconstruction::Image& image) {
    const auto pose = std::ranges::lower_bound(poses, image.t, {}, &StampedPose::t);
    if (pose == poses.end() || pose->t != image.t) return true;
    image.T_W_C = pose->T * rig.camera(model.cameras[image.camera].name).T_B_C;
    return false;
  });
}

void triangulate(Reconstruction& model) {
  std::map<FeatureId, std::vector<Seen>> features;
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    for (std::size_t j = 0; j < model.images[i].observations.size(); ++j)
      features[model.images[i].observations[j].feature].push_back({i, j});
  }
  for (const auto& [id, all] : features) {
    std::optional<Reconstruction::Point> point = agreed(model, all);
    if (!point) continue;
    for (const Seen& seen : point->seen)
      model.images[seen.image].observations[seen.observation].point = model.points.size();
    model.points.push_back(std::move(*point));
  }
}

}  // namespace edged
