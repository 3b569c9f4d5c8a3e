// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Kalibr: camchains and the noise of the IMUs. EuRoC and OpenVINS use the same keys.
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <span>

#include "edged/camera/lens_table.hpp"
#include "edged/core/check.hpp"
#include "edged/io/calib/calibration_readers.hpp"
#include "edged/io/calibration.hpp"
#include "edged/io/core/camera_names.hpp"

namespace edged {
namespace {

// Beyond these differences, T_cam_imu contradicts the chain of T_cn_cnm1.
constexpr double kChainRotation = 0.01;     // [rad]
constexpr double kChainTranslation = 0.01;  // [m]

/// p_cam = T_cam_imu * p_imu: the inverse of T_B_C. OpenVINS gives the inverse, T_imu_cam. p_cn = T_cn_cnm1 * p_cnm1.
std::optional<SE3> read_kalibr_pose(const YamlReader& node, const std::optional<SE3>& before) {
  std::optional<SE3> T_B_C, chained;
  if (const auto T_imu_cam = node.find("T_imu_cam")) T_B_C = T_imu_cam->transform();
  if (const auto T_cam_imu = node.find("T_cam_imu")) T_B_C = T_cam_imu->transform().inverse();
  const auto T_cn_cnm1 = node.find("T_cn_cnm1");
  if (T_cn_cnm1 && before) chained = *before * T_cn_cnm1->transform().inverse();
  if (T_B_C && chained) {
    const Vector6d difference = (T_B_C->inverse() * *chained).log();
    if (difference.head<3>().norm() > kChainTranslation || difference.tail<3>().norm() > kChainRotation)
      T_cn_cnm1->warn(fmt::format("differs from T_cam_imu by {:.3g} m and {:.3g} rad; T_cam_imu is used",
                                  difference.head<3>().norm(), difference.tail<3>().norm()));
  }
  return T_B_C ? T_B_C : chained;
}

Lens read_kalibr_camera(const YamlReader& node, const std::string& name) {
  Lens lens;
  lens.name = node.text_or("name", name);
  lens.model = read_model(node, "distortion_model", "distortion_coeffs");
  // t_imu = t_cam + timeshift_cam_imu: the sign of time_offset.
  if (const auto shift = node.find("timeshift_cam_imu")) lens.time_offset = shift->time_offset();
  lens.topic = node.text_or("rostopic", "");
  lens.words = lens.name + " " + lens.topic;
  if (const auto modality = node.find("modality")) {  // an extension of this program, not a key of Kalibr
    lens.sees = parse_sees(modality->text());
    if (!lens.sees) modality->fail("must be events, frames or both");
  }
  return lens;
}

/// What Kalibr calls a lens: the coefficients of the projection stand before the focal lengths.
struct KalibrLens {
  std::string camera_model, distortion_model;
  std::vector<double> intrinsics, distortion;
};

KalibrLens kalibr_lens(const RigCamera& camera) {
  const CameraModel& m = camera.model;
  const LensModel& lens = lens_model(m.distortion());
  const auto& k = m.coefficients();
  KalibrLens out{"pinhole", "none", {}, {}};
  if (lens.projection_parameters > 0) {
    out.camera_model = lens.name;
    out.intrinsics.assign(k.begin(), k.begin() + static_cast<std::ptrdiff_t>(lens.projection_parameters));
    const auto rest =
        std::span(k).subspan(lens.projection_parameters, lens.max_coefficients - lens.projection_parameters);
    if (std::ranges::any_of(rest, [](double c) { return c != 0.0; })) {
      out.distortion_model = "radtan";
      out.distortion.assign(rest.begin(), rest.end());
    }
  } else if (m.distortion() == DistortionModel::RadTan && k[4] == 0.0) {
    out.distortion_model = "radtan", out.distortion = {k[0], k[1], k[2], k[3]};
  } else if (m.distortion() == DistortionModel::Equidistant) {
    out.distortion_model = "equidistant", out.distortion = {k[0], k[1], k[2], k[3]};
  } else if (m.distortion() == DistortionModel::OmniEquidistant) {
    out.camera_model = "omni", out.intrinsics = {k[0]};
    out.distortion_model = "equidistant", out.distortion = {k[1], k[2], k[3], k[4]};
  } else if (m.distortion() == DistortionModel::FieldOfView) {
    out.distortion_model = "fov", out.distortion = {k[0]};
  } else if (m.distortion() != DistortionModel::None) {
    throw InputError::format("camera {}: Kalibr has no lens '{}'{}; choose another --lens, or --format edged",
                             camera.name, lens.name, m.distortion() == DistortionModel::RadTan ? " with a k3" : "");
  }
  out.intrinsics.insert(out.intrinsics.end(), {m.fx(), m.fy(), m.cx(), m.cy()});
  return out;
}

}  // namespace

CalibrationFile read_kalibr(const YamlReader& root) {
  CalibrationFile out;
  std::optional<SE3> T_B_C;
  for (int i = 0;; ++i) {
    const std::string name = "cam" + std::to_string(i);
    const auto node = root.find(name);
    if (!node) break;
    Lens lens = read_kalibr_camera(*node, name);
    T_B_C = read_kalibr_pose(*node, T_B_C);
    if (T_B_C) {
      lens.T_B_C = *T_B_C;
    } else {
      out.has_extrinsics = false;
    }
    out.lenses.push_back(std::move(lens));
  }
  return out;
}

void warn_of_imu_matrices(const YamlReader& imu) {
  constexpr double kRounding = 1e-6;
  // Of OpenVINS, and of the sensors of Kalibr's model `scale-misalignment`.
  const auto check = [](const YamlReader& sensor, std::initializer_list<const char*> keys) {
    for (const char* key : keys) {
      const auto matrix = sensor.find(key);
      const std::vector<double> v = matrix ? matrix->numbers() : std::vector<double>();
      const bool none = std::ranges::all_of(v, [](double x) { return std::abs(x) < kRounding; });
      if (v.size() != 9 || none) continue;
      const Eigen::Matrix3d M = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v.data());
      if ((M - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > kRounding)
        matrix->warn("is not applied: correct the IMU samples of the recording by it, or calibrate without it");
    }
  };
  check(imu, {"Tw", "Ta", "Tg", "R_IMUtoGYRO", "R_IMUtoACC"});
  if (const auto gyro = imu.find("gyroscopes")) check(*gyro, {"M", "A", "C_gyro_i"});
  if (const auto accel = imu.find("accelerometers")) check(*accel, {"M"});
}

ImuNoise read_kalibr_noise(const YamlReader& root) {
  const YamlReader imu = root.find("imu0").value_or(root);
  ImuNoise noise;
  for (const NoiseKey& key : noise_keys())
    if (*key.kalibr) noise.*key.value = imu.at(key.kalibr).positive();
  warn_of_imu_matrices(imu);
  return noise;
}

void refer_to_imu(const YamlReader& root, CalibrationFile& calibration) {
  const YamlReader imu = root.find("imu0").value_or(root);
  const auto T_i_b = imu.find("T_i_b"), offset = imu.find("time_offset");
  for (Lens& lens : calibration.lenses) {
    if (T_i_b) lens.T_B_C = T_i_b->transform() * lens.T_B_C;  // p_i = T_i_b * p_b, b: the IMU of the camchain
    if (offset) lens.time_offset -= offset->time_offset();    // t_b = t_i + time_offset
  }
}

std::string to_kalibr_yaml(const Calibration& calibration, bool has_poses) {
  std::string out;
  for (std::size_t i = 0; i < calibration.rig.cameras.size(); ++i) {
    const RigCamera& camera = calibration.rig.cameras[i];
    const KalibrLens lens = kalibr_lens(camera);
    out += fmt::format("cam{}:\n", i);
    if (calibration.has_extrinsics) out += "  T_cam_imu:\n" + yaml_rows(camera.T_B_C.inverse(), "  ");
    if (has_poses && i > 0)
      out += "  T_cn_cnm1:\n" + yaml_rows(camera.T_B_C.inverse() * calibration.rig.cameras[i - 1].T_B_C, "  ");
    out += fmt::format(
        "  camera_model: {}\n  distortion_coeffs: [{}]\n  distortion_model: {}\n  intrinsics: [{}]\n  resolution: [{}, "
        "{}]\n  rostopic: /{}\n  name: {}\n  modality: {}\n",
        lens.camera_model, fmt::join(lens.distortion, ", "), lens.distortion_model, fmt::join(lens.intrinsics, ", "),
        camera.model.width(), camera.model.height(), camera.name, camera.name, kind_name(camera.modality));
    if (calibration.has_extrinsics) out += fmt::format("  timeshift_cam_imu: {}\n", to_seconds(camera.time_offset));
  }
  return out;
}

}  // namespace edged
