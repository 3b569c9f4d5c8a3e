// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The calibration of the VECtor data set, a folder of several files: the intrinsics of each camera, the extrinsics
// between the cameras (SCALE_joint_camera_extrinsic_results.yaml), those to the IMU
// (SCALE_camera_imu_extrinsic_results1.yaml), where SCALE is small_scale or large_scale, and the noise of the IMU.
#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/io/calib/calibration_readers.hpp"

namespace edged {
namespace {

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
