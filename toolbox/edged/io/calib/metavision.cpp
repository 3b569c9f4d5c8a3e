// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The intrinsics of the Metavision SDK from version 5 on. Earlier versions use the keys of OpenCV (camera_info.cpp).
#include "edged/io/calib/calibration_readers.hpp"

namespace edged {

bool is_metavision(const YamlReader& root) { return root.find("K") && root.find("width"); }

CalibrationFile read_metavision(const YamlReader& root) {
  if (const std::string type = root.text_or("type", "pinhole"); type != "pinhole")
    root.at("type").fail("camera type " + type + " is not supported; pinhole is");
  Lens lens;
  lens.name = "events";
  lens.sees = Sees::Events;
  lens.model = make_model(root, {root.at("width").number(), root.at("height").number(),
                                 read_camera_matrix(root.at("K")), "radtan", root.at("D").numbers()});
  CalibrationFile out;
  out.has_extrinsics = false;
  out.lenses = {lens};
  return out;
}

void refuse_metavision_extrinsics(const YamlReader& root) {
  root.at("T_slave_master")
      .fail(
          "Metavision's extrinsics are of two cameras to each other, not to an IMU: give the intrinsics.json of the "
          "camera, and write its extrinsics to the IMU into a file of `edged calib intrinsics.json --out head.yaml`");
}

}  // namespace edged
