// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Intrinsics in the keys of OpenCV: ROS camera_info, OpenCV's samples, Metavision before version 5, the xml of DV by
// iniVation; and the json of their later versions.
#include <spdlog/fmt/ranges.h>

#include "edged/camera/lens_table.hpp"
#include "edged/core/check.hpp"
#include "edged/io/calib/calibration_readers.hpp"
#include "edged/io/calibration.hpp"

namespace edged {
namespace {

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

constexpr double kMicrosecond_s = 1e-6;

Lens read_dv_camera(const YamlReader& node, const std::string& key) {
  Lens lens;
  const std::vector<double> size = node.at("resolution").numbers(2, "[width, height]"),
                            focal = node.at("focalLength").numbers(2, "[fx, fy]"),
                            centre = node.at("principalPoint").numbers(2, "[cx, cy]");
  const std::string distortion = node.text_or("distortionModel", "none");
  // An empty list is written as "".
  const bool none = distortion == "none" || distortion.empty();
  lens.model = make_model(node, {size[0],
                                 size[1],
                                 {focal[0], focal[1], centre[0], centre[1]},
                                 distortion,
                                 none ? std::vector<double>{} : node.at("distortionCoefficients").numbers()});
  const std::string name = node.text_or("name", "");
  lens.name = name.empty() ? key : name;
  lens.words = lens.name;
  return lens;
}

/// The first IMU of the file: a recording has only one.
std::optional<YamlReader> first_imu(const YamlReader& root) {
  const auto imus = root.find("imus");
  if (!imus || !imus->is_map()) return std::nullopt;
  const auto entries = imus->entries();
  if (entries.size() > 1) imus->warn("several IMUs; " + entries.front().first + " is used");
  return entries.empty() ? std::nullopt : std::optional(entries.front().second);
}

/// fx, fy, cx, cy of a 3x3 matrix.
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

/// A lens in keys such as camera_matrix. The name of the distortion model may be in another node.
Lens read_opencv_lens(const YamlReader& root, const std::string& distortion) {
  const YamlReader matrix = root.at("camera_matrix");
  const auto image_size = root.find("image_size");  // of Metavision; the other formats have two keys
  const std::vector<double> size = image_size
                                       ? image_size->numbers(2, "[width, height]")
                                       : std::vector{root.at("image_width").number(), root.at("image_height").number()};
  const auto coefficients = root.find("distortion_coefficients");
  Lens lens;
  lens.model = make_model(matrix, {size[0], size[1], read_camera_matrix(matrix), coefficients ? distortion : "none",
                                   coefficients ? coefficients->numbers() : std::vector<double>{}});
  return lens;
}

/// ROS 2 calls the matrices k and d, ROS 1 K and D.
Lens read_message_lens(const YamlReader& root) {
  const bool ros2 = root.find("k").has_value();
  const YamlReader matrix = root.at(ros2 ? "k" : "K");
  Lens lens;
  lens.model = make_model(matrix, {root.at("width").number(), root.at("height").number(), read_camera_matrix(matrix),
                                   root.at("distortion_model").text(), root.at(ros2 ? "d" : "D").numbers()});
  return lens;
}

}  // namespace

bool is_camera_info_message(const YamlReader& root) {
  return root.find("distortion_model") && (root.find("k") || root.find("K"));
}

CalibrationFile read_camera_info(const YamlReader& root) {
  Lens lens = is_camera_info_message(root) ? read_message_lens(root) : read_opencv_lens(root, opencv_distortion(root));
  lens.name = root.text_or("camera_name", std::filesystem::path(root.file().name()).stem().string());
  lens.words = lens.name + " " + root.file().name();
  if (root.find("n_kept_views")) lens.sees = Sees::Events;  // of Metavision
  return {.lenses = {lens}, .has_extrinsics = false};
}

bool is_metavision(const YamlReader& root) { return root.find("K") && root.find("width"); }

CalibrationFile read_metavision(const YamlReader& root) {
  if (const std::string type = root.text_or("type", "pinhole"); type != "pinhole")
    root.at("type").fail("camera type " + type + " is not supported; pinhole is");
  Lens lens;
  lens.name = "events";
  lens.sees = Sees::Events;
  lens.model = make_model(root, {root.at("width").number(), root.at("height").number(),
                                 read_camera_matrix(root.at("K")), "radtan", root.at("D").numbers()});
  return {.lenses = {lens}, .has_extrinsics = false};
}

CalibrationFile refuse_metavision_extrinsics(const YamlReader& root) {
  root.at("T_slave_master")
      .fail(
          "Metavision's extrinsics are of two cameras to each other, not to an IMU: give the intrinsics.json of the "
          "camera, and write its extrinsics to the IMU into a file of `edged calib intrinsics.json --out head.yaml`");
}

bool is_dv_json(const YamlReader& root) {
  const auto cameras = root.find("cameras");
  return cameras && cameras->is_map() && root.find("version");
}

CalibrationFile read_dv_json(const YamlReader& root) {
  CalibrationFile out;
  const auto imu = first_imu(root);
  out.has_extrinsics = imu.has_value();
  const SE3 T_B_C0 = imu ? imu->at("transformationToC0").transform().inverse() : SE3();  // p_C0 = T * p_IMU
  for (const auto& [key, node] : root.at("cameras").entries()) {
    Lens lens = read_dv_camera(node, key);
    // p_Cn = T * p_C0, contrary to its name: the result of stereoCalibrate in OpenCV for the second camera.
    lens.T_B_C = T_B_C0 * node.at("transformationToC0").transform().inverse();
    // t_cam = t_imu - timeOffsetMicros.
    if (imu) lens.time_offset = imu->at("timeOffsetMicros").time_offset(kMicrosecond_s);
    out.lenses.push_back(std::move(lens));
  }
  if (imu)
    imu->warn(
        "noise densities in DV's files are constants of the sensor's type: not used; give --imu FILE with those "
        "of a Kalibr imu.yaml");
  return out;
}

bool is_dv_xml(const YamlReader& root) {
  if (!root.is_map() || !root.find("type")) return false;
  for (const auto& entry : root.entries())
    if (entry.second.find("camera_matrix")) return true;
  return false;
}

CalibrationFile read_dv_xml(const YamlReader& root) {
  CalibrationFile out;
  for (const auto& [key, node] : root.entries()) {
    if (!node.find("camera_matrix")) continue;
    Lens lens = read_opencv_lens(node, opencv_distortion(root));
    lens.name = lens.words = key;
    out.lenses.push_back(std::move(lens));
  }
  const auto T_cam_imu = root.find("transformation_cam_imu");
  out.has_extrinsics = T_cam_imu && out.lenses.size() == 1;  // DV does not calibrate the IMU of two cameras
  if (!out.has_extrinsics) return out;
  Lens& lens = out.lenses.front();
  lens.T_B_C = T_cam_imu->transform().inverse();  // in the convention of Kalibr
  for (const char* key : {"time_offset_cam_imu", "time_offset_cam_imu__t_imu_equals_t_cam_plus_shift"})
    if (const auto offset = root.find(key)) lens.time_offset = offset->time_offset();
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
