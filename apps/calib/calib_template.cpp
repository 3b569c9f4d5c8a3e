// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// calib/template.yaml, with what is known of a camera.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

#include "calib/calib.hpp"
#include "calib_parts.hpp"
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

/// "none; radtan: k1 k2 ...; ..."
std::string distortion_list() {
  std::string list;
  for (const LensModel& lens : lens_models())
    list += fmt::format("{}{}{}{}", list.empty() ? "" : "; ", lens.name, lens.max_coefficients > 0 ? ": " : "",
                        lens.coefficients);
  return list;
}

}  // namespace

std::vector<std::string> template_names() {
  std::vector<std::string> names;
  for (const CameraFacts& camera : kCameras) names.emplace_back(camera.name);
  return names;
}

std::string calibration_template(const std::string& camera) {
  const auto c = std::ranges::find(kCameras, camera, &CameraFacts::name);
  EDGED_CHECK(c != kCameras.end(), "no template {}", camera);
  std::string text = fmt::format(
      fmt::runtime(kTemplateYaml), fmt::arg("what", c->what), fmt::arg("name", c->name), fmt::arg("imu", c->imu),
      fmt::arg("gyro_noise", c->gyro_noise), fmt::arg("accel_noise", c->accel_noise), fmt::arg("width", c->width),
      fmt::arg("height", c->height), fmt::arg("pitch_um", c->pitch_um), fmt::arg("f4_px", 4e3 / c->pitch_um),
      fmt::arg("f8_px", 8e3 / c->pitch_um), fmt::arg("cx", 0.5 * (c->width - 1)), fmt::arg("cy", 0.5 * (c->height - 1)),
      fmt::arg("distortions", distortion_list()));
  if (c->frames)
    text +=
        "  # Same pixels behind the same lens.\n"
        "  - name: frames\n    modality: frames\n    same_as: events\n";
  return text;
}

}  // namespace edged
