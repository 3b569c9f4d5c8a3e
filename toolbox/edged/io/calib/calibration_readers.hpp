// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The calibration formats behind load_calibration. Internal to io.
#pragma once

#include <vector>

#include "edged/io/calib/lens.hpp"
#include "edged/io/calib/yaml_reader.hpp"

namespace edged {

/// The file of a folder that holds its calibration (docs/calibration.md). InputError where there is none, or several.
SourcePath find_calibration(const SourcePath& folder);
/// Of any format, found by content.
CalibrationFile read_calibration_file(const SourcePath& file);

CalibrationFile read_own_yaml(const YamlReader& root);
CalibrationFile read_ecd_calib(const SourcePath& file);
/// A sensor.yaml of a camera; imu0/sensor.yaml is looked for two folders up.
CalibrationFile read_euroc(const YamlReader& root);
CalibrationFile read_vins(const YamlReader& root);
CalibrationFile read_uslam(const YamlReader& root);
CalibrationFile read_basalt(const YamlReader& root);
CalibrationFile read_camera_info(const YamlReader& root);
/// A lens in OpenCV's keys, camera_matrix and the like; what the file says of its distortion may stand elsewhere.
Lens read_opencv_lens(const YamlReader& root, const std::string& distortion);
std::string opencv_distortion(const YamlReader& root);
/// fx, fy, cx, cy of a 3x3 matrix.
std::vector<double> read_camera_matrix(const YamlReader& matrix);

/// iniVation's DV.
bool is_dv_json(const YamlReader& root);
CalibrationFile read_dv_json(const YamlReader& root);
bool is_dv_xml(const YamlReader& root);
CalibrationFile read_dv_xml(const YamlReader& root);

/// Prophesee's Metavision.
bool is_metavision(const YamlReader& root);
CalibrationFile read_metavision(const YamlReader& root);
[[noreturn]] void refuse_metavision_extrinsics(const YamlReader& root);

CalibrationFile read_kalibr(const YamlReader& root);
/// Noise keys of EuRoC and Kalibr, which agree; also below `imu0`.
ImuNoise read_kalibr_noise(const YamlReader& root);
/// Where this IMU sits and how its clock runs against the one of the camchain (T_i_b, time_offset; absent for one IMU):
/// turns cameras and offsets to it.
void refer_to_imu(const YamlReader& imu, CalibrationFile& calibration);

/// VECtor's extrinsics of one scale; the intrinsics are looked for beside it.
CalibrationFile read_vector(const YamlReader& root);
/// A file with VECtor's extrinsics, by its keys.
bool is_vector(const YamlReader& root);
/// The ones of a folder.
std::vector<SourcePath> find_vector_files(const SourcePath& folder);

}  // namespace edged
