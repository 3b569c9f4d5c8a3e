// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The readers of the calibration formats, for load_calibration. Internal to io.
#pragma once

#include <vector>

#include "edged/io/calib/lens.hpp"
#include "edged/io/calib/yaml_reader.hpp"

namespace edged {

/// The calibration file of a folder (docs/calibration.md). Throws InputError if it has none or several.
SourcePath find_calibration(const SourcePath& folder);
/// Detects the format by the content.
CalibrationFile read_calibration_file(const SourcePath& file);

CalibrationFile read_own_yaml(const YamlReader& root);
CalibrationFile read_ecd_calib(const SourcePath& file);
/// A sensor.yaml of a camera. imu0/sensor.yaml is searched two folders up.
CalibrationFile read_euroc(const YamlReader& root);
CalibrationFile read_vins(const YamlReader& root);
CalibrationFile read_uslam(const YamlReader& root);
CalibrationFile read_basalt(const YamlReader& root);
/// Of a file, or a message as `ros2 topic echo` prints it.
CalibrationFile read_camera_info(const YamlReader& root);
bool is_camera_info_message(const YamlReader& root);
/// A lens in the keys of OpenCV, such as camera_matrix. The name of the distortion model may be in another node.
Lens read_opencv_lens(const YamlReader& root, const std::string& distortion);
std::string opencv_distortion(const YamlReader& root);
/// fx, fy, cx, cy of a 3x3 matrix.
std::vector<double> read_camera_matrix(const YamlReader& matrix);

/// DV of iniVation.
bool is_dv_json(const YamlReader& root);
CalibrationFile read_dv_json(const YamlReader& root);
bool is_dv_xml(const YamlReader& root);
CalibrationFile read_dv_xml(const YamlReader& root);

/// Metavision of Prophesee.
bool is_metavision(const YamlReader& root);
CalibrationFile read_metavision(const YamlReader& root);
/// Always throws InputError.
CalibrationFile refuse_metavision_extrinsics(const YamlReader& root);

CalibrationFile read_kalibr(const YamlReader& root);
/// The noise keys that EuRoC and Kalibr share, also in a map `imu0`.
ImuNoise read_kalibr_noise(const YamlReader& root);
/// The pose and time offset of this IMU relative to the IMU of the camchain (T_i_b, time_offset; absent for a single
/// IMU). Transforms the cameras and their time offsets to this IMU.
void refer_to_imu(const YamlReader& imu, CalibrationFile& calibration);

/// The extrinsics of VECtor of one scale. The intrinsics are searched in the same folder.
CalibrationFile read_vector(const YamlReader& root);
/// True for a file with extrinsics of VECtor, by its keys.
bool is_vector(const YamlReader& root);
/// The extrinsics file of a folder.
std::vector<SourcePath> find_vector_files(const SourcePath& folder);

/// The mask from a picture, whose name is relative to the calibration file: 0 where it is darker than middle grey.
/// Throws InputError if the picture is missing, unreadable, or not of the size of the camera.
std::vector<std::uint8_t> read_mask(const YamlReader& picture, const CameraModel& camera);

/// The mask from run lengths: alternately numbers of used and ignored pixels, row by row, beginning with used ones.
std::vector<std::uint8_t> read_mask_runs(const YamlReader& runs, const CameraModel& camera);
/// The run lengths for read_mask_runs, in lines of bounded length.
std::string mask_runs(const CameraModel& camera);

/// The share of all pixels of the camera.
double ignored_share(const CameraModel& camera);

/// One line with the remedy for each implausible value: lever arms (long, or millimetres instead of metres), fields of
/// view, principal points, image sizes. Throws InputError for a field of view that no lens has.
std::vector<std::string> implausibilities(const Calibration& calibration, const SourcePath& path);

}  // namespace edged
