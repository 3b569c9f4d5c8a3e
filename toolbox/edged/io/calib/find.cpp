// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Finds the calibration file of a folder, and the format of a file.
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

bool is_vins(const YamlReader& root) {
  for (const char* key : {"projection_parameters", "cam0_calib", "cam_left_calib", "event_left_calib"})
    if (root.find(key)) return true;
  return false;
}

bool is_uslam(const YamlReader& root) {
  const auto cameras = root.find("cameras");
  if (!cameras || root.find("edged_rig")) return false;
  const std::vector<YamlReader> items = cameras->items();
  return !items.empty() && items.front().find("camera");
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
  const auto read = [&root]() -> CalibrationFile {
    if (root.find("edged_rig")) return read_own_yaml(root);
    if (root.find("value0")) return read_basalt(root);
    if (root.find("sensor_type")) return read_euroc(root);
    if (is_vector(root)) return read_vector(root);
    if (root.find("cam0")) return read_kalibr(root);
    if (is_dv_json(root)) return read_dv_json(root);
    if (is_uslam(root)) return read_uslam(root);
    if (root.find("camera_matrix")) return read_camera_info(root);
    if (is_vins(root)) return read_vins(root);
    if (is_metavision(root)) return read_metavision(root);
    if (root.find("T_slave_master")) refuse_metavision_extrinsics(root);
    if (is_dv_xml(root)) return read_dv_xml(root);
    throw InputError::format(
        "{}: no known calibration; looked for the keys edged_rig (ours), cam0 (Kalibr, VECtor), sensor_type (EuRoC), "
        "cameras (USLAM, DV), value0 (basalt), camera_matrix (ROS, OpenCV, DV's xml), K (Metavision), "
        "projection_parameters or cam0_calib (VINS), or for 4 or 9 numbers (calib.txt)",
        root.file().string());
  };
  CalibrationFile out = read();
  out.warnings = root.warnings();
  return out;
}

}  // namespace edged
