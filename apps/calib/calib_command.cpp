// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calib/calib.hpp"
#include "common/command.hpp"
#include "common/text.hpp"
#include "edged/camera/field_of_view.hpp"
#include "edged/camera/lens_table.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/io/calibration.hpp"

namespace edged {
namespace {

using nlohmann::ordered_json;

/// What the user says of a camera.
struct CameraChoice {
  Sees sees;
  std::string new_name;  ///< "": it keeps its own
};

std::map<std::string, CameraChoice> parse_cameras(const std::vector<std::string>& texts) {
  std::map<std::string, CameraChoice> out;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string value = equals == std::string::npos ? "" : text.substr(equals + 1);
    const std::size_t colon = value.find(':');
    const auto sees = parse_sees(value.substr(0, colon));
    const std::string new_name = colon == std::string::npos ? "" : value.substr(colon + 1);
    if (!sees || (colon != std::string::npos && (new_name.empty() || *sees == Sees::Both)))
      throw InputError::format(
          "--camera {}: write NAME=events, NAME=frames or NAME=both, such as cam0=events, or NAME=frames:NEW_NAME",
          text);
    out[text.substr(0, equals)] = {*sees, new_name};
  }
  return out;
}

/// Swapped names are fine, two equal ones not.
void rename_cameras(Calibration& calibration, const std::map<std::string, CameraChoice>& choices,
                    const std::string& file) {
  std::map<std::string, std::string> topics;
  std::set<std::string> names;
  for (RigCamera& camera : calibration.rig.cameras) {
    const auto topic = calibration.topics.find(camera.name);
    if (const auto choice = choices.find(camera.name); choice != choices.end() && !choice->second.new_name.empty())
      camera.name = choice->second.new_name;
    if (topic != calibration.topics.end()) topics[camera.name] = topic->second;
    if (!names.insert(camera.name).second)
      throw InputError::format("{}: --camera: two cameras would be called {}", file, camera.name);
  }
  calibration.topics = std::move(topics);
}

/// A path, else the name of a shipped rig.
Calibration load_chosen(const CalibOptions& options) {
  if (!std::filesystem::exists(options.file) && options.imu.empty() && options.cameras.empty())
    return load_rig(options.file);
  const std::map<std::string, CameraChoice> choices = parse_cameras(options.cameras);
  CalibrationOptions chosen{.imu_file = options.imu};
  for (const auto& [name, choice] : choices) chosen.sees[name] = choice.sees;
  Calibration calibration = load_calibration(options.file, chosen);
  rename_cameras(calibration, choices, options.file);
  return calibration;
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
  coefficients.resize(lens_model(m.distortion()).max_coefficients);
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

int run_calib(const CalibOptions& options) {
  Calibration calibration = load_chosen(options);
  if (!options.out.empty()) {
    calibration.rig.name = options.out.stem().string();  // found as by --rig
    write_new_file(options.out, to_yaml(calibration));
  }
  print_result(options.json, calibration_json(calibration), describe(calibration));
  if (options.json) return kExitOk;
  const std::string file = options.out.empty() ? options.file : options.out.string();
  if (!options.out.empty() && !calibration.has_extrinsics)
    tell_to_fill_in(options.out);
  else
    fmt::print("next: edged calib {} --check RECORDING\n", shell_word(file));
  return kExitOk;
}

/// --check, --refine, and the options that need a recording: for one of them or for --target.
std::vector<CLI::Option*> add_recording_options(CLI::App& calib, CalibOptions& options) {
  calib.add_option(
      "--check", options.source.recording,
      fmt::format(
          "Whether FILE, or the calibration of the recording, fits this recording: a run over its first {:.0f} s "
          "[else --from, --duration, --to], whose estimate of rotation and clock of each camera is compared with it",
          kCheckedSeconds));
  const std::size_t before = calib.get_options().size();
  add_reading_options(calib, options.source);
  calib.add_option("--mode", options.mode, "Sensors used beside the IMU; auto: all that are present")
      ->check(CLI::IsMember({"auto", "events", "frames", "fused"}))
      ->capture_default_str();
  calib.add_flag("--quiet", options.quiet, "No status line");
  const std::vector<CLI::Option*> all = calib.get_options([](const CLI::Option*) { return true; });
  calib
      .add_option(
          "--refine", options.refined,
          "Runs over these recordings, each from FILE or their own calibration: writes their joint estimate to --out")
      ->excludes("--check")
      ->type_name("RECORDING");
  return {all.begin() + static_cast<std::ptrdiff_t>(before), all.end()};
}

/// After the options that it excludes.
void add_imu_noise_option(CLI::App& calib, CalibOptions& options) {
  CLI::Option* noise =
      calib
          .add_flag(
              "--imu-noise", options.imu_noise,
              "Instead: FILE is a recording of an IMU at rest, whose noise is measured (Allan deviation); --out is a "
              "Kalibr imu yaml")
          ->needs(calib.get_option("FILE"));
  for (const char* name : {"--check", "--refine", "--target", "--camera"}) noise->excludes(calib.get_option(name));
}

/// What belongs to a recording, or to a target, stands beside one.
void check_company(const CLI::App& calib, const std::vector<CLI::Option*>& of_recordings) {
  const bool runs = calib.count("--check") + calib.count("--refine") > 0, target = calib.count("--target") > 0;
  const bool reads = runs || target || calib.count("--imu-noise") > 0;
  for (const CLI::Option* option : of_recordings)
    if (option->count() > 0 && !reads)
      throw CLI::RequiresError(option->get_name(), "--check, --refine, --target or --imu-noise");
  for (const char* name : {"--rows", "--columns", "--size", "--ratio", "--lens", "--format", "--cameras", "--no-imu",
                           "--report", "--print-target"})
    if (calib.count(name) > 0 && !target) throw CLI::RequiresError(name, "--target");
  for (const char* name : {"--rig", "--calib"})
    if (runs && calib.count(name) > 0 && calib.count("FILE") > 0) throw CLI::ExcludesError(name, "FILE");
}

int run_chosen(const CalibOptions& options) {
  if (!options.camera_of_template.empty()) return write_template(options);
  if (!options.target.print.empty()) return print_target(options);
  if (!options.target.kind.empty()) return calibrate_from_target(options);
  if (!options.refined.empty()) return refine_calibration(options);
  if (options.imu_noise) return measure_imu_noise(options);
  return options.source.recording.empty() ? run_calib(options) : check_calibration(options);
}

}  // namespace

SourceOptions CalibOptions::source_with_file() const {
  SourceOptions all = source;
  all.imu = imu;
  if (std::filesystem::exists(file))
    all.calib = file;
  else if (!file.empty())
    all.rig = file;
  return all;
}

SourceOptions CalibOptions::source_of_file() const {
  SourceOptions all = source;
  all.recording = file;
  all.imu = imu;
  return all;
}

void add_calib_command(CLI::App& app, std::function<int()>& chosen) {
  const auto options = std::make_shared<CalibOptions>();
  CLI::App* calib = app.add_subcommand(
      "calib",
      "Calibrate cameras and IMU by a target, or show, convert and check a calibration: transforms, clock, IMU noise, "
      "suspicious values");
  CLI::Option* file = calib->add_option("FILE", options->file,
                                        "Calibration file or folder (format found by content), or the name of a rig");
  calib->add_option(
      "--imu", options->imu,
      "Kalibr imu yaml: noise densities for a calibration without them. With --check or --target: IMU samples from a "
      "csv or txt, as of `edged run`");
  CLI::Option* sees =
      calib
          ->add_option("--camera", options->cameras,
                       "Modality of a camera, as NAME=events, NAME=frames or NAME=both (a DAVIS), where the file does "
                       "not state it; NAME=frames:NEW_NAME also renames it; may be repeated")
          ->allow_extra_args(false);
  calib->add_option(
      "--out", options->out,
      "Write it in our own yaml format, for --rig and --calib; with --check with the estimates of the run");
  CLI::Option* json = calib->add_flag("--json", options->json, "Print JSON");
  CLI::Option* fresh =
      calib->add_option("--new", options->camera_of_template, "Instead: a commented file to fill in for this camera")
          ->check(CLI::IsMember(template_names()))
          ->excludes(file)
          ->excludes(json);
  const std::vector<CLI::Option*> of_recordings = add_recording_options(*calib, *options);
  CLI::Option *check = calib->get_option("--check"), *refine = calib->get_option("--refine");
  for (CLI::Option* run : {check, refine}) run->excludes(fresh)->excludes(sees);
  add_target_options(*calib, options->target);
  calib->get_option("--target")->excludes(fresh)->excludes(check)->excludes(refine)->excludes(sees);
  CLI::Option* print = calib
                           ->add_option("--print-target", options->target.print,
                                        "Instead: write the target to this file, svg or pdf, in true size")
                           ->excludes(file)
                           ->excludes(check);
  add_imu_noise_option(*calib, *options);
  calib->footer(
      "Example:\n"
      "  edged calib davis240c_ecd                                    # a rig that ships\n"
      "  edged calib camchain-imucam.yaml --imu imu.yaml --out head.yaml\n"
      "  edged calib camchain.yaml --camera cam0=frames:left --camera cam1=frames:right --out head.yaml    # renamed\n"
      "  edged calib --new davis346 --out head.yaml                   # then fill in what was measured\n"
      "  edged calib head.yaml --check flight.bag                     # does it fit what was recorded with it?\n"
      "  edged calib --refine a.bag b.bag --calib head.yaml --out better.yaml\n"
      "  edged calib --target aprilgrid --size 88 --print-target grid.pdf\n"
      "  edged calib --target aprilgrid --size 88 moved.bag --out head.yaml\n"
      "  edged calib --imu-noise night.bag --out imu.yaml\n"
      "Exit codes of --check: 0 fits, 5 does not fit, 4 cannot be determined (too little motion, no start), 3 what "
      "cannot be read.");
  calib->callback([options, calib, of_recordings, file, fresh, check, refine, print, &chosen] {
    if (file->count() + fresh->count() + check->count() + refine->count() + print->count() == 0)
      throw CLI::RequiredError("FILE, --new, --check, --refine or --print-target");
    check_company(*calib, of_recordings);
    chosen = [options] { return run_chosen(*options); };
  });
}

}  // namespace edged
