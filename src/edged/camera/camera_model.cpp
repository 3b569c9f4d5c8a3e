// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/rig.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "edged/camera/lens_table.hpp"
#include "edged/camera/tuning.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr int kMaxNewtonSteps = 30;
constexpr double kNewtonTolerance = 1e-13;    // on the unit plane, relative to 1 + the radius
constexpr double kRoundTripTolerance = 1e-6;  // [px], of the pixels tried on construction

/// Radius in the distorted image of an angle off the axis, without what is not symmetric.
ValueAndSlope radius_at(const LensModel& lens, const LensCoefficients& k, double theta) {
  const ValueAndSlope first = lens.radius_of_angle(k, theta);
  if (!lens.radius_of_radius) return first;
  const ValueAndSlope second = lens.radius_of_radius(k, first.value);
  return {second.value, second.slope * first.slope};
}

/// How far the radius grows with the angle, at most to 180 degrees, at least that steeply. It does not beyond a pole,
/// where the projection of a lens is no longer defined.
double growing_range(const LensModel& lens, const LensCoefficients& k, double least_slope = 0.0) {
  double theta = 0.0, reached = 0.0;
  while (theta + kCameraTuning.scan_step < std::numbers::pi) {
    const ValueAndSlope next = radius_at(lens, k, theta + kCameraTuning.scan_step);
    if (!(next.slope > least_slope && next.value > reached)) break;
    theta += kCameraTuning.scan_step;
    reached = next.value;
  }
  return theta;
}

/// The x in [0, upper] with function(x) = target for a function that grows from 0 on that range; upper when the target
/// is beyond it. Newton steps, replaced by bisection when they leave the bracket: past the range the function may turn
/// back and have further solutions, which a plain Newton iteration finds.
template <typename Function>
double invert_growing(const Function& function, double target, double upper) {
  double low = 0.0, high = upper;
  double x = std::min(target, upper);
  for (int i = 0; i < kMaxNewtonSteps; ++i) {
    const ValueAndSlope at = function(x);
    (at.value < target ? low : high) = x;
    double next = x + (target - at.value) / at.slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const bool converged = std::abs(next - x) <= kNewtonTolerance * (1.0 + x);
    x = next;
    if (converged) break;
  }
  return x;
}

/// The angle off the axis of a radius on the distorted unit plane, at most the one given.
double angle_of_radius(const LensModel& lens, const LensCoefficients& k, double radius, double max_theta) {
  return invert_growing([&](double theta) { return lens.radius_of_angle(k, theta); }, radius, max_theta);
}

/// The step `distort`. The radial part first, then Newton steps on both coordinates (C4).
Vector2d undistort_asymmetric(const LensModel& lens, const LensCoefficients& k, const Vector2d& distorted,
                              double max_radius) {
  const double target = distorted.norm();
  if (target == 0.0) return distorted;
  const double radius = invert_growing([&](double r) { return lens.radius_of_radius(k, r); }, target, max_radius);
  Vector2d p = radius / target * distorted;
  for (int i = 0; i < kMaxNewtonSteps; ++i) {
    const Distorted at = lens.distort(k, p);
    const Vector2d step = at.d_point.inverse() * (distorted - at.point);
    if (!(step.norm() < 0.5 * (1.0 + p.norm()))) break;  // no bearing near: leave the radial one
    p += step;
    if (step.norm() <= kNewtonTolerance * (1.0 + p.norm())) break;
  }
  return p;
}

Vector2d undistort_symmetric(const LensModel& lens, const LensCoefficients& k, const Vector2d& distorted,
                             double max_radius) {
  const double target = distorted.norm();
  if (target == 0.0) return distorted;
  return std::tan(angle_of_radius(lens, k, target, std::atan(max_radius))) / target * distorted;
}

/// The inverse of the step `distort` of a lens that is used up to an angle off its axis.
Vector2d undistort_on_plane(const LensModel& lens, const LensCoefficients& k, const Vector2d& distorted,
                            double max_theta) {
  if (!lens.distort) return distorted;
  return undistort_asymmetric(lens, k, distorted, lens.radius_of_angle(k, max_theta).value);
}

/// "k1 k2 ..." of a lens, in numbers.
std::string numbers_of(const LensModel& lens, const LensCoefficients& k) {
  return fmt::format("{}", fmt::join(k.begin(), k.begin() + static_cast<std::ptrdiff_t>(lens.max_coefficients), " "));
}

}  // namespace

