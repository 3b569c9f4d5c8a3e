// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "calib/calib_template.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

#include "edged/camera/lens_table.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

struct CameraFacts {
  const char* name;
  const char* what;
  int width, height;
  double pitch_um;  ///< of the pixels
  bool frames;      ///< from the same pixels
  const char* imu;  ///< what it has
  /// White noise: data sheet times 5 and 2.5, as in the shipped rigs, for scale, axis and sampling errors.
  double gyro_noise, accel_noise;
};

constexpr std::array kCameras = {
    CameraFacts{"davis346", "iniVation DAVIS346: events and frames of the same pixels, IMU on the board", 346, 260,
                18.5, true, "on the board; data sheet of the MPU-6500, 0.01 deg/s/sqrt(Hz) and 300 ug/sqrt(Hz)", 8.7e-4,
                7.4e-3},
    CameraFacts{"dvxplorer", "iniVation DVXplorer: events, IMU on the board (the Lite has 320 x 240 pixels of 18 um)",
                640, 480, 9.0, false,
                "on the board; data sheet of the BMI160, 0.007 deg/s/sqrt(Hz) and 180 ug/sqrt(Hz)", 6.1e-4, 4.4e-3},
    CameraFacts{
        "evk4",
        "Prophesee EVK4 (Sony IMX636): events; it has no IMU: mount one, synchronise it, give its file to --imu", 1280,
        720, 4.86, false, "one of your own; here a consumer MEMS, take its data sheet", 1e-3, 2e-2},
};

std::string imu_part(const CameraFacts& c) {
  return fmt::format(
      "imu:\n"
      "  # {}.\n"
      "  # White noise: 5 (gyro) and 2.5 times (accelerometer) the data sheet; `edged info REC` measures it where the\n"
      "  # camera lies still.\n"
      "  gyro_noise: {:.1e}        # rad/s/sqrt(Hz)\n"
      "  accel_noise: {:.1e}       # m/s^2/sqrt(Hz)\n"
      "  # Bias walk: typical of the class.\n"
      "  gyro_walk: 2.0e-5         # rad/s^2/sqrt(Hz)\n"
      "  accel_walk: 3.0e-4        # m/s^3/sqrt(Hz)\n"
      "  # Just below the ranges that the driver sets: 2000 deg/s is 34.9 rad/s, 1000 deg/s 17.45, 8 g 78.5 m/s^2.\n"
      "  gyro_saturation: FILL_IN  # rad/s\n"
      "  accel_saturation: FILL_IN # m/s^2\n",
      c.imu, c.gyro_noise, c.accel_noise);
}

/// "none; radtan: k1 k2 ...; ..."
std::string distortion_list() {
  std::string list;
  for (const LensModel& lens : lens_models())
    list += fmt::format("{}{}{}{}", list.empty() ? "" : "; ", lens.name, lens.max_coefficients > 0 ? ": " : "",
                        lens.coefficients);
  return list;
}

std::string camera_part(const CameraFacts& c) {
  return fmt::format(
      "  - name: events\n"
      "    modality: events\n"
      "    resolution: [{0}, {1}]  # px\n"
      "    # fx fy cx cy [px], from a calibration (docs/calibration.md). About: focal length of the lens / {2} um, so "
      "{3:.0f} px for\n"
      "    # 4 mm and {4:.0f} px for 8 mm; the centre near {5:.0f}, {6:.0f}.\n"
      "    intrinsics: [FILL_IN, FILL_IN, FILL_IN, FILL_IN]\n"
      "    # {7}\n"
      "    distortion: radtan\n"
      "    coefficients: [FILL_IN, FILL_IN, FILL_IN, FILL_IN]\n"
      "    # Where parts of the vehicle are in view: a picture of {0} x {1} px, black where pixels are to be ignored.\n"
      "    # mask: mask.png\n"
      "    # Camera to IMU, p_B = T_B_C * p_C: columns are the camera's x (right), y (down) and z (forward) axes in "
      "the IMU's,\n"
      "    # then its place in metres. T_C_B instead is the inverse: Kalibr's T_cam_imu.\n"
      "    T_B_C:\n"
      "      - [FILL_IN, FILL_IN, FILL_IN, FILL_IN]\n"
      "      - [FILL_IN, FILL_IN, FILL_IN, FILL_IN]\n"
      "      - [FILL_IN, FILL_IN, FILL_IN, FILL_IN]\n"
      "      - [0.0, 0.0, 0.0, 1.0]\n"
      "    # t_imu = t_cam + time_offset; Kalibr's timeshift_cam_imu. A run refines it by some milliseconds.\n"
      "    time_offset: 0.0  # s\n",
      c.width, c.height, c.pitch_um, 4e3 / c.pitch_um, 8e3 / c.pitch_um, 0.5 * (c.width - 1), 0.5 * (c.height - 1),
      distortion_list());
}

}  // namespace

std::vector<std::string> template_names() {
  std::vector<std::string> names;
  for (const CameraFacts& camera : kCameras) names.emplace_back(camera.name);
  return names;
}

std::string calibration_template(const std::string& camera) {
  const auto facts = std::ranges::find(kCameras, camera, &CameraFacts::name);
  EDGED_CHECK(facts != kCameras.end(), "no template {}", camera);
  std::string text = fmt::format(
      "# {}.\n"
      "# Fill in what reads FILL_IN, then: edged calib FILE, edged doctor REC --calib FILE, edged run REC --calib "
      "FILE.\n"
      "# From a calibration of Kalibr, VINS, basalt ... this file is made by: edged calib THEIRS --out FILE\n"
      "edged_rig: 1\n"
      "name: {}\n\n{}\ncameras:\n{}",
      facts->what, facts->name, imu_part(*facts), camera_part(*facts));
  if (facts->frames)
    text +=
        "  # Same pixels behind the same lens.\n"
        "  - name: frames\n    modality: frames\n    same_as: events\n";
  return text;
}

}  // namespace edged
