// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The cameras around the body, addressed by name, never by index: lenses, poses, clocks.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "edged/measurement.hpp"
#include "edged/se3.hpp"
#include "edged/time.hpp"

namespace edged {

enum class DistortionModel {
  None,
  RadTan,           ///< Brown: k1, k2, p1, p2 [, k3]
  Equidistant,      ///< Kannala-Brandt: k1..k4
  Rational,         ///< OpenCV: k1, k2, p1, p2, k3..k6
  FieldOfView,      ///< Devernay: w
  Omni,             ///< Mei, with Brown's distortion: xi [, k1, k2, p1, p2]
  DoubleSphere,     ///< Usenko: xi, alpha
  ExtendedUnified,  ///< Khomutenko: alpha, beta
  OmniEquidistant   ///< Mei's sphere, then Kannala-Brandt on its plane: xi, k1..k4
};

inline constexpr std::size_t kMaxLensCoefficients = 8;
/// In the order of the model; those that it lacks are zero.
using LensCoefficients = std::array<double, kMaxLensCoefficients>;

/// A camera of one of these models.
/// Pixel coordinates have the centre of the top-left pixel at (0, 0); bearings lie on the unit plane z = 1.
/// A lens that is defined by the angle off its axis (all but RadTan and Rational) is used only in part of the image
/// where it reaches more than 86 degrees: within 70, the limit of the unit plane; and where its distortion turns back
/// before the corners of the image: as far as it grows a quarter as fast as on the axis, if that leaves three quarters
/// of the image. A value: cheap to copy, never changed after construction.
class CameraModel {
 public:
  CameraModel() = default;
  /// Throws InputError when a focal length is not positive and finite, the size is not positive, the distortion is not
  /// monotone over the image (a pixel would have no or two bearings) or three quarters of it, or the model has fewer
  /// coefficients than are set.
  CameraModel(int width, int height, double fx, double fy, double cx, double cy,
              DistortionModel distortion = DistortionModel::None, const LensCoefficients& coefficients = {});

  int width() const { return width_; }
  int height() const { return height_; }
  double fx() const { return fx_; }
  double fy() const { return fy_; }
  double cx() const { return cx_; }
  double cy() const { return cy_; }
  DistortionModel distortion() const { return distortion_; }
  const LensCoefficients& coefficients() const { return k_; }

  /// Turns angles near the axis into pixels [px]: (fx + fy) / 2, times the radius over the angle there, which is 1 but
  /// for Omni, DoubleSphere and FieldOfView.
  double mean_focal() const { return mean_focal_; }

  /// Pixel of a point (x, y) on the unit plane.
  Eigen::Vector2d distort_to_pixel(const Eigen::Vector2d& point) const;

  /// Angle off the axis up to which the lens is used [rad]; nothing where it is used in the whole image.
  std::optional<double> view_limit() const;
  /// This lens used up to that angle only, less than 86 degrees.
  CameraModel within(double limit_rad) const;

  /// This lens with only those pixels in use that are not 0, row by row: without parts of the vehicle in
  /// view, or beyond the circle that a lens draws. Throws InputError when it is of another size or leaves no pixel.
  CameraModel masked(const std::vector<std::uint8_t>& used) const;
  bool is_masked() const { return mask_.used != nullptr; }
  /// Whether the mask leaves the pixel in use. The pixel must lie in the image.
  bool uses(int x, int y) const {
    return !mask_.used || (*mask_.used)[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                        static_cast<std::size_t>(x)] != 0;
  }

  /// Pixel of a point in the camera frame; nothing when it is not in front (z <= 1e-6 m) or so far off the axis that
  /// the distortion turns back (it would fold into the image), 89 degrees at most, or view_limit. May lie outside the
  /// image.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_C) const;

  /// Unit-plane point (x, y) of a pixel, by Newton steps to 1e-10. For a pixel outside the image that has no bearing:
  /// the nearest found.
  Eigen::Vector2d pixel_to_point(const Eigen::Vector2d& pixel) const;

