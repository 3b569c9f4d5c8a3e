// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "calib/calib_check.hpp"
#include "calib/calib_refine.hpp"
#include "commands.hpp"
#include "edged/camera/field_of_view.hpp"
#include "edged/camera/lens_table.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/io/calibration.hpp"

namespace edged {
namespace {

struct CameraFacts {
  const char* name;
  const char* what;
  int width, height;
  double pitch_um;  ///< of the pixels
  bool frames;      ///< from the same pixels
  const char* imu;  ///< what it has
  /// White noise: data sheet times 5 and 2.5, as in the shipped rigs, for scale, axis and sampling errors.
  double gyro_noise, accel_noise;
};

constexpr std::array kCameras = {
    CameraFacts{"davis346", "iniVation DAVIS346: events and frames of the same pixels, IMU on the board", 346, 260,
                18.5, true, "on the board; data sheet of the MPU-6500, 0.01 deg/s/sqrt(Hz) and 300 ug/sqrt(Hz)", 8.7e-4,
                7.4e-3},
    CameraFacts{"dvxplorer", "iniVation DVXplorer: events, IMU on the board (the Lite has 320 x 240 pixels of 18 um)",
                640, 480, 9.0, false,
                "on the board; data sheet of the BMI160, 0.007 deg/s/sqrt(Hz) and 180 ug/sqrt(Hz)", 6.1e-4, 4.4e-3},
    CameraFacts{
        "evk4",
        "Prophesee EVK4 (Sony IMX636): events; it has no IMU: mount one, synchronise it, give its file to --imu", 1280,
        720, 4.86, false, "one of your own; here a consumer MEMS, take its data sheet", 1e-3, 2e-2},
};

std::string imu_part(const CameraFacts& c) {
  return fmt::format(
      "imu:\n"
      "  # {}.\n"
      "  # White noise: 5 (gyro) and 2.5 times (accelerometer) the data sheet; `edged info REC` measures it where the\n"
      "  # camera lies still.\n"
      "  gyro_noise: {:.1e}        # rad/s/sqrt(Hz)\n"
      "  accel_noise: {:.1e}       # m/s^2/sqrt(Hz)\n"
      "  # Bias walk: typical of the class.\n"
      "  gyro_walk: 2.0e-5         # rad/s^2/sqrt(Hz)\n"
      "  accel_walk: 3.0e-4        # m/s^3/sqrt(Hz)\n"
      "  # Just below the ranges that the driver sets: 2000 deg/s is 34.9 rad/s, 1000 deg/s 17.45, 8 g 78.5 m/s^2.\n"
      "  gyro_saturation: FILL_IN  # rad/s\n"
      "  accel_saturation: FILL_IN # m/s^2\n",
      c.imu, c.gyro_noise, c.accel_noise);
}

/// "none; radtan: k1 k2 ...; ..."
std::string distortion_list() {
  std::string list;
  for (const LensModel& lens : lens_models())
    list += fmt::format("{}{}{}{}", list.empty() ? "" : "; ", lens.name, lens.most > 0 ? ": " : "", lens.coefficients);
  return list;
}

std::string camera_part(const CameraFacts& c) {
  return fmt::format(
      "  - name: events\n"
      "    modality: events\n"
      "    resolution: [{0}, {1}]  # px\n"
      "    # fx fy cx cy [px], from a calibration (docs/calibration.md). About: focal length of the lens / {2} um, so "
      "{3:.0f} px for\n"
      "    # 4 mm and {4:.0f} px for 8 mm; the centre near {5:.0f}, {6:.0f}.\n"
      "    intrinsics: [FILL_IN, FILL_IN, FILL_IN, FILL_IN]\n"
      "    # {7}\n"
      "    distortion: radtan\n"
      "    coefficients: [FILL_IN, FILL_IN, FILL_IN, FILL_IN]\n"
      "    # Where parts of the vehicle are in view: a picture of {0} x {1} px, black where pixels are to be ignored.\n"
      "    # mask: mask.png\n"
      "    # Camera to IMU, p_B = T_B_C * p_C: columns are the camera's x (right), y (down) and z (forward) axes in "
      "the IMU's,\n"
      "    # then its place in metres. T_C_B instead is the inverse: Kalibr's T_cam_imu.\n"
      "    T_B_C:\n"
      "      - [FILL_IN, FILL_IN, FILL_IN, FILL_IN]\n"
      "      - [FILL_IN, FILL_IN, FILL_IN, FILL_IN]\n"
      "      - [FILL_IN, FILL_IN, FILL_IN, FILL_IN]\n"
      "      - [0.0, 0.0, 0.0, 1.0]\n"
      "    # t_imu = t_cam + time_offset; Kalibr's timeshift_cam_imu. A run refines it by some milliseconds.\n"
      "    time_offset: 0.0  # s\n",
      c.width, c.height, c.pitch_um, 4e3 / c.pitch_um, 8e3 / c.pitch_um, 0.5 * (c.width - 1), 0.5 * (c.height - 1),
      distortion_list());
}

std::vector<std::string> template_names() {
  std::vector<std::string> names;
  for (const CameraFacts& camera : kCameras) names.emplace_back(camera.name);
  return names;
}

std::string calibration_template(const std::string& camera) {
  const auto facts = std::ranges::find(kCameras, camera, &CameraFacts::name);
  EDGED_CHECK(facts != kCameras.end(), "no template {}", camera);
  std::string text = fmt::format(
      "# {}.\n"
      "# Fill in what reads FILL_IN, then: edged calib FILE, edged doctor REC --calib FILE, edged run REC --calib "
      "FILE.\n"
      "# From a calibration of Kalibr, VINS, basalt ... this file is made by: edged calib THEIRS --out FILE\n"
      "edged_rig: 1\n"
      "name: {}\n\n{}\ncameras:\n{}",
      facts->what, facts->name, imu_part(*facts), camera_part(*facts));
  if (facts->frames)
    text +=
        "  # Same pixels behind the same lens.\n"
        "  - name: frames\n    modality: frames\n    same_as: events\n";
  return text;
}

using nlohmann::ordered_json;

struct CalibOptions {
  std::string camera_of_template;
  std::string file;
  std::filesystem::path imu, out;
  std::vector<std::string> cameras;  ///< NAME=events|frames|both
  SourceOptions recording;           ///< to check it against
  std::vector<std::string> refined;  ///< recordings of --refine
  std::string mode = "auto";
  bool quiet = false, json = false;
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

/// A path, else the name of a shipped rig.
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
  std::vector<double> coefficients(m.coefficients().begin(), m.coefficients().end());
  coefficients.resize(lens_model(m.distortion()).most);
  ordered_json out = {{"name", camera.name},
                      {"modality", camera.modality == Modality::Events ? "events" : "frames"},
                      {"resolution_px", {m.width(), m.height()}},
                      {"intrinsics_px", {m.fx(), m.fy(), m.cx(), m.cy()}},
                      {"distortion", to_string(m.distortion())},
                      {"coefficients", coefficients},
                      {"field_of_view_deg",
                       {{"horizontal", view.horizontal * kDegreesPerRadian},
                        {"vertical", view.vertical * kDegreesPerRadian},
                        {"diagonal", view.diagonal * kDegreesPerRadian}}}};
  if (const auto limit = m.view_limit()) out["used_up_to_deg"] = *limit * kDegreesPerRadian;
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

void write_new_file(const std::filesystem::path& out, const std::string& text) {
  if (std::filesystem::exists(out)) throw InputError::format("{}: exists; choose another name", out.string());
  std::ofstream file(out);
  file << text;
  if (!file.flush()) throw InputError::format("{}: cannot be written", out.string());
}

void tell_to_fill_in(const std::filesystem::path& out) {
  fmt::print("{0}: fill in what reads FILL_IN, then: edged calib {0}\n", out.string());
}

int write_template(const CalibOptions& options) {
  const std::string text = calibration_template(options.camera_of_template);
  if (options.out.empty()) {
    fmt::print("{}", text);
  } else {
    write_new_file(options.out, text);
    tell_to_fill_in(options.out);
  }
  return kExitOk;
}

/// FILE is a calibration as for --calib or --rig.
void take_file(const std::string& file, SourceOptions& source) {
  if (std::filesystem::exists(file)) {
    source.calib = file;
  } else if (!file.empty()) {
    source.rig = file;
  }
}

/// --imu has samples.
int run_check(const CalibOptions& options) {
  CalibCheckOptions check{options.recording, options.mode, options.out, options.quiet, options.json};
  check.source.imu = options.imu;
  take_file(options.file, check.source);
  return check_calibration(std::move(check));
}

int run_calib(const CalibOptions& options) {
  Calibration calibration = load_chosen(options);
  if (!options.out.empty()) {
    calibration.rig.name = options.out.stem().string();  // found as by --rig
    write_new_file(options.out, to_yaml(calibration));
  }
  if (options.json) {
    fmt::print("{}\n", calibration_json(calibration).dump(2));
  } else {
    fmt::print("{}", describe(calibration));
    const std::string file = options.out.empty() ? options.file : options.out.string();
    if (!options.out.empty() && !calibration.has_extrinsics)
      tell_to_fill_in(options.out);
    else
      fmt::print("next: edged calib {} --check RECORDING\n", shell_word(file));
  }
  return kExitOk;
}

int run_refine(const CalibOptions& options) {
  CalibRefineOptions refine{options.refined, options.recording, options.mode, options.out, options.quiet, options.json};
  refine.source.imu = options.imu;
  take_file(options.file, refine.source);
  return refine_calibration(refine);
}

struct RunOptionsOfCalib {
  CLI::Option *check, *refine;
  std::vector<CLI::Option*> need_either;
};

/// --check, --refine and the options that need one of them.
RunOptionsOfCalib add_run_options(CLI::App& calib, CalibOptions& options, CLI::Option* file) {
  CLI::Option* check = calib.add_option(
      "--check", options.recording.recording,
      fmt::format(
          "Whether FILE, or the calibration of the recording, fits this recording: a run over its first {:.0f} s "
          "[else --from, --duration, --to], whose estimate of rotation and clock of each camera is compared with it",
          kCheckedSeconds));
  const std::size_t before = calib.get_options().size();
  add_reading_options(calib, options.recording);
  calib.add_option("--mode", options.mode, "Sensors used beside the IMU; auto: all that are present")
      ->check(CLI::IsMember({"auto", "events", "frames", "fused"}))
      ->capture_default_str();
  calib.add_flag("--quiet", options.quiet, "No status line");
  const std::vector<CLI::Option*> all = calib.get_options([](const CLI::Option*) { return true; });
  CLI::Option* refine = calib.add_option("--refine", options.refined,
                                         "Runs over these recordings, each from FILE or their own calibration: writes "
                                         "what they found together to --out");
  refine->excludes(check)->type_name("RECORDING");
  for (const char* name : {"--rig", "--calib"}) calib.get_option(name)->excludes(file);
  return {check, refine, {all.begin() + static_cast<std::ptrdiff_t>(before), all.end()}};
}

}  // namespace

void add_calib_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<CalibOptions>();
  CLI::App* calib = app.add_subcommand(
      "calib",
      "Show a calibration: both directions of each transform, field of view, clock, IMU noise, suspicious values");
  CLI::Option* file = calib->add_option("FILE", options->file,
                                        "Calibration file or folder (format found by content), or the name of a rig");
  calib->add_option("--imu", options->imu,
                    "Kalibr imu yaml: noise densities for a calibration without them. With --check: IMU samples from a "
                    "csv or txt, as of `edged run`");
  CLI::Option* sees =
      calib
          ->add_option(
              "--camera", options->cameras,
              "Modality of a camera, as NAME=events, NAME=frames or NAME=both (a DAVIS), where the file does not "
              "tell; may be repeated")
          ->allow_extra_args(false);
  calib->add_option("--out", options->out,
                    "Write it as yaml of our own, for --rig and --calib; with --check as the run found it");
  CLI::Option* json = calib->add_flag("--json", options->json, "Print JSON");
  CLI::Option* fresh =
      calib->add_option("--new", options->camera_of_template, "Instead: a commented file to fill in for this camera")
          ->check(CLI::IsMember(template_names()))
          ->excludes(file)
          ->excludes(json);
  const RunOptionsOfCalib runs = add_run_options(*calib, *options, file);
  for (CLI::Option* run : {runs.check, runs.refine}) run->excludes(fresh)->excludes(sees);
  calib->footer(
      "Example:\n"
      "  edged calib davis240c_ecd                                    # a rig that ships\n"
      "  edged calib camchain-imucam.yaml --imu imu.yaml --out head.yaml\n"
      "  edged calib --new davis346 --out head.yaml                   # then fill in what was measured\n"
      "  edged calib head.yaml --check flight.bag                     # does it fit what was recorded with it?\n"
      "  edged calib --refine a.bag b.bag --calib head.yaml --out better.yaml\n"
      "Exit codes of --check: 0 fits, 5 does not fit, 4 cannot be determined (too little motion, no start), 3 what "
      "cannot be read.");
  calib->callback([options, file, fresh, runs, &chosen] {
    const std::size_t run = runs.check->count() + runs.refine->count();
    if (file->count() + fresh->count() + run == 0) throw CLI::RequiredError("FILE, --new, --check or --refine");
    for (const CLI::Option* option : runs.need_either)
      if (run == 0 && option->count() > 0) throw CLI::RequiresError(option->get_name(), "--check or --refine");
    chosen = [options] {
      if (!options->camera_of_template.empty()) return write_template(*options);
      if (!options->refined.empty()) return run_refine(*options);
      return options->recording.recording.empty() ? run_calib(*options) : run_check(*options);
    };
  });
}

}  // namespace edged
