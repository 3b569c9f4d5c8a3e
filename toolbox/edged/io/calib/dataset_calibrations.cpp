// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The calibrations in folders of data sets: of the Event-Camera Dataset, of EuRoC, and of VECtor. The latter is a
// folder of several files: the intrinsics of each camera, the extrinsics between the cameras
// (SCALE_joint_camera_extrinsic_results.yaml), those to the IMU (SCALE_camera_imu_extrinsic_results1.yaml), where SCALE
// is small_scale or large_scale, and the noise of the IMU.
#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/io/calib/calibration_readers.hpp"
#include "edged/io/core/dataset_folders.hpp"
#include "edged/io/parse/distortion.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr std::size_t kProjection = 4, kMostNumbers = kProjection + 14;

std::vector<double> read_row_of_numbers(const SourcePath& file) {
  std::vector<double> v;
  LineReader lines(file);
  while (const auto line = lines.next()) {
    FieldReader fields(line->text);
    for (std::string_view field = fields.next(); !field.empty(); field = fields.next()) {
      const auto number = parse_number(field);
      if (!number) throw InputError::format("{}:{}: \"{}\" is not a finite number", file.string(), line->number, field);
      v.push_back(*number);
    }
    if (v.size() > kMostNumbers) break;
  }
  const bool coefficients = v.size() >= 2 * kProjection && v.size() <= kMostNumbers;
  if (v.size() != kProjection && !coefficients)
    throw InputError::format("{}: has {}{} numbers; `fx fy cx cy [k1 k2 p1 p2 k3]` has 4 or 9", file.string(),
                             v.size() > kMostNumbers ? "more than " : "", std::min(v.size(), kMostNumbers));
  return v;
}

constexpr const char* kJoint = "joint_camera_extrinsic_results";
constexpr const char* kToImu = "camera_imu_extrinsic_results";
constexpr const char* kImuNoise = "imu_intrinsic_results";

/// cam0 to cam3 of the extrinsics.
struct VectorCamera {
  const char* name;
  const char* file;
  Sees sees;
};
constexpr VectorCamera kVectorCameras[] = {{"frames", "left_regular_camera_intrinsic_results", Sees::Frames},
                                           {"frames_right", "right_regular_camera_intrinsic_results", Sees::Frames},
                                           {"events", "left_event_camera_intrinsic_results", Sees::Events},
                                           {"events_right", "right_event_camera_intrinsic_results", Sees::Events}};

/// The yaml files whose names begin so, sorted. Some archives repeat the extension .yaml.
std::vector<SourcePath> vector_files(const SourcePath& folder, const std::string& begin) {
  std::vector<SourcePath> out;
  for (const std::string& name : folder.names())
    if (name.starts_with(begin) && name.ends_with(".yaml")) out.push_back(folder / name);
  return out;
}

/// "small_scale_", "large_scale_" or "".
std::string vector_scale(const SourcePath& file) {
  const std::string name = file.name();
  const std::size_t end = std::min(name.find(kJoint), name.find(kToImu));
  return end == std::string::npos ? "" : name.substr(0, end);
}

/// A file in the folder of root. Throws InputError, with the missing content, if there is none.
YamlReader need_vector_file(const YamlReader& root, const std::string& begin, const std::string& what) {
  const SourcePath folder = root.file().parent_path();
  const std::vector<SourcePath> found = vector_files(folder, begin);
  if (found.empty()) throw InputError::format("{}: has no {}*.yaml, which holds {}", folder.string(), begin, what);
  return root.other_file(found.front());
}

}  // namespace

CalibrationFile read_ecd_calib(const SourcePath& file) {
  const std::vector<double> v = read_row_of_numbers(file);
  const auto size = ecd_image_size(file.parent_path()).value_or(cv::Size(kEcdWidth, kEcdHeight));
  Lens lens;
  lens.name = "davis", lens.sees = Sees::Both;
  try {
    const Distortion lens_distortion =
        v.size() == kProjection ? Distortion() : make_distortion("radtan", {v.begin() + kProjection, v.end()});
    lens.model = CameraModel(size.width, size.height, v[0], v[1], v[2], v[3], lens_distortion.model, lens_distortion.k);
  } catch (const InputError& e) {
    throw InputError::format("{}: {}", file.string(), e.what());
  }
  return {.name = "calib.txt", .lenses = {lens}, .has_extrinsics = false};
}