CameraModel::CameraModel(int width, int height, double fx, double fy, double cx, double cy, DistortionModel distortion,
                         const LensCoefficients& coefficients)
    : width_(width), height_(height), fx_(fx), fy_(fy), cx_(cx), cy_(cy), distortion_(distortion), k_(coefficients) {
  if (width <= 0 || height <= 0) {
    throw InputError::format("image size {} x {} px: both must be positive", width, height);
  }
  if (!(std::isfinite(fx) && std::isfinite(fy) && fx > 0.0 && fy > 0.0)) {
    throw InputError::format("focal lengths fx {} fy {} px: both must be positive and finite", fx, fy);
  }
  if (!(std::isfinite(cx) && std::isfinite(cy))) {
    throw InputError::format("principal point cx {} cy {} px: both must be finite", cx, cy);
  }
  for (std::size_t i = 0; i < k_.size(); ++i) {
    if (!std::isfinite(k_[i]))
      throw InputError::format("distortion coefficient {} is {}: must be finite", i + 1, k_[i]);
  }
  const LensModel& lens = lens_model(distortion);
  if (std::any_of(k_.begin() + static_cast<std::ptrdiff_t>(lens.max_coefficients), k_.end(),
                  [](double k) { return k != 0.0; })) {
    throw InputError::format("distortion '{}' with coefficients {}: it has {}", lens.name, fmt::join(k_, " "),
                             lens.max_coefficients == 0 ? "none" : fmt::format("only {}", lens.coefficients));
  }
  mean_focal_ = 0.5 * (fx_ + fy_) * (lens.radius_of_angle ? lens.radius_of_angle(k_, 0.0).slope : 1.0);
  find_monotone_range();
  check_border();
}

void CameraModel::find_monotone_range() {
  max_radius_ = std::numeric_limits<double>::infinity();
  if (distortion_ == DistortionModel::None) return;

  double corner_radius = 0.0;  // on the distorted unit plane
  for (const double x : {0.0, width_ - 1.0}) {
    for (const double y : {0.0, height_ - 1.0}) {
      corner_radius = std::max(corner_radius, std::hypot((x - cx_) / fx_, (y - cy_) / fy_));
    }
  }
  const LensModel& lens = lens_model(distortion_);
  if (lens.radius_of_angle) max_theta_ = growing_range(lens, k_);
  if (max_theta_ > kCameraTuning.widest && corner_radius > radius_at(lens, k_, kCameraTuning.widest).value) {
    limit_ = kCameraTuning.used_of_wider;
    max_radius_ = std::tan(limit_);
    return;
  }
  double reached = 0.0;
  double theta = 0.0;
  for (; theta <= kCameraTuning.unit_plane_end; theta += kCameraTuning.scan_step) {
    const double radius = std::tan(theta);
    const ValueAndSlope at = lens.radius_of_angle ? radius_at(lens, k_, theta) : lens.radius_of_radius(k_, radius);
    if (!(at.slope > 0.0 && at.value >= reached)) break;
    reached = at.value;
    max_radius_ = radius;
  }
  if (reached >= corner_radius) return;
  if (const std::optional<double> limit = limit_before_turn()) {
    limit_ = *limit;
    max_radius_ = std::tan(limit_);
    return;
  }
  throw InputError::format(
      "distortion '{}' {} (fx {} fy {}) is not monotone over the image: it ends {:.1f} degrees off the axis at a "
      "distorted radius of {:.4f}, the image corners need {:.4f}; check the order of the coefficients, the distortion "
      "model and the image size",
      lens.name, numbers_of(lens, k_), fx_, fy_, theta / kDegree, reached, corner_radius);
}

std::optional<double> CameraModel::limit_before_turn() const {
  const LensModel& lens = lens_model(distortion_);
  if (!lens.radius_of_angle) return std::nullopt;
  const double axis_slope = radius_at(lens, k_, 0.0).slope;
  if (!(axis_slope > 0.0)) return std::nullopt;
  const double limit = std::min(growing_range(lens, k_, kCameraTuning.min_slope * axis_slope),
                                kCameraTuning.widest - kCameraTuning.scan_step);
  const double reached = radius_at(lens, k_, limit).value;
  constexpr int kPerSide = 40;
  int within = 0;
  for (int row = 0; row < kPerSide; ++row)
    for (int column = 0; column < kPerSide; ++column) {
      const double x = (column + 0.5) / kPerSide * width_ - 0.5, y = (row + 0.5) / kPerSide * height_ - 0.5;
      within += std::hypot((x - cx_) / fx_, (y - cy_) / fy_) <= reached ? 1 : 0;
    }
  return within >= kCameraTuning.min_share * kPerSide * kPerSide ? std::optional(limit) : std::nullopt;
}

void CameraModel::check_border() const {
  constexpr int kPerSide = 16;
  for (int i = 0; i <= kPerSide; ++i) {
    const double x = (width_ - 1.0) * i / kPerSide;
    const double y = (height_ - 1.0) * i / kPerSide;
    for (const Vector2d& pixel :
         {Vector2d(x, 0.0), Vector2d(x, height_ - 1.0), Vector2d(0.0, y), Vector2d(width_ - 1.0, y)}) {
      if (!contains(pixel)) continue;
      const double error = (distort_to_pixel(pixel_to_point(pixel)) - pixel).norm();
      if (error < kRoundTripTolerance) continue;
      throw InputError::format(
          "distortion '{}' {} has no inverse at pixel ({:.0f}, {:.0f}) (off by {:.2g} px); check the order "
          "of the coefficients and the distortion model",
          to_string(distortion_), numbers_of(lens_model(distortion_), k_), pixel.x(), pixel.y(), error);
    }
  }
}

