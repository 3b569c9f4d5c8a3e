// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Finds the calibration file of a folder, and the format of a file.
#include <algorithm>
#include <functional>
#include <sstream>

#include "edged/core/check.hpp"
#include "edged/io/calib/calibration_readers.hpp"
#include "edged/io/core/dataset_folders.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr std::size_t kProbeBytes = 4096;

std::vector<SourcePath> files_where(const SourcePath& folder, const std::function<bool(const std::string&)>& fits) {
  std::vector<SourcePath> found;
  if (!folder.is_folder()) return found;
  for (const std::string& name : folder.names())
    if (fits(name)) found.push_back(folder / name);
  return found;
}

bool is_camchain(const std::string& name) { return name.starts_with("camchain") && name.ends_with(".yaml"); }

/// basalt: camera-calibrationA.json, calibration.json, but not mocap-imu-calibrationA.json. DV: json, xml.
/// Metavision: intrinsics.json.
bool is_named_calibration(const std::string& name) {
  if (name == "intrinsics.json") return true;
  return (name.ends_with(".json") || name.ends_with(".xml")) && name.find("calib") != std::string::npos &&
         name.find("mocap") == std::string::npos;
}

/// The first field of the first line that is no comment.
bool starts_with_a_number(const SourcePath& file) try {
  std::string begin(kProbeBytes, '\0');
  begin.resize(file.open()->read(begin));
  std::istringstream lines(begin);
  for (std::string line; std::getline(lines, line);) {
    const std::string_view field = FieldReader(line).next();
    if (field.empty() || field.front() == '#') continue;
    return parse_number(field).has_value();
  }
  return false;
} catch (const Damage& damage) {
  throw InputError::format("{}: {}", file.string(), damage.what());
}

bool is_uslam(const YamlReader& root) {
  const auto cameras = root.find("cameras");
  if (!cameras || root.find("edged_rig")) return false;
  const std::vector<YamlReader> items = cameras->items();
  return !items.empty() && items.front().find("camera");
}

/// A format of calibrations.
struct CalibrationFormat {
  std::string_view name = {};          ///< with its keys, for the refusal; "" where it is part of another's
  std::vector<const char*> keys = {};  ///< one of them is there
  bool (*recognizes)(const YamlReader& root) = nullptr;  ///< instead of keys
  CalibrationFile (*read)(const YamlReader& root) = nullptr;

  bool fits(const YamlReader& root) const {
    if (recognizes) return recognizes(root);
    return std::ranges::any_of(keys, [&root](const char* key) { return root.find(key).has_value(); });
  }
};

/// The formats in the order of the checks.
const std::vector<CalibrationFormat>& calibration_formats() {
  static const std::vector<CalibrationFormat> formats = {
      {.name = "edged_rig (ours)", .keys = {"edged_rig"}, .read = read_own_yaml},
      {.name = "value0 (basalt)", .keys = {"value0"}, .read = read_basalt},
      {.name = "sensor_type (EuRoC)", .keys = {"sensor_type"}, .read = read_euroc},
      {.recognizes = is_vector, .read = read_vector},
      {.name = "cam0 (Kalibr, VECtor)", .keys = {"cam0"}, .read = read_kalibr},
      {.name = "cameras (USLAM, DV)", .recognizes = is_dv_json, .read = read_dv_json},
      {.recognizes = is_uslam, .read = read_uslam},
      {.name = "camera_matrix (ROS, OpenCV, DV's xml)", .keys = {"camera_matrix"}, .read = read_camera_info},
      {.name = "projection_parameters or cam0_calib (VINS)",
       .keys = {"projection_parameters", "cam0_calib", "cam_left_calib", "event_left_calib"},
       .read = read_vins},
      {.name = "k or K (camera_info of ROS)", .recognizes = is_camera_info_message, .read = read_camera_info},
      {.name = "K (Metavision)", .recognizes = is_metavision, .read = read_metavision},
      {.keys = {"T_slave_master"}, .read = refuse_metavision_extrinsics},
      {.recognizes = is_dv_xml, .read = read_dv_xml},
  };
  return formats;
}

}  // namespace

SourcePath find_calibration(const SourcePath& folder) {
  if (const SourcePath own = folder / "calibration.yaml"; own.is_file()) return own;
  const auto mav0 = find_mav0(folder);
  if (mav0 && (*mav0 / "cam0" / "sensor.yaml").is_file()) return *mav0 / "cam0" / "sensor.yaml";
  const SourcePath tum_vi = mav0 ? mav0->parent_path() / "dso" : folder;
  for (const auto& found : {files_where(folder, is_camchain), files_where(tum_vi, is_camchain),
                            find_vector_files(folder), files_where(folder, is_named_calibration)}) {
    if (found.size() > 1)
      throw InputError::format("{}: holds several calibrations: give one of the files, {} or {}", folder.string(),
                               found[0].name(), found[1].name());
    if (found.size() == 1) return found.front();
  }
  if (const SourcePath calib = folder / "calib.txt"; calib.is_file()) return calib;
  throw InputError::format(
      "{}: no calibration found; looked for calibration.yaml, [mav0/]cam0, camchain*.yaml, VECtor's "
      "*joint_camera_extrinsic_results.yaml, *calib*.json, *calib*.xml, intrinsics.json, calib.txt",
      folder.string());
}

CalibrationFile read_calibration_file(const SourcePath& file) {
  if (starts_with_a_number(file)) return read_ecd_calib(file);
  const YamlReader root(file);
  const auto& formats = calibration_formats();
  const auto format = std::ranges::find_if(formats, [&root](const CalibrationFormat& f) { return f.fits(root); });
  if (format == formats.end()) {
    std::string keys;
    for (const CalibrationFormat& known : formats)
      if (!known.name.empty()) keys += std::string(known.name) + ", ";
    throw InputError::format("{}: no known calibration; looked for the keys {}or for 4 or 9 numbers (calib.txt)",
                             file.string(), keys);
  }
  CalibrationFile out = format->read(root);
  out.warnings = root.warnings();
  return out;
}

}  // namespace edged
