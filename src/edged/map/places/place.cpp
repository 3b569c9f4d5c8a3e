// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/places/place.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "edged/map/tuning.hpp"

namespace edged {
namespace {

constexpr int kPairs = 300;  // pairs: with 20 % inliers all but 5e-6 of the runs draw a pair of inliers
constexpr int kRefinements = 5;

/// Direction of `up` in the image at that point of the unit plane [deg]; nothing if the ray is nearly vertical.
std::optional<float> upright_deg(const Eigen::Vector2d& point, const Eigen::Vector3d& up_C) {
  const Eigen::Vector3d ray(point.x(), point.y(), 1.0);
  if (ray.cross(up_C).norm() < kMapTuning.min_upright * ray.norm()) return std::nullopt;
  const Eigen::Vector2d direction = up_C.head<2>() - point * up_C.z();
  const double deg = std::atan2(direction.y(), direction.x()) * 180.0 / std::numbers::pi;
  return static_cast<float>(deg < 0.0 ? deg + 360.0 : deg);
}

/// Camera positions and headings from which two points are seen along two rays (in O): lambda_i Rz f_i = p_i - t. The
/// heights give one distance from the other, the horizontal distance gives both.
std::vector<SE3> poses_of(const PlaceMatch& a, const PlaceMatch& b, const Eigen::Quaterniond& R_O_C) {
  Eigen::Vector3d f1 = R_O_C * a.point.homogeneous(), f2 = R_O_C * b.point.homogeneous();
  Eigen::Vector3d p1 = a.p_M, p2 = b.p_M;
  if (std::abs(f1.z()) < std::abs(f2.z())) std::swap(f1, f2), std::swap(p1, p2);
  if (std::abs(f1.z()) < kMapTuning.min_ray_slope) return {};
  const Eigen::Vector3d d = p1 - p2;
  const Eigen::Vector2d along = f1.head<2>() * (f2.z() / f1.z()) - f2.head<2>(),
                        start = f1.head<2>() * (d.z() / f1.z());
  const double A = along.squaredNorm(), B = along.dot(start), C = start.squaredNorm() - d.head<2>().squaredNorm();
  const double root = B * B - A * C;
  if (A < 1e-12 || root < 0.0) return {};
  std::vector<SE3> poses;
  for (const double sign : {-1.0, 1.0}) {
    const double l2 = (-B + sign * std::sqrt(root)) / A, l1 = (d.z() + l2 * f2.z()) / f1.z();
    if (!(l1 > 0.0) || !(l2 > 0.0)) continue;
    const Eigen::Vector2d before = start + l2 * along;
    const Eigen::Quaterniond Rz = so3::exp({0.0, 0.0, std::atan2(d.y(), d.x()) - std::atan2(before.y(), before.x())});
    poses.emplace_back(Rz * R_O_C, p2 - l2 * (Rz * f2));
  }
  return poses;
}

std::size_t count_agreeing(std::span<const PlaceMatch> matches, const SE3& T_M_C, double max_error) {
  const SE3 T_C_M = T_M_C.inverse();
  return static_cast<std::size_t>(
      std::ranges::count_if(matches, [&](const PlaceMatch& match) { return agrees(match, T_C_M, max_error); }));
}

/// A Gauss-Newton step of position and heading for the matches that agree.
SE3 refined(std::span<const PlaceMatch> matches, const SE3& T_M_C, double max_error) {
  const SE3 T_C_M = T_M_C.inverse();
  Eigen::Matrix4d H = 1e-9 * Eigen::Matrix4d::Identity();
  Eigen::Vector4d b = Eigen::Vector4d::Zero();
  for (const PlaceMatch& match : matches) {
    if (!agrees(match, T_C_M, max_error)) continue;
    const Eigen::Vector3d p_C = T_C_M * match.p_M, from_C = match.p_M - T_M_C.translation();
    Eigen::Matrix<double, 2, 3> projection;
    projection << 1.0, 0.0, -p_C.x() / p_C.z(), 0.0, 1.0, -p_C.y() / p_C.z();
    Eigen::Matrix<double, 3, 4> by_pose;  // of p_C, by the position and a rotation of the camera about z of M
    by_pose << -T_C_M.R(), -T_C_M.R() * Eigen::Vector3d::UnitZ().cross(from_C);
    const Eigen::Matrix<double, 2, 4> J = projection / p_C.z() * by_pose;
    H += J.transpose() * J;
    b += J.transpose() * (match.point - p_C.hnormalized());
  }
  const Eigen::Vector4d step = H.ldlt().solve(b);
  return {so3::exp({0.0, 0.0, step[3]}) * T_M_C.rotation(), T_M_C.translation() + step.head<3>()};
}

}  // namespace

bool agrees(const PlaceMatch& match, const SE3& T_C_M, double max_error) {
  const Eigen::Vector3d p_C = T_C_M * match.p_M;
  return p_C.z() > 0.0 && (p_C.hnormalized() - match.point).norm() < max_error;
}

std::vector<std::optional<Descriptor>> describe(const cv::Mat& image, std::span<const Eigen::Vector2d> pixels,
                                                std::span<const Eigen::Vector2d> points, const Eigen::Vector3d& up_C) {
  constexpr int kBorder_px = 31;
  std::vector<std::optional<float>> angles_deg;
  for (const Eigen::Vector2d& point : points) angles_deg.push_back(upright_deg(point, up_C));
  return describe(image, pixels, angles_deg, kBorder_px);
}

std::optional<PlacePose> pose_by_gravity(std::span<const PlaceMatch> matches, const Eigen::Quaterniond& R_O_C,
                                         double max_error) {
  if (matches.size() < 2) return std::nullopt;
  std::mt19937 random(1);
  std::optional<PlacePose> best;
  for (int i = 0; i < kPairs; ++i) {
    const std::size_t a = random() % matches.size(), b = random() % matches.size();
    if (a == b) continue;
    for (const SE3& T_M_C : poses_of(matches[a], matches[b], R_O_C)) {
      const std::size_t agreeing = count_agreeing(matches, T_M_C, max_error);
      if (!best || agreeing > best->agreeing) best = PlacePose{T_M_C, agreeing};
    }
  }
  for (int i = 0; best && i < kRefinements; ++i) {
    const SE3 T_M_C = refined(matches, best->T_M_C, max_error);
    const std::size_t agreeing = count_agreeing(matches, T_M_C, max_error);
    if (agreeing < best->agreeing) break;
    best = PlacePose{T_M_C, agreeing};
  }
  return best;
}

}  // namespace edged
