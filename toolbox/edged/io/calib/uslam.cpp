// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The rig files of Ultimate SLAM (ze_oss): cameras with T_B_C. They contain no time offset and no IMU noise.
#include "edged/io/calib/calibration_readers.hpp"

namespace edged {
namespace {

Lens read_uslam_camera(const YamlReader& item, std::size_t index) {
  const YamlReader camera = item.at("camera");
  if (const std::string type = camera.text_or("type", "pinhole"); type != "pinhole")
    camera.at("type").fail("camera type " + type + " is not supported; pinhole is");
  const auto distortion = camera.find("distortion");
  Intrinsics in{camera.at("image_width").number(),
                camera.at("image_height").number(),
                camera.at("intrinsics").numbers(),
                "none",
                {}};
  if (distortion) {
    in.distortion = distortion->text_or("type", "none");
    if (in.distortion != "none") in.coefficients = distortion->at("parameters").numbers();
  }
  Lens lens;
  lens.name = camera.text_or("label", "cam" + std::to_string(index));
  lens.words = lens.name;
  lens.model = make_model(camera.at("intrinsics"), in);
  lens.T_B_C = item.at("T_B_C").transform();
  return lens;
}

}  // namespace

CalibrationFile read_uslam(const YamlReader& root) {
  CalibrationFile out;
  out.name = root.text_or("label", "");
  for (const YamlReader& item : root.at("cameras").items())
    out.lenses.push_back(read_uslam_camera(item, out.lenses.size()));
  return out;
}

}  // namespace edged
