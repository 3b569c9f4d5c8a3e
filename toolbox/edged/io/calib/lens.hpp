// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What a calibration file says of a lens, and how lenses become the cameras of a rig. Internal to io.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edged/io/calib/yaml_reader.hpp"
#include "edged/io/sensor_head.hpp"

namespace edged {

/// A lens with the pixels behind it.
struct Lens {
  std::string name;
  CameraModel model;
  SE3 T_B_C;
  Duration time_offset = Duration(0);
  std::optional<Sees> sees;  ///< where the format says it
  std::string words = {};    ///< names and topics that it goes by, for guess_sees
};

/// What one calibration file (with those it points to) holds.
struct CalibrationFile {
  std::string name;  ///< of the rig; "": the file has none
  std::vector<Lens> lenses;
  bool has_extrinsics = true;
  std::optional<ImuNoise> imu;
  std::vector<std::string> warnings;
};

/// Intrinsics as the formats have them.
struct Intrinsics {
  double width, height;              ///< [px]
  std::vector<double> projection;    ///< fx, fy, cx, cy [px]
  std::string distortion = "none";   ///< any of the formats' names
  std::vector<double> coefficients;  ///< those that the model has not must be zero
};

/// The model of the projection with the coefficients of the distortion. `place` is where complaints point to.
/// InputError for models and coefficients that are not supported, by name.
CameraModel make_model(const YamlReader& place, const Intrinsics& intrinsics);

/// The model of a camera in the keys that ours, Kalibr and EuRoC share (camera_model, resolution, intrinsics) and
/// these.
CameraModel read_model(const YamlReader& camera, const std::string& distortion_key,
                       const std::string& coefficients_key);

/// From the words that a camera goes by and the size of its image; nothing where they do not tell:
/// - both: it is called davis, or named as an event camera with a topic of images, and has the size of a DAVIS;
/// - events: named as an event camera or its maker (event, dvs, davis, prophesee, evk, ...);
/// - frames: named as what frames come from (image, frame, standard, regular, rgb, mono, gray, ...).
std::optional<Sees> guess_sees(std::string_view words, int width, int height);

/// Decides what each lens sees (options, the file, its words, in this order) and names the cameras.
Calibration to_calibration(const CalibrationFile& file, const CalibrationOptions& options, const SourcePath& path);

}  // namespace edged
