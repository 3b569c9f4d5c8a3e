// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Kalibr: camchains and the noise of the IMUs. EuRoC and OpenVINS use the same keys.
#include "edged/core/check.hpp"
#include "edged/io/calib/calibration_readers.hpp"

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

ImuNoise read_kalibr_noise(const YamlReader& root) {
  const YamlReader imu = root.find("imu0").value_or(root);
  ImuNoise noise;
  noise.gyro_noise = imu.at("gyroscope_noise_density").positive();
  noise.gyro_walk = imu.at("gyroscope_random_walk").positive();
  noise.accel_noise = imu.at("accelerometer_noise_density").positive();
  noise.accel_walk = imu.at("accelerometer_random_walk").positive();
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

}  // namespace edged
