// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/calib/calibration_readers.hpp"

#include <cmath>
#include <utility>

#include "edged/camera/field_of_view.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

constexpr double kLongArm = 0.5;                    // [m]
constexpr double kMillimetreArm = 2.0;              // [m] longer than on any sensor head: millimetres read as metres
constexpr double kMinView = 1.0, kMaxView = 172.0;  // [deg] across the diagonal: no lens of this model
constexpr double kNarrowView = 10.0, kWideView = 160.0;  // [deg] rare
constexpr double kMaxWideView = 250.0;  // [deg] across the shorter side of a lens with a view of more than 180 deg
constexpr double kOffCentre = 0.15;     // distance of the principal point from the middle, as a share of the image size
constexpr double kPixelAspect = 0.05;   // relative difference of fx and fy

/// Distance of the principal point from the middle of an image of this size, as a share of its width or height.
double off_centre(const CameraModel& m, int width, int height) {
  return std::max(std::abs(m.cx() / width - 0.5), std::abs(m.cy() / height - 0.5));
}

class PlausibilityChecks {
 public:
  explicit PlausibilityChecks(const SourcePath& path) : path_(path.string()) {}

  void pose(const RigCamera& camera) {
    const double arm = camera.T_B_C.translation().norm();
    if (arm > kMillimetreArm) {
      warn(camera,
           "{:.4g} m away from the IMU: translations must be in metres; were they in millimetres ({:.3g} m), "
           "divide them by 1000",
           arm, arm * 1e-3);
    } else if (arm > kLongArm) {
      warn(camera, "{:.2f} m away from the IMU: is the translation in metres, and of the right camera?", arm);
    }
  }

  void field(const RigCamera& camera) {
    const CameraModel& m = camera.model;
    const FieldOfView fields = field_of_view(m);
    const bool wide = m.view_limit().has_value();  // the corners of the image may lie outside the image circle
    const double view = (wide ? std::min(fields.horizontal, fields.vertical) : fields.diagonal) * kDegreesPerRadian;
    if (!(view >= kMinView && view <= (wide ? kMaxWideView : kMaxView)))
      throw InputError::format(
          "{}: camera {}: a field of view of {:.3g} deg is impossible: fx {:g}, fy {:g} must be in pixels of the image "
          "of {} x {}",
          path_, camera.name, view, m.fx(), m.fy(), m.width(), m.height());
    if (view < kNarrowView || (view > kWideView && !wide))
      warn(camera, "a field of view of {:.3g} deg across the image is rare: are fx and fy of this image size?", view);
    if (std::abs(m.fx() / m.fy() - 1.0) > kPixelAspect)
      warn(camera, "fx {:g} and fy {:g} differ by more than {:.0f} %: pixels are square", m.fx(), m.fy(),
           100 * kPixelAspect);
  }

  void centre(const RigCamera& camera) {
    const CameraModel& m = camera.model;
    const double off = off_centre(m, m.width(), m.height());
    if (off <= kOffCentre) return;
    if (off_centre(m, m.height(), m.width()) <= kOffCentre) {
      warn(camera,
           "the principal point ({:g}, {:g}) fits an image of {} x {}, not of {} x {}: are width and height "
           "swapped?",
           m.cx(), m.cy(), m.height(), m.width(), m.width(), m.height());
    } else {
      warn(camera,
           "the principal point ({:g}, {:g}) is {:.0f} % off the middle of {} x {}: is that the size of the "
           "images it was calibrated with?",
           m.cx(), m.cy(), 100 * off, m.width(), m.height());
    }
  }

  /// Cameras of one lens have one image size.
  void sizes(const RigCamera& a, const RigCamera& b) {
    const CameraModel &m = a.model, &n = b.model;
    const bool same_lens = m.fx() == n.fx() && m.fy() == n.fy() && m.cx() == n.cx() && m.cy() == n.cy();
    if (same_lens && (m.width() != n.width() || m.height() != n.height()))
      warn(b, "has the lens of camera {} but {} x {} pixels instead of {} x {}: one of the sizes is wrong", a.name,
           n.width(), n.height(), m.width(), m.height());
  }

  std::vector<std::string> warnings;

 private:
  template <typename... Args>
  void warn(const RigCamera& camera, fmt::format_string<Args...> text, Args&&... args) {
    warnings.push_back(
        fmt::format("{}: camera {}: {}", path_, camera.name, fmt::format(text, std::forward<Args>(args)...)));
  }

  std::string path_;
};

}  // namespace

std::vector<std::string> implausibilities(const Calibration& calibration, const SourcePath& path) {
  PlausibilityChecks checks(path);
  const auto& cameras = calibration.rig.cameras;
  for (auto camera = cameras.begin(); camera != cameras.end(); ++camera) {
    for (auto before = cameras.begin(); before != camera; ++before) checks.sizes(*before, *camera);
    // A lens of events and frames is checked once.
    if (std::any_of(cameras.begin(), camera, [&](const RigCamera& c) { return is_same_lens(c, *camera); })) continue;
    checks.field(*camera);
    checks.centre(*camera);
    if (calibration.has_extrinsics) checks.pose(*camera);
  }
  return checks.warnings;
}

}  // namespace edged