CalibrationFile read_euroc(const YamlReader& root) {
  if (root.at("sensor_type").text() != "camera") root.at("sensor_type").fail("must be camera: give cam0/sensor.yaml");
  const SourcePath folder = root.file().parent_path();
  Lens lens;
  lens.name = folder.name();
  lens.sees = guess_sees(lens.name, 0, 0).value_or(Sees::Frames);  // the format has frame cameras only
  lens.model = read_model(root, "distortion_model", "distortion_coefficients");
  lens.T_B_C = root.at("T_BS").transform();  // p_B = T_BS * p_S: T_BS is T_B_C, as the IMU is the body

  CalibrationFile out;
  const SourcePath mav0 = folder.parent_path();
  out.name = (mav0.name() == "mav0" ? mav0.parent_path() : mav0).name();
  const SourcePath imu_file = mav0 / "imu0" / "sensor.yaml";
  if (imu_file.is_file()) {
    const YamlReader imu = root.other_file(imu_file);
    out.imu = read_kalibr_noise(imu);
    lens.T_B_C = imu.at("T_BS").transform().inverse() * lens.T_B_C;
  }
  out.lenses = {lens};
  return out;
}

bool is_vector(const YamlReader& root) {
  for (const char* key : {"cam1", "cam2", "cam3"})
    if (const auto camera = root.find(key); camera && camera->find(std::string("T_cam0_") + key)) return true;
  const auto first = root.find("cam0");
  return first && first->find("T_cam_imu") && !first->find("intrinsics");
}

std::vector<SourcePath> find_vector_files(const SourcePath& folder) {
  std::vector<SourcePath> found;
  for (const char* scale : {"small_scale_", "large_scale_", ""})
    for (const SourcePath& file : vector_files(folder, std::string(scale) + kJoint)) found.push_back(file);
  return found;
}

CalibrationFile read_vector(const YamlReader& root) {
  const std::string scale = vector_scale(root.file());
  const SourcePath folder = root.file().parent_path();
  const YamlReader joint = need_vector_file(root, scale + kJoint, "the extrinsics between the cameras");
  const YamlReader to_imu = need_vector_file(root, scale + kToImu, "the extrinsics from the cameras to the IMU");
  const SE3 T_B_cam0 = to_imu.at("cam0").at("T_cam_imu").transform().inverse();  // in the convention of Kalibr
  CalibrationFile out;
  out.name = "vector_" + (scale.empty() ? "rig" : scale.substr(0, scale.size() - 1));
  for (std::size_t i = 0; i < std::size(kVectorCameras); ++i) {
    const std::vector<SourcePath> files = vector_files(folder, kVectorCameras[i].file);
    if (files.empty()) continue;
    Lens lens = read_camera_info(root.other_file(files.front())).lenses.front();
    lens.name = kVectorCameras[i].name;
    lens.sees = kVectorCameras[i].sees;
    const std::string key = "cam" + std::to_string(i);
    lens.T_B_C = T_B_cam0;
    if (i > 0) lens.T_B_C = T_B_cam0 * joint.at(key).at("T_cam0_" + key).transform();  // p_cam0 = T_cam0_camN * p_camN
    out.lenses.push_back(std::move(lens));
  }
  if (out.lenses.empty()) throw InputError::format("{}: has no *_camera_intrinsic_results.yaml", folder.string());
  if (const auto noise = vector_files(folder, kImuNoise); !noise.empty()) {
    const YamlReader imu = root.other_file(noise.front());
    if (imu.find("gyroscope_noise_density")) {
      out.imu = read_kalibr_noise(imu);
    } else {
      imu.warn("has no gyroscope_noise_density: the IMU's noise is not read from it");
    }
  }
  return out;
}

}  // namespace edged