  /// Direction of a pixel, of any length: (x, y, 1) of pixel_to_point, but of a lens with a view_limit a unit vector,
  /// also beyond the limit and beyond 90 degrees.
  Eigen::Vector3d pixel_to_ray(const Eigen::Vector2d& pixel) const;

  /// Length of a pixel on the unit plane there over that on the axis, the geometric mean of radial and tangential; 1
  /// for a lens without view_limit, whose steepest part is taken as its middle.
  double stretch(const Eigen::Vector2d& point) const;

  /// True when the pixel is at least border_px inside the image and what is used of it.
  bool contains(const Eigen::Vector2d& pixel, double border_px = 0.0) const {
    return pixel.x() >= border_px && pixel.y() >= border_px && pixel.x() <= width_ - 1 - border_px &&
           pixel.y() <= height_ - 1 - border_px && (limit_ == 0.0 || in_limit(pixel, border_px)) &&
           (!mask_.used || in_mask(pixel, border_px));
  }

  bool operator==(const CameraModel&) const = default;

 private:
  /// Shared by copies, compared by content.
  struct Mask {
    std::shared_ptr<const std::vector<std::uint8_t>> used;  // null: all pixels
    bool operator==(const Mask& other) const {
      return used == other.used || (used && other.used && *used == *other.used);
    }
  };

  /// Sets max_radius_, and limit_ of a lens that is too wide or turns back; throws InputError when it does not reach
  /// the corners of the image.
  void find_monotone_range();
  /// Angle off the axis up to which a lens that turns back before the corners is used; nothing where it is refused.
  std::optional<double> limit_before_turn() const;
  bool in_limit(const Eigen::Vector2d& pixel, double border_px) const;
  bool in_mask(const Eigen::Vector2d& pixel, double border_px) const;
  /// Throws InputError when a pixel of the border has no bearing (the radial check does not cover the tangential part).
  void check_border() const;

  int width_ = 0, height_ = 0;
  double fx_ = 0, fy_ = 0, cx_ = 0, cy_ = 0;
  DistortionModel distortion_ = DistortionModel::None;
  LensCoefficients k_{};
  double mean_focal_ = 0;
  double max_radius_ = 0;  // on the unit plane: up to here the distortion grows with the radius, or limit_
  double limit_ = 0;       // [rad] off the axis; 0: none
  double max_theta_ = 0;   // [rad] up to here the distortion of a lens defined by its angle grows
  Mask mask_;
};

std::string to_string(DistortionModel model);

struct RigCamera {
  std::string name;
  Modality modality = Modality::Frames;
  CameraModel model;                   ///< model of the raw (distorted) image
  SE3 T_B_C;                           ///< camera frame to body: p_B = T_B_C * p_C
  Duration time_offset = Duration(0);  ///< t_imu = t_cam + time_offset
};

/// What is estimated of a camera's calibration, and where it is in its covariance.
namespace calibration_at {
inline constexpr int kRotation = 0;     ///< three, about the camera's axes [rad]
inline constexpr int kTime = 3;         ///< offset [s]
inline constexpr int kLeverArm = 4;     ///< three, position in the body [m]
inline constexpr int kFocal = 7;        ///< two, ln fx and ln fy
inline constexpr int kCentre = 9;       ///< two, principal point over the focal lengths
inline constexpr int kDistortion = 11;  ///< two, the first coefficients of the lens; zero where it has fewer
inline constexpr int kSize = 13;
}  // namespace calibration_at
using CalibrationCovariance = Eigen::Matrix<double, calibration_at::kSize, calibration_at::kSize>;

/// The odometry uses the first event camera and the first frame camera, or those that the option `cameras` names.
struct Rig {
  std::string name;
  std::vector<RigCamera> cameras;

  /// Throws an InputError that lists the known names.
  const RigCamera& camera(const std::string& camera_name) const;
  /// First camera of that kind, or null.
  const RigCamera* find(Modality modality) const;
};

}  // namespace edged
