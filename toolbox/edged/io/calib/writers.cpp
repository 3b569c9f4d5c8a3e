// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Calibrations in the formats of others: Kalibr's camchain, and the keys of OpenCV's samples and ROS' camera_info.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "edged/camera/lens_table.hpp"
#include "edged/core/check.hpp"
#include "edged/io/calibration.hpp"

namespace edged {
namespace {

/// What Kalibr calls a lens: the coefficients of the projection stand before the focal lengths.
struct KalibrLens {
  std::string camera_model, distortion_model;
  std::vector<double> intrinsics, distortion;
};

KalibrLens kalibr_lens(const RigCamera& camera) {
  const CameraModel& m = camera.model;
  const LensModel& lens = lens_model(m.distortion());
  const auto& k = m.coefficients();
  KalibrLens out{"pinhole", "none", {}, {}};
  if (lens.projection_parameters > 0) {
    out.camera_model = lens.name;
    out.intrinsics.assign(k.begin(), k.begin() + static_cast<std::ptrdiff_t>(lens.projection_parameters));
    const auto rest =
        std::span(k).subspan(lens.projection_parameters, lens.max_coefficients - lens.projection_parameters);
    if (std::ranges::any_of(rest, [](double c) { return c != 0.0; })) {
      out.distortion_model = "radtan";
      out.distortion.assign(rest.begin(), rest.end());
    }
  } else if (m.distortion() == DistortionModel::RadTan && k[4] == 0.0) {
    out.distortion_model = "radtan", out.distortion = {k[0], k[1], k[2], k[3]};
  } else if (m.distortion() == DistortionModel::Equidistant) {
    out.distortion_model = "equidistant", out.distortion = {k[0], k[1], k[2], k[3]};
  } else if (m.distortion() == DistortionModel::OmniEquidistant) {
    out.camera_model = "omni", out.intrinsics = {k[0]};
    out.distortion_model = "equidistant", out.distortion = {k[1], k[2], k[3], k[4]};
  } else if (m.distortion() == DistortionModel::FieldOfView) {
    out.distortion_model = "fov", out.distortion = {k[0]};
  } else if (m.distortion() != DistortionModel::None) {
    throw InputError::format("camera {}: Kalibr has no lens '{}'{}; choose another --lens, or --format edged",
                             camera.name, lens.name, m.distortion() == DistortionModel::RadTan ? " with a k3" : "");
  }
  out.intrinsics.insert(out.intrinsics.end(), {m.fx(), m.fy(), m.cx(), m.cy()});
  return out;
}

std::string rows(const SE3& T) {
  std::string out;
  const Eigen::Matrix4d M = T.matrix();
  for (int row = 0; row < 4; ++row)
    out += fmt::format("  - [{}, {}, {}, {}]\n", M(row, 0), M(row, 1), M(row, 2), M(row, 3));
  return out;
}

/// The name of a lens and its coefficients in OpenCV's order.
struct OpenCvLens {
  std::string name;
  std::vector<double> coefficients;
};

OpenCvLens opencv_lens(const RigCamera& camera) {
  const CameraModel& m = camera.model;
  const LensModel& lens = lens_model(m.distortion());
  if (m.distortion() == DistortionModel::None) return {"plumb_bob", std::vector<double>(5, 0.0)};
  if (lens.ros.empty())
    throw InputError::format(
        "camera {}: OpenCV has no lens '{}'; choose --lens radtan, rational or equidistant, or --format edged",
        camera.name, lens.name);
  const auto& k = m.coefficients();
  return {std::string(lens.ros), {k.begin(), k.begin() + static_cast<std::ptrdiff_t>(lens.max_coefficients)}};
}

}  // namespace

std::string to_kalibr_yaml(const Calibration& calibration, bool has_poses) {
  std::string out;
  for (std::size_t i = 0; i < calibration.rig.cameras.size(); ++i) {
    const RigCamera& camera = calibration.rig.cameras[i];
    const KalibrLens lens = kalibr_lens(camera);
    out += fmt::format("cam{}:\n", i);
    if (calibration.has_extrinsics) out += "  T_cam_imu:\n" + rows(camera.T_B_C.inverse());
    if (has_poses && i > 0)
      out += "  T_cn_cnm1:\n" + rows(camera.T_B_C.inverse() * calibration.rig.cameras[i - 1].T_B_C);
    out += fmt::format(
        "  camera_model: {}\n  distortion_coeffs: [{}]\n  distortion_model: {}\n  intrinsics: [{}]\n  resolution: [{}, "
        "{}]\n  rostopic: /{}\n  name: {}\n  modality: {}\n",
        lens.camera_model, fmt::join(lens.distortion, ", "), lens.distortion_model, fmt::join(lens.intrinsics, ", "),
        camera.model.width(), camera.model.height(), camera.name, camera.name,
        camera.modality == Modality::Events ? "events" : "frames");
    if (calibration.has_extrinsics) out += fmt::format("  timeshift_cam_imu: {}\n", to_seconds(camera.time_offset));
  }
  return out;
}

std::string to_opencv_yaml(const RigCamera& camera) {
  const CameraModel& m = camera.model;
  const OpenCvLens lens = opencv_lens(camera);
  return fmt::format(
      "%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\ncamera_name: {}\ncamera_matrix: !!opencv-matrix\n   rows: 3\n"
      "   cols: 3\n   dt: d\n   data: [ {}, 0., {}, 0., {}, {}, 0., 0., 1. ]\ndistortion_model: {}\n"
      "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
      m.width(), m.height(), camera.name, m.fx(), m.cx(), m.fy(), m.cy(), lens.name, lens.coefficients.size(),
      fmt::join(lens.coefficients, ", "));
}

}  // namespace edged
