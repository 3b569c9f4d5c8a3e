// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Lenses from calibration files, the readers of their formats, and the cameras of a rig made from them. Internal to io.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "edged/io/calib/yaml_reader.hpp"
#include "edged/io/calibration_data.hpp"

namespace edged {

/// A lens with its sensor. It becomes one camera of a rig, or two for events and frames.
struct Lens {
  std::string name;
  CameraModel model;
  SE3 T_B_C;
  Duration time_offset = Duration(0);
  std::optional<Sees> sees;  ///< if the format states it
  std::string words = {};    ///< its names and topics, for guess_sees
  std::string topic = {};    ///< ROS topic of its images or events; "" if the file names none
};

/// The content of a calibration file and of the files that it names.
struct CalibrationFile {
  std::string name = {};  ///< name of the rig; "" if the file has none
  std::vector<Lens> lenses = {};
  bool has_extrinsics = true;
  std::optional<ImuNoise> imu = {};
  std::vector<std::string> warnings = {};
};

/// A value of ImuNoise and its keys in the formats, "" where a format has none.
struct NoiseKey {
  double ImuNoise::*value;
  const char *own, *kalibr, *basalt;
  const char* unit;  ///< "" without one
};
std::span<const NoiseKey> noise_keys();

/// Intrinsics in the terms of the formats.
struct Intrinsics {
  double width, height;              ///< [px]
  std::vector<double> projection;    ///< fx, fy, cx, cy [px]
  std::string distortion = "none";   ///< in the naming of any format
  std::vector<double> coefficients;  ///< beyond those of the model they must be zero
};

/// The camera model with its distortion. Errors name the file and line of `place`. Throws InputError for models and
/// coefficients that are not supported.
CameraModel make_model(const YamlReader& place, const Intrinsics& intrinsics);

/// The camera model in the keys that this program, Kalibr and EuRoC share (camera_model, resolution, intrinsics), and
/// in the given keys of the distortion.
CameraModel read_model(const YamlReader& camera, const std::string& distortion_key,
                       const std::string& coefficients_key);

/// Guesses from the names of a camera and the size of its image. Nothing if they do not determine it:
/// - both: it is called davis, or named as an event camera with a topic of images, and has the size of a DAVIS;
/// - events: named as an event camera or its maker (event, dvs, davis, prophesee, evk, ...);
/// - frames: named as what frames come from (image, frame, standard, regular, rgb, mono, gray, ...).
std::optional<Sees> guess_sees(std::string_view words, int width, int height);

/// Determines the modality of each lens (by the options, the file, its words, in this order) and names the cameras.
Calibration to_calibration(const CalibrationFile& file, const CalibrationOptions& options, const SourcePath& path);

// The readers of the formats.

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

/// One line with the remedy for each implausible value: lever arms (long, or millimetres instead of metres), fields of
/// view, principal points, image sizes. Throws InputError for a field of view that no lens has.
std::vector<std::string> implausibilities(const Calibration& calibration, const SourcePath& path);

}  // namespace edged
