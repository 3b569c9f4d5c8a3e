// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Lens models against the formulas of their papers, and where they end.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "edged/camera/lens_table.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/rig.hpp"

namespace edged {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// The projection as published, of a point in space.
using Projection = Vector2d (*)(const LensCoefficients& k, const Vector3d& p);

Vector2d project_fov(const LensCoefficients& k, const Vector3d& p) {
  const double r = p.head<2>().norm() / p.z();
  return std::atan(2.0 * r * std::tan(0.5 * k[0])) / (k[0] * r) * p.head<2>() / p.z();
}

Vector2d project_omni(const LensCoefficients& k, const Vector3d& p) {
  const Vector2d m = p.head<2>() / (p.z() + k[0] * p.norm());
  const double r2 = m.squaredNorm(), x = m.x(), y = m.y();
  return (1.0 + k[1] * r2 + k[2] * r2 * r2) * m +
         Vector2d(2.0 * k[3] * x * y + k[4] * (r2 + 2.0 * x * x), k[3] * (r2 + 2.0 * y * y) + 2.0 * k[4] * x * y);
}

Vector2d project_omni_equidistant(const LensCoefficients& k, const Vector3d& p) {
  const Vector2d m = p.head<2>() / (p.z() + k[0] * p.norm());
  const double theta = std::atan(m.norm()), t2 = theta * theta;
  return theta * (1.0 + t2 * (k[1] + t2 * (k[2] + t2 * (k[3] + t2 * k[4])))) / m.norm() * m;
}

Vector2d project_double_sphere(const LensCoefficients& k, const Vector3d& p) {
  const double d1 = p.norm(), z = k[0] * d1 + p.z(), d2 = std::sqrt(p.head<2>().squaredNorm() + z * z);
  return p.head<2>() / (k[1] * d2 + (1.0 - k[1]) * z);
}

Vector2d project_extended_unified(const LensCoefficients& k, const Vector3d& p) {
  const double d = std::sqrt(k[1] * p.head<2>().squaredNorm() + p.z() * p.z());
  return p.head<2>() / (k[0] * d + (1.0 - k[0]) * p.z());
}

struct WideLens {
  DistortionModel model;
  LensCoefficients k;
  Projection projection;
};

const std::vector<WideLens>& wide_lenses() {
  static const std::vector<WideLens> lenses{
      {DistortionModel::FieldOfView, {0.95}, project_fov},
      {DistortionModel::Omni, {1.1, -0.05, 0.01, 3e-3, -2e-3}, project_omni},
      {DistortionModel::OmniEquidistant, {1.1, 0.05, -0.02, 0.01, -0.002}, project_omni_equidistant},
      {DistortionModel::DoubleSphere, {-0.2, 0.6}, project_double_sphere},
      {DistortionModel::ExtendedUnified, {0.65, 1.05}, project_extended_unified},
  };
  return lenses;
}

/// Sees more than 180 degrees across.
CameraModel wide_camera(const WideLens& lens) {
  constexpr double kFocal = 150.0;  // [px] near the axis
  const double on_axis = distorted(lens_model(lens.model), lens.k, Vector2d::Zero()).d_point(0, 0);
  return {640, 480, kFocal / on_axis, kFocal / on_axis, 318.0, 243.0, lens.model, lens.k};
}

TEST(LensModels, ProjectAsPublished) {
  for (const WideLens& lens : wide_lenses()) {
    const CameraModel camera = wide_camera(lens);
    for (double x = -1.6; x < 1.7; x += 0.4)
      for (double y = -1.5; y < 1.7; y += 0.5) {
        const Vector3d p = 2.5 * Vector3d(x, y, 1.0);
        const Vector2d d = lens.projection(lens.k, p);
        const auto pixel = camera.project(p);
        ASSERT_TRUE(pixel) << to_string(lens.model);
        EXPECT_LT((*pixel - Vector2d(camera.fx() * d.x() + 318.0, camera.fy() * d.y() + 243.0)).norm(), 1e-9)
            << to_string(lens.model);
      }
  }
}

TEST(LensModels, ThatSeeBehindThemselvesAreUsedUpTo70DegreesAndHaveRaysBeyond) {
  for (const WideLens& lens : wide_lenses()) {
    const CameraModel camera = wide_camera(lens);
    ASSERT_TRUE(camera.view_limit()) << to_string(lens.model);
    EXPECT_NEAR(*camera.view_limit(), 70.0 * kDegree, 1e-12);
    EXPECT_FALSE(camera.contains({0.0, 0.0}));
    for (const Vector2d& pixel : {Vector2d(70, 240), Vector2d(318, 243), Vector2d(400, 300), Vector2d(540, 120)}) {
      const Vector3d ray = camera.pixel_to_ray(pixel);
      EXPECT_NEAR(ray.norm(), 1.0, 1e-12);
      if (lens.model == DistortionModel::FieldOfView && ray.z() < 0.0) continue;  // published up to 90 degrees
      const Vector2d d = ray.head<2>().isZero() ? Vector2d::Zero() : lens.projection(lens.k, ray);
      EXPECT_LT((Vector2d(camera.fx() * d.x() + 318.0, camera.fy() * d.y() + 243.0) - pixel).norm(), 1e-6)
          << to_string(lens.model) << " " << pixel.transpose();
    }
  }
}

/// Angle off the axis where a lens begins not to grow, or to jump.
double end_of(DistortionModel model, const LensCoefficients& k) {
  const LensModel& lens = lens_model(model);
  double theta = 0.0, reached = 0.0;
  for (; theta < 3.14; theta += 1e-4) {
    const ValueAndSlope at = lens.radius_of_angle(k, theta);
    if (!(at.slope > 0.0 && at.value >= reached)) break;
    reached = at.value;
  }
  return theta;
}

/// The ray is tangent to the sphere, or (with a small xi or alpha) parallel to the image plane.
TEST(LensModels, EndWhereTheirProjectionDoes) {
  EXPECT_NEAR(end_of(DistortionModel::Omni, {0.5}), std::acos(-0.5), 2e-4);
  EXPECT_NEAR(end_of(DistortionModel::Omni, {2.5}), std::acos(-1.0 / 2.5), 2e-4);
  for (const double alpha : {0.4, 0.6, 0.7}) {
    const double w = alpha > 0.5 ? (1.0 - alpha) / alpha : alpha / (1.0 - alpha);
    for (const double xi : {-0.2, 0.3}) {
      const double end = end_of(DistortionModel::DoubleSphere, {xi, alpha}), z = xi + std::cos(end);
      EXPECT_NEAR(z, -w * std::hypot(std::sin(end), z), 2e-4) << xi << " " << alpha;
    }
    for (const double beta : {0.9, 1.2}) {
      const double end = end_of(DistortionModel::ExtendedUnified, {alpha, beta});
      EXPECT_NEAR(std::cos(end), -w * std::hypot(std::sqrt(beta) * std::sin(end), std::cos(end)), 2e-4)
          << alpha << " " << beta;
    }
  }
}

TEST(LensModels, WithoutAnInverseAreRefused) {
  const auto refused = [](DistortionModel model, const LensCoefficients& k) {
    try {
      CameraModel(640, 480, 300, 300, 320, 240, model, k);
    } catch (const InputError&) {
      return true;
    }
    return false;
  };
  EXPECT_TRUE(refused(DistortionModel::Omni, {-1.0}));
  EXPECT_TRUE(refused(DistortionModel::Omni, {-1.5}));
  EXPECT_TRUE(refused(DistortionModel::DoubleSphere, {-1.0, 0.5}));
  EXPECT_TRUE(refused(DistortionModel::ExtendedUnified, {0.6, -20.0}));
  EXPECT_TRUE(refused(DistortionModel::FieldOfView, {4.0}));
  EXPECT_TRUE(refused(DistortionModel::Rational, {0, 0, 0, 0, 0, 2.0, 0, 0}));
}

/// The second camera of UZH-FPV's outdoor_45: its polynomial turns back 82 degrees off the axis, its corners lie
/// beyond.
TEST(LensModels, APolynomialThatTurnsBackNearTheCornersIsUsedWhereItIsMonotone) {
  const CameraModel camera(640, 480, 273.2895, 273.3583, 314.6056, 251.036, DistortionModel::Equidistant,
                           {0.027860492621377443, -0.027723581962855317, 0.0375199775145906, -0.018152613898714216});
  ASSERT_TRUE(camera.view_limit());
  EXPECT_NEAR(*camera.view_limit() / kDegree, 79.6, 0.5);
  EXPECT_FALSE(camera.contains({0.0, 0.0}));
  for (const Vector2d& pixel : {Vector2d(5, 251), Vector2d(630, 251), Vector2d(315, 5), Vector2d(40, 60)}) {
    EXPECT_TRUE(camera.contains(pixel)) << pixel.transpose();
    EXPECT_LT((camera.distort_to_pixel(camera.pixel_to_point(pixel)) - pixel).norm(), 1e-6);
  }
  EXPECT_FALSE(camera.project({10.0, 0.0, 1.0}));
}

}  // namespace
}  // namespace edged
