// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Finds, checks and prints calibrations.
#include "edged/io/calibration.hpp"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "edged/camera/field_of_view.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/core/resources.hpp"
#include "edged/io/calib/calibration_readers.hpp"
#include "edged/io/core/calibration_source.hpp"
#include "edged/io/core/camera_names.hpp"

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
