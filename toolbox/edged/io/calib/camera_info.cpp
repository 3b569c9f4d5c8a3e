// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The intrinsics of one camera in the keys of the OpenCV samples. ROS camera_calibration, VECtor, the Metavision SDK
// before version 5 and the first DV use them.
#include "edged/io/calib/calibration_readers.hpp"

namespace edged {

std::vector<double> read_camera_matrix(const YamlReader& matrix) {
  const std::vector<double> K = matrix.numbers();
  if (K.size() != 9 || K[1] != 0 || K[3] != 0 || K[6] != 0 || K[7] != 0 || K[8] != 1)
    matrix.fail("must be [fx, 0, cx, 0, fy, cy, 0, 0, 1]");
  return {K[0], K[4], K[2], K[5]};
}

std::string opencv_distortion(const YamlReader& root) {
  const bool fisheye = root.text_or("use_fisheye_model", "0") == "1";
  return root.text_or("distortion_model", fisheye ? "equidistant" : "plumb_bob");
}

Lens read_opencv_lens(const YamlReader& root, const std::string& distortion) {
  const YamlReader matrix = root.at("camera_matrix");
  const auto image_size = root.find("image_size");  // of Metavision; the other formats have two keys
  const std::vector<double> size = image_size
                                       ? image_size->numbers()
                                       : std::vector{root.at("image_width").number(), root.at("image_height").number()};
  if (size.size() != 2) image_size->fail("must be [width, height]");
  const auto coefficients = root.find("distortion_coefficients");
  Lens lens;
  lens.model = make_model(matrix, {size[0], size[1], read_camera_matrix(matrix), coefficients ? distortion : "none",
                                   coefficients ? coefficients->numbers() : std::vector<double>{}});
  return lens;
}

CalibrationFile read_camera_info(const YamlReader& root) {
  Lens lens = read_opencv_lens(root, opencv_distortion(root));
  lens.name = root.text_or("camera_name", std::filesystem::path(root.file().name()).stem().string());
  lens.words = lens.name + " " + root.file().name();
  if (root.find("n_kept_views")) lens.sees = Sees::Events;  // of Metavision
  CalibrationFile out;
  out.has_extrinsics = false;
  out.lenses = {lens};
  return out;
}

}  // namespace edged
