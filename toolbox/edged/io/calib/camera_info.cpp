// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The yaml files of ROS's camera_calibration: the intrinsics of one camera. VECtor's have the same keys.
#include "edged/io/calib/formats.hpp"

namespace edged {

CalibrationFile read_camera_info(const YamlReader& root) {
  const YamlReader matrix = root.at("camera_matrix");
  const std::vector<double> K = matrix.numbers();
  if (K.size() != 9 || K[1] != 0 || K[3] != 0 || K[6] != 0 || K[7] != 0 || K[8] != 1)
    matrix.fail("must be [fx, 0, cx, 0, fy, cy, 0, 0, 1]");
  Lens lens;
  lens.name = root.text_or("camera_name", std::filesystem::path(root.file().name()).stem().string());
  lens.words = lens.name + " " + root.file().name();
  const std::string distortion = root.text_or("distortion_model", "plumb_bob");
  const auto coefficients = root.find("distortion_coefficients");
  lens.model = make_model(matrix, {root.at("image_width").number(),
                                   root.at("image_height").number(),
                                   {K[0], K[4], K[2], K[5]},
                                   coefficients ? distortion : "none",
                                   coefficients ? coefficients->numbers() : std::vector<double>{}});
  CalibrationFile out;
  out.has_extrinsics = false;
  out.lenses = {lens};
  return out;
}

}  // namespace edged
