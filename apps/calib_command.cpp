// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "calib_command.hpp"

#include <spdlog/fmt/fmt.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "edged/camera/field_of_view.hpp"
#include "edged/core/check.hpp"
#include "edged/io/calibration.hpp"
#include "exit_code.hpp"

namespace edged {
namespace {

using nlohmann::ordered_json;

struct CalibOptions {
  std::string file;
  std::filesystem::path imu, out;
  std::vector<std::string> cameras;  ///< NAME=events|frames|both
  bool json = false;
};

std::map<std::string, Sees> parse_cameras(const std::vector<std::string>& texts) {
  std::map<std::string, Sees> out;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const auto sees = parse_sees(equals == std::string::npos ? "" : text.substr(equals + 1));
    if (!sees)
      throw InputError::format("--camera {}: write NAME=events, NAME=frames or NAME=both, such as cam0=events", text);
    out[text.substr(0, equals)] = *sees;
  }
  return out;
}

/// A path, else the name of a rig that ships.
Calibration load_chosen(const CalibOptions& options) {
  if (!std::filesystem::exists(options.file) && options.imu.empty() && options.cameras.empty())
    return load_rig(options.file);
  return load_calibration(options.file, {.imu_file = options.imu, .sees = parse_cameras(options.cameras)});
}

ordered_json matrix_json(const SE3& T) {
  ordered_json rows = ordered_json::array();
  const Eigen::Matrix4d m = T.matrix();
  for (int row = 0; row < 4; ++row) rows.push_back({m(row, 0), m(row, 1), m(row, 2), m(row, 3)});
  return rows;
}

ordered_json camera_json(const RigCamera& camera, bool has_extrinsics) {
  const CameraModel& m = camera.model;
  const FieldOfView view = field_of_view(m);
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  ordered_json out = {{"name", camera.name},
                      {"modality", camera.modality == Modality::Events ? "events" : "frames"},
                      {"resolution_px", {m.width(), m.height()}},
                      {"intrinsics_px", {m.fx(), m.fy(), m.cx(), m.cy()}},
                      {"distortion", to_string(m.distortion())},
                      {"coefficients", m.coefficients()},
                      {"field_of_view_deg",
                       {{"horizontal", view.horizontal * kDegrees},
                        {"vertical", view.vertical * kDegrees},
                        {"diagonal", view.diagonal * kDegrees}}}};
  if (!has_extrinsics) return out;
  out["T_B_C"] = matrix_json(camera.T_B_C);
  out["T_C_B"] = matrix_json(camera.T_B_C.inverse());
  out["lever_arm_m"] = camera.T_B_C.translation().norm();
  out["time_offset_s"] = to_seconds(camera.time_offset);
  return out;
}

ordered_json calibration_json(const Calibration& calibration) {
  ordered_json out = {{"name", calibration.rig.name},
                      {"has_extrinsics", calibration.has_extrinsics},
                      {"has_imu_noise", calibration.has_imu_noise}};
  for (const RigCamera& camera : calibration.rig.cameras)
    out["cameras"].push_back(camera_json(camera, calibration.has_extrinsics));
  const ImuNoise& n = calibration.imu;
  out["imu"] = {
      {"gyro_noise", n.gyro_noise}, {"accel_noise", n.accel_noise},         {"gyro_walk", n.gyro_walk},
      {"accel_walk", n.accel_walk}, {"gyro_saturation", n.gyro_saturation}, {"accel_saturation", n.accel_saturation}};
  out["warnings"] = calibration.warnings;
  return out;
}

void write_own(const Calibration& calibration, const std::filesystem::path& out) {
  if (!calibration.has_extrinsics)
    throw InputError::format("{}: not written: the calibration holds intrinsics only", out.string());
  if (std::filesystem::exists(out)) throw InputError::format("{}: exists; choose another name", out.string());
  std::ofstream file(out);
  file << to_yaml(calibration);
  if (!file.flush()) throw InputError::format("{}: cannot be written", out.string());
}

int run_calib(const CalibOptions& options) {
  Calibration calibration = load_chosen(options);
  if (!options.out.empty()) {
    calibration.rig.name = options.out.stem().string();  // as --rig finds it
    write_own(calibration, options.out);
  }
  if (options.json) {
    fmt::print("{}\n", calibration_json(calibration).dump(2));
  } else {
    fmt::print("{}", describe(calibration));
  }
  return kExitOk;
}

}  // namespace

void add_calib_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<CalibOptions>();
  CLI::App* calib = app.add_subcommand(
      "calib",
      "Show a calibration: both directions of each transform, field of view, clock, IMU noise, what looks wrong");
  calib->add_option("FILE", options->file, "Calibration file or folder (format found by content), or the name of a rig")
      ->required();
  calib->add_option("--imu", options->imu, "Kalibr imu yaml: noise densities for a calibration without them");
  calib
      ->add_option("--camera", options->cameras,
                   "What a camera sees, as NAME=events, NAME=frames or NAME=both (a DAVIS), where the file does not "
                   "tell; may be repeated")
      ->allow_extra_args(false);
  calib->add_option("--out", options->out, "Write it as yaml of our own, for --rig and --calib");
  calib->add_flag("--json", options->json, "Print json instead of text");
  calib->footer(
      "Example:\n"
      "  edged calib davis240c_ecd                                    # a rig that ships\n"
      "  edged calib camchain-imucam.yaml --imu imu.yaml --out head.yaml");
  calib->callback([options, &chosen] { chosen = [options] { return run_calib(*options); }; });
}

}  // namespace edged
