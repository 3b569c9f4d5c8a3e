// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Finds the calibration file of a folder and the format of a file; reads, checks and prints calibrations.
#include "edged/io/calibration.hpp"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <functional>
#include <sstream>

#include "edged/camera/field_of_view.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/core/resources.hpp"
#include "edged/io/calib/calibration_readers.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/core/dataset_folders.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

/// The first imu*.yaml in the folder of a file.
std::optional<SourcePath> imu_file_beside(const SourcePath& file) {
  const SourcePath folder = file.parent_path();
  for (const std::string& name : folder.names())
    if (name.starts_with("imu") && name.ends_with(".yaml")) return folder / name;
  return std::nullopt;
}

std::string format_transform(const std::string& name, const SE3& T) {
  std::string out;
  const Eigen::Matrix4d m = T.matrix().array() + 0.0;  // -0 becomes 0
  for (int row = 0; row < 3; ++row)
    out += fmt::format("  {:8}[{:12.9f} {:12.9f} {:12.9f} | {:12.9f}]\n", row == 1 ? name + " = " : "", m(row, 0),
                       m(row, 1), m(row, 2), m(row, 3));
  return out;
}

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

/// The calibration file of a folder (docs/calibration.md). Throws InputError if it has none or several.
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

/// Detects the format by the content.
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

/// The share of all pixels of the camera.
double ignored_share(const CameraModel& camera) {
  std::size_t ignored = 0;
  for (int y = 0; y < camera.height(); ++y)
    for (int x = 0; x < camera.width(); ++x) ignored += camera.uses(x, y) ? 0 : 1;
  return static_cast<double>(ignored) / (static_cast<double>(camera.width()) * camera.height());
}

}  // namespace

Calibration read_calibration(const SourcePath& path, const CalibrationOptions& options) {
  if (!path.is_file() && !path.is_folder()) throw InputError::format("{}: no such calibration", path.string());
  const SourcePath file = path.is_folder() ? find_calibration(path) : path;
  std::optional<SourcePath> imu_file;
  if (path.is_folder() && file.name().starts_with("camchain")) imu_file = imu_file_beside(file);
  if (!options.imu_file.empty()) imu_file = options.imu_file;
  CalibrationFile read = read_calibration_file(file);
  if (imu_file) {
    const YamlReader imu(*imu_file);
    read.imu = read_kalibr_noise(imu);
    refer_to_imu(imu, read);
    read.warnings.insert(read.warnings.end(), imu.warnings().begin(), imu.warnings().end());
  }
  Calibration calibration = to_calibration(read, options, file);
  for (std::string& warning : implausibilities(calibration, file)) calibration.warnings.push_back(std::move(warning));
  for (const std::string& warning : calibration.warnings) spdlog::warn(warning);
  return calibration;
}

Calibration load_calibration(const fs::path& path, const CalibrationOptions& options) {
  return read_calibration(path, options);
}

std::vector<std::string> known_rigs() {
  std::vector<std::string> names;
  for (const fs::path& file : resources("rigs", ".yaml")) names.push_back(file.stem().string());
  return names;
}

Calibration load_rig(const std::string& name_or_path) {
  if (const auto file = find_resource("rigs", name_or_path, ".yaml")) return load_calibration(*file);
  if (fs::exists(name_or_path)) return load_calibration(name_or_path);
  std::vector<std::string> known = known_rigs();
  if (known.empty()) known = {"none (set EDGED_RIGS to a folder of rig files)"};
  throw InputError::format("rig \"{}\": not known, and no such file; there are: {}", name_or_path,
                           fmt::join(known, ", "));
}

std::string describe(const Calibration& calibration) {
  std::string out = fmt::format("rig {}\n", calibration.rig.name);
  for (const RigCamera& camera : calibration.rig.cameras) {
    const CameraModel& m = camera.model;
    out += fmt::format("camera {} ({}): {} x {} px, fx {:.3f} fy {:.3f} cx {:.3f} cy {:.3f}, distortion {}\n",
                       camera.name, kind_name(camera.modality), m.width(), m.height(), m.fx(), m.fy(), m.cx(), m.cy(),
                       to_string(m.distortion()));
    const FieldOfView view = field_of_view(m);
    out += fmt::format("  field of view {:.1f} deg across, {:.1f} deg down, {:.1f} deg corner to corner\n",
                       view.horizontal * kDegreesPerRadian, view.vertical * kDegreesPerRadian,
                       view.diagonal * kDegreesPerRadian);
    if (const auto limit = m.view_limit())
      out += fmt::format("  used up to {:.0f} deg off its axis\n", *limit * kDegreesPerRadian);
    if (m.is_masked()) out += fmt::format("  mask: {:.1f} % of its pixels are ignored\n", 100.0 * ignored_share(m));
    if (!calibration.has_extrinsics) {
      out += "  pose on the body and time offset: unknown\n";
      continue;
    }
    const Eigen::Vector3d p = camera.T_B_C.translation();
    out += "  camera to body (IMU), p_B = T_B_C * p_C; the last column is where the camera is, seen from the IMU [m]\n";
    out += format_transform("T_B_C", camera.T_B_C);
    out += "  body (IMU) to camera, p_C = T_C_B * p_B\n";
    out += format_transform("T_C_B", camera.T_B_C.inverse());
    out +=
        fmt::format("  lever arm {:.4f} m; t_imu = t_cam {:+.3f} ms\n", p.norm(), to_seconds(camera.time_offset) * 1e3);
  }
  const ImuNoise& n = calibration.imu;
  out += fmt::format(
      "IMU{}: gyro noise {:g} rad/s/sqrt(Hz), walk {:g} rad/s^2/sqrt(Hz), range {:g} rad/s; accel noise {:g} "
      "m/s^2/sqrt(Hz), walk {:g} m/s^3/sqrt(Hz), range {:g} m/s^2\n",
      calibration.has_imu_noise ? "" : " (defaults)", n.gyro_noise, n.gyro_walk, n.gyro_saturation, n.accel_noise,
      n.accel_walk, n.accel_saturation);
  return out;
}

}  // namespace edged
