// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Finding and checking calibrations; printing them.
#include "edged/io/calibration.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "edged/core/check.hpp"
#include "edged/io/calib/calibration_formats.hpp"
#include "edged/io/formats.hpp"
#include "edged/io/text.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

constexpr double kLongLeverArm = 0.5;  // [m]

/// The first file of a folder, by name, that begins and ends so.
std::optional<SourcePath> find_file(const SourcePath& folder, const std::string& begin, const std::string& end) {
  for (const std::string& name : folder.names())
    if (name.starts_with(begin) && name.ends_with(end)) return folder / name;
  return std::nullopt;
}

bool starts_with_a_number(const SourcePath& file) {
  LineReader lines(file);
  const auto line = lines.next();
  return line && parse_number(FieldReader(line->text).next()).has_value();
}

Calibration read_file(const SourcePath& file) {
  if (starts_with_a_number(file)) return read_ecd_calib(file);
  const YamlReader root(file);
  if (root.find("edged_rig")) return read_own_yaml(root);
  if (root.find("cam0")) return read_kalibr(root);
  if (root.find("sensor_type")) return read_euroc(file);
  throw InputError::format(
      "{}: no known calibration; looked for the key edged_rig (ours), cam0 (Kalibr camchain) or sensor_type (EuRoC), "
      "or for "
      "4 or 9 numbers (calib.txt)",
      file.string());
}

void check(const Calibration& calibration, const SourcePath& path) {
  if (!calibration.has_extrinsics) return;
  for (const RigCamera& camera : calibration.rig.cameras) {
    const double arm = camera.T_B_C.translation().norm();
    if (arm > kLongLeverArm)
      spdlog::warn("{}: camera {} is {:.2f} m away from the IMU: is the translation in metres?", path.string(),
                   camera.name, arm);
  }
}

std::vector<fs::path> rig_folders() {
  std::vector<fs::path> folders;
  if (const char* own = std::getenv("EDGED_RIGS")) folders.emplace_back(own);
  folders.emplace_back(EDGED_RIG_FOLDER);
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) folders.push_back(program.parent_path().parent_path() / "share" / "edged" / "rigs");
  return folders;
}

std::string format_transform(const std::string& name, const SE3& T) {
  std::string out;
  const Eigen::Matrix4d m = T.matrix().array() + 0.0;  // -0 becomes 0
  for (int row = 0; row < 3; ++row)
    out += fmt::format("  {:8}[{:12.9f} {:12.9f} {:12.9f} | {:12.9f}]\n", row == 1 ? name + " = " : "", m(row, 0),
                       m(row, 1), m(row, 2), m(row, 3));
  return out;
}

/// The files to read of a folder: the calibration, and the IMU's noise where it has a file of its own.
std::pair<SourcePath, std::optional<SourcePath>> files_of_folder(const SourcePath& folder) {
  if (const SourcePath own = folder / "calibration.yaml"; own.is_file()) return {own, std::nullopt};
  const auto mav0 = find_mav0(folder);
  if (mav0 && (*mav0 / "cam0" / "sensor.yaml").is_file()) return {*mav0 / "cam0" / "sensor.yaml", std::nullopt};
  const SourcePath beside = mav0 ? mav0->parent_path() / "dso" : folder;  // where TUM-VI has it
  for (const SourcePath& place : {folder, beside})
    if (const auto camchain = place.is_folder() ? find_file(place, "camchain", ".yaml") : std::nullopt)
      return {*camchain, find_file(place, "imu", ".yaml")};
  if (const SourcePath calib = folder / "calib.txt"; calib.is_file()) return {calib, std::nullopt};
  throw InputError::format(
      "{}: no calibration found; looked for calibration.yaml, [mav0/]cam0, camchain*.yaml, calib.txt", folder.string());
}

}  // namespace

