// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/two_view.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "edged/core/directions.hpp"

namespace edged {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMinDepth = 1e-6;  // [m]
constexpr int kMaxIterations = 20;

/// The point nearest to all rays (C6).
std::optional<Vector3d> nearest_point(std::span<const Ray> rays) {
  Matrix3d H = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  for (const Ray& ray : rays) {
    const Matrix3d across = Matrix3d::Identity() - ray.direction_A * ray.direction_A.transpose();
    H += across;
    b += across * ray.centre_A;
  }
  const Eigen::LDLT<Matrix3d> factor(H);
  const Vector3d p_A = factor.solve(b);
  if (factor.info() != Eigen::Success || !p_A.allFinite()) return std::nullopt;
  return p_A;
}

/// Sum of the squared unit-plane residuals and the Gauss-Newton system H step = b of it (C7).
struct Linearised {
  double squared_sum = 0.0;
  Matrix3d H = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
};

/// Nothing when the point is not in front of every view.
std::optional<Linearised> linearise(std::span<const Ray> rays, const Vector3d& p_A) {
  Linearised sum;
  for (const Ray& ray : rays) {
    const Vector3d p_C = ray.R_C_A * (p_A - ray.centre_A);
    if (!(p_C.z() > kMinDepth)) return std::nullopt;
    const double inverse_z = 1.0 / p_C.z();
    const Vector2d seen = p_C.head<2>() * inverse_z;
    const Vector2d residual = seen - ray.point;
    const Eigen::Matrix<double, 2, 3> J = inverse_z * (ray.R_C_A.topRows<2>() - seen * ray.R_C_A.bottomRows<1>());
    sum.squared_sum += residual.squaredNorm();
    sum.H += J.transpose() * J;
    sum.b -= J.transpose() * residual;
  }
  return sum;
}

}  // namespace

Ray ray_of(const View& view) {
  const Matrix3d R_A_C = view.T_A_C.R();
  return {R_A_C.transpose(), view.T_A_C.translation(), view.point, (R_A_C * view.point.homogeneous()).normalized()};
}

double largest_angle(std::span<const Ray> rays) {
  double chord2 = 0.0;  // between unit vectors: grows with the angle and keeps its digits where it is small
  for (std::size_t i = 0; i < rays.size(); ++i) {
    for (std::size_t j = i + 1; j < rays.size(); ++j) {
      chord2 = std::max(chord2, (rays[i].direction_A - rays[j].direction_A).squaredNorm());
    }
  }
  return 2.0 * std::asin(std::min(1.0, 0.5 * std::sqrt(chord2)));
}

std::optional<TriangulatedPoint> triangulate(std::span<const View> views, double min_parallax) {
  if (views.size() < 2) return std::nullopt;
  std::vector<Ray> rays;
  rays.reserve(views.size());
  for (const View& view : views) rays.push_back(ray_of(view));
  const double parallax = largest_angle(rays);
  return parallax >= min_parallax ? triangulate(rays, parallax) : std::nullopt;
}

std::optional<TriangulatedPoint> triangulate(std::span<const Ray> rays, double parallax) {
  std::optional<Vector3d> start = nearest_point(rays);
  if (!start) return std::nullopt;

  Vector3d p_A = *start;
  std::optional<Linearised> at = linearise(rays, p_A);
  if (!at) return std::nullopt;
  double damping = 0.0;
  for (int i = 0; i < kMaxIterations; ++i) {
    Matrix3d H = at->H;
    H.diagonal() *= 1.0 + damping;
    const Vector3d step = H.ldlt().solve(at->b);
    if (!step.allFinite()) return std::nullopt;
    const std::optional<Linearised> next = linearise(rays, p_A + step);
    if (!next || next->squared_sum > at->squared_sum) {
      if (step.norm() < 1e-9 * p_A.norm()) break;
      damping = damping == 0.0 ? 1e-3 : 10.0 * damping;
      continue;
    }
    p_A += step;
    const bool converged = at->squared_sum - next->squared_sum <= 1e-12 * at->squared_sum;
    at = next;
    damping *= 0.1;
    if (converged) break;
  }
  const double rms = std::sqrt(at->squared_sum / (2.0 * static_cast<double>(rays.size())));
  return TriangulatedPoint{p_A, parallax, rms};
}

double ray_angle(const Vector2d& point_1, const Matrix3d& R_1_2, const Vector2d& point_2) {
  return angle_between(point_1.homogeneous(), R_1_2 * point_2.homogeneous());
}

}  // namespace edged
