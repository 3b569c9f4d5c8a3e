// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Calibrations of DV by iniVation: the json of CalibrationSet in dv-processing, and the xml of earlier versions.
#include "edged/io/calib/calibration_readers.hpp"

namespace edged {
namespace {

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

}  // namespace

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

}  // namespace edged