Calibration load_calibration(const SourcePath& path, const fs::path& imu_file) {
  if (!path.is_file() && !path.is_folder()) throw InputError::format("{}: no such calibration", path.string());
  auto [file, noise] = path.is_folder() ? files_of_folder(path) : std::pair(path, std::optional<SourcePath>());
  if (!imu_file.empty()) noise = imu_file;
  Calibration calibration = read_file(file);
  if (calibration.rig.name.empty()) calibration.rig.name = fs::path(file.name()).stem().string();
  if (noise) {
    calibration.imu = read_kalibr_noise(YamlReader(*noise));
    calibration.has_imu_noise = true;
  }
  check(calibration, file);
  return calibration;
}

std::vector<std::string> known_rigs() {
  std::vector<std::string> names;
  for (const fs::path& folder : rig_folders()) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
      if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

Calibration load_rig(const std::string& name_or_path) {
  for (const fs::path& folder : rig_folders())
    if (const fs::path file = folder / (name_or_path + ".yaml"); fs::exists(file)) return load_calibration(file);
  if (fs::exists(name_or_path)) return load_calibration(name_or_path);
  std::string known;
  for (const std::string& name : known_rigs()) known += (known.empty() ? "" : ", ") + name;
  throw InputError::format("rig \"{}\": not known, and no such file; there are: {}", name_or_path,
                           known.empty() ? "none (set EDGED_RIGS to a folder of rig files)" : known);
}

std::string describe(const Calibration& calibration) {
  std::string out = fmt::format("rig {}\n", calibration.rig.name);
  for (const RigCamera& camera : calibration.rig.cameras) {
    const CameraModel& m = camera.model;
    out += fmt::format("camera {} ({}): {} x {} px, fx {:.3f} fy {:.3f} cx {:.3f} cy {:.3f}, distortion {}\n",
                       camera.name, camera.modality == Modality::Events ? "events" : "frames", m.width(), m.height(),
                       m.fx(), m.fy(), m.cx(), m.cy(), to_string(m.distortion()));
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

std::string to_yaml(const Calibration& calibration) {
  const ImuNoise& n = calibration.imu;
  std::string out = fmt::format("edged_rig: 1\nname: \"{}\"\n", calibration.rig.name);
  if (calibration.has_imu_noise)
    out += fmt::format(
        "imu:\n  gyro_noise: {}  # rad/s/sqrt(Hz)\n  accel_noise: {}  # m/s^2/sqrt(Hz)\n  gyro_walk: {}  # "
        "rad/s^2/sqrt(Hz)\n  accel_walk: {}  # m/s^3/sqrt(Hz)\n  gyro_saturation: {}  # rad/s\n  accel_saturation: {}  "
        "# "
        "m/s^2\n  saturation_inflation: {}\n",
        n.gyro_noise, n.accel_noise, n.gyro_walk, n.accel_walk, n.gyro_saturation, n.accel_saturation,
        n.saturation_inflation);
  out += "cameras:\n";
  for (const RigCamera& camera : calibration.rig.cameras) {
    const CameraModel& m = camera.model;
    out +=
        fmt::format("  - name: \"{}\"\n    modality: {}\n    resolution: [{}, {}]\n    intrinsics: [{}, {}, {}, {}]\n",
                    camera.name, camera.modality == Modality::Events ? "events" : "frames", m.width(), m.height(),
                    m.fx(), m.fy(), m.cx(), m.cy());
    const auto& k = m.coefficients();
    if (m.distortion() == DistortionModel::RadTan)
      out +=
          fmt::format("    distortion: radtan\n    coefficients: [{}, {}, {}, {}, {}]\n", k[0], k[1], k[2], k[3], k[4]);
    if (m.distortion() == DistortionModel::Equidistant)
      out += fmt::format("    distortion: equidistant\n    coefficients: [{}, {}, {}, {}]\n", k[0], k[1], k[2], k[3]);
    out += "    T_B_C:  # camera to IMU: p_B = T_B_C * p_C\n";
    const Eigen::Matrix4d T = camera.T_B_C.matrix();
    for (int row = 0; row < 4; ++row)
      out += fmt::format("      - [{}, {}, {}, {}]\n", T(row, 0), T(row, 1), T(row, 2), T(row, 3));
    out += fmt::format("    time_offset: {}  # s: t_imu = t_cam + time_offset\n",
                       format_seconds(Timestamp(camera.time_offset)));
  }
  return out;
}

}  // namespace edged