Vector2d CameraModel::distort_to_pixel(const Vector2d& point) const {
  const LensModel& lens = lens_model(distortion_);
  Vector2d d = point;
  if (lens.radius_of_angle) {
    const double r = point.norm();
    if (r > 0.0) d = lens.radius_of_angle(k_, std::atan(r)).value / r * point;
  }
  if (lens.distort) d = lens.distort(k_, d).point;
  return {fx_ * d.x() + cx_, fy_ * d.y() + cy_};
}

std::optional<Vector2d> CameraModel::project(const Eigen::Vector3d& p_C) const {
  if (!(p_C.z() > 1e-6)) return std::nullopt;
  const Vector2d point = p_C.head<2>() / p_C.z();
  if (point.squaredNorm() > max_radius_ * max_radius_) return std::nullopt;
  return distort_to_pixel(point);
}

Vector2d CameraModel::pixel_to_point(const Vector2d& pixel) const {
  const Vector2d distorted((pixel.x() - cx_) / fx_, (pixel.y() - cy_) / fy_);
  const LensModel& lens = lens_model(distortion_);
  if (lens.radius_of_angle)
    return undistort_symmetric(lens, k_, undistort_on_plane(lens, k_, distorted, std::atan(max_radius_)), max_radius_);
  return lens.distort ? undistort_asymmetric(lens, k_, distorted, max_radius_) : distorted;
}

std::optional<double> CameraModel::view_limit() const { return limit_ > 0.0 ? std::optional(limit_) : std::nullopt; }

CameraModel CameraModel::within(double limit_rad) const {
  if (!(limit_rad > 0.0 && limit_rad < kCameraTuning.widest))
    throw InputError::format("the view limit of a lens must be above 0 and below {:.0f} degrees off its axis, not {:g}",
                             kCameraTuning.widest / kDegree, limit_rad / kDegree);
  CameraModel narrower = *this;
  narrower.limit_ = std::min(limit_rad, lens_model(distortion_).radius_of_angle ? max_theta_ : std::atan(max_radius_));
  narrower.max_radius_ = std::tan(narrower.limit_);
  return narrower;
}

bool CameraModel::in_limit(const Vector2d& pixel, double border_px) const {
  const double used = (distort_to_pixel({std::tan(limit_), 0.0}).x() - cx_) / fx_;
  return std::hypot((pixel.x() - cx_) / fx_, (pixel.y() - cy_) / fy_) + border_px / (0.5 * (fx_ + fy_)) <= used;
}

CameraModel CameraModel::masked(const std::vector<std::uint8_t>& used) const {
  if (used.size() != static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_))
    throw InputError::format("a mask of {} pixels for an image of {} x {}", used.size(), width_, height_);
  if (std::ranges::all_of(used, [](std::uint8_t pixel) { return pixel == 0; }))
    throw InputError("the mask ignores every pixel: white is what is used, black what is ignored");
  CameraModel narrower = *this;
  narrower.mask_.used = std::make_shared<const std::vector<std::uint8_t>>(used);
  return narrower;
}

/// Tests the pixel and points around it. Parts of a mask smaller than the border may be missed.
bool CameraModel::in_mask(const Vector2d& pixel, double border_px) const {
  for (const double dy : {0.0, -border_px, border_px})
    for (const double dx : {0.0, -border_px, border_px}) {
      const long x = std::lround(pixel.x() + dx), y = std::lround(pixel.y() + dy);
      if (x < 0 || y < 0 || x >= width_ || y >= height_) continue;  // outside the image nothing is masked
      if (!uses(static_cast<int>(x), static_cast<int>(y))) return false;
    }
  return true;
}

Eigen::Vector3d CameraModel::pixel_to_ray(const Vector2d& pixel) const {
  if (limit_ == 0.0) return pixel_to_point(pixel).homogeneous();
  const LensModel& lens = lens_model(distortion_);
  if (!lens.radius_of_angle) return pixel_to_point(pixel).homogeneous().normalized();
  const Vector2d on_plane =
      undistort_on_plane(lens, k_, {(pixel.x() - cx_) / fx_, (pixel.y() - cy_) / fy_}, max_theta_);
  const double target = on_plane.norm();
  if (target == 0.0) return Eigen::Vector3d::UnitZ();
  const double theta = angle_of_radius(lens, k_, target, max_theta_);
  return (Eigen::Vector3d() << std::sin(theta) / target * on_plane, std::cos(theta)).finished();
}

double CameraModel::stretch(const Vector2d& point) const {
  if (limit_ == 0.0) return 1.0;
  constexpr double kStep = 1e-6;
  const Vector2d here = distort_to_pixel(point);
  Matrix2d pixel_per_point;
  for (int axis = 0; axis < 2; ++axis)
    pixel_per_point.col(axis) = (distort_to_pixel(point + kStep * Vector2d::Unit(axis)) - here) / kStep;
  return mean_focal() / std::sqrt(std::abs(pixel_per_point.determinant()));
}

}  // namespace edged
