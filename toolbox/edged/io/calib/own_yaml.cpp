// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The calibration format of this program: docs/calibration.md.
#include <algorithm>
#include <cmath>

#include "edged/camera/lens_table.hpp"
#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/io/calib/calibration_readers.hpp"
#include "edged/io/calib/mask.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

ImuNoise read_own_noise(const YamlReader& imu) {
  imu.allow_only({"gyro_noise", "accel_noise", "gyro_walk", "accel_walk", "gyro_saturation", "accel_saturation",
                  "saturation_inflation"});
  ImuNoise noise;
  const auto take = [&imu](const char* key, double& field) {
    if (const auto value = imu.find(key)) field = value->positive();
  };
  take("gyro_noise", noise.gyro_noise);
  take("accel_noise", noise.accel_noise);
  take("gyro_walk", noise.gyro_walk);
  take("accel_walk", noise.accel_walk);
  take("gyro_saturation", noise.gyro_saturation);
  take("accel_saturation", noise.accel_saturation);
  take("saturation_inflation", noise.saturation_inflation);
  return noise;
}

Sees read_modality(const YamlReader& value) {
  const auto sees = parse_sees(value.text());
  if (!sees || *sees == Sees::Both) value.fail("must be events or frames");
  return *sees;
}

/// The earlier camera that `same_as` names.
Lens read_base(const YamlReader& node, const YamlReader& same_as, const std::vector<Lens>& above) {
  for (const char* key : {"resolution", "intrinsics", "distortion", "coefficients", "max_angle", "T_B_C", "T_C_B",
                          "q_B_C", "time_offset", "mask", "mask_runs"})
    if (const auto extra = node.find(key)) extra->fail("cannot stand beside same_as");
  const std::string name = same_as.text();
  const auto base = std::find_if(above.begin(), above.end(), [&name](const Lens& lens) { return lens.name == name; });
  if (base == above.end()) same_as.fail("must name a camera above; there is no " + name);
  return *base;
}

/// The quaternion q_B_C, which a matrix does not reproduce to the last bit. A run is repeatable only with the same
/// bits. A T_B_C that differs from q_B_C takes precedence.
void take_last_bits(const YamlReader& node, SE3& T_B_C) {
  constexpr double kSame = 1e-12;
  const std::vector<double> q = node.numbers();
  if (q.size() != 4) node.fail("must be [qw, qx, qy, qz]; it may be left out");
  const Eigen::Quaterniond exact(q[0], q[1], q[2], q[3]);
  if ((exact.coeffs() - T_B_C.rotation().coeffs()).norm() < kSame ||
      (exact.coeffs() + T_B_C.rotation().coeffs()).norm() < kSame)
    T_B_C.rotation() = exact;
}

CameraModel narrowed(const CameraModel& model, const YamlReader& angle) {
  const double degrees = angle.number();
  try {
    return model.within(degrees * kDegree);
  } catch (const InputError& e) {
    angle.fail(e.what());
  }
}

CameraModel masked(const CameraModel& model, const std::vector<std::uint8_t>& used, const YamlReader& place) {
  try {
    return model.masked(used);
  } catch (const InputError& e) {
    place.fail(e.what());
  }
}

Lens read_own_camera(const YamlReader& node, const std::vector<Lens>& above) {
  node.allow_only({"name", "modality", "same_as", "camera_model", "resolution", "intrinsics", "distortion",
                   "coefficients", "max_angle", "mask", "mask_runs", "T_B_C", "T_C_B", "q_B_C", "time_offset",
                   "topic"});
  Lens lens;
  const auto same_as = node.find("same_as");
  if (same_as) lens = read_base(node, *same_as, above);
  lens.name = node.at("name").text();
  lens.sees = read_modality(node.at("modality"));
  lens.topic = node.text_or("topic", "");
  if (same_as) return lens;

  lens.model = read_model(node, "distortion", "coefficients");
  if (const auto angle = node.find("max_angle")) lens.model = narrowed(lens.model, *angle);
  if (const auto picture = node.find("mask"))
    lens.model = masked(lens.model, read_mask(*picture, lens.model), *picture);
  if (const auto runs = node.find("mask_runs")) {
    if (node.find("mask")) runs->fail("cannot stand beside mask");
    lens.model = masked(lens.model, read_mask_runs(*runs, lens.model), *runs);
  }
  const auto T_B_C = node.find("T_B_C"), T_C_B = node.find("T_C_B");
  if (T_B_C.has_value() == T_C_B.has_value())
    node.fail("needs one of T_B_C (camera to IMU, p_B = T_B_C * p_C) and T_C_B (its inverse)");
  lens.T_B_C = T_B_C ? T_B_C->transform() : T_C_B->transform().inverse();
  if (const auto q_B_C = node.find("q_B_C")) take_last_bits(*q_B_C, lens.T_B_C);
  if (const auto offset = node.find("time_offset")) lens.time_offset = offset->time_offset();
  return lens;
}

/// A yaml string.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < ' ') {
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    } else {
      out += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
    }
  }
  return out + '"';
}

std::string pose_yaml(const RigCamera& camera) {
  std::string out = "    T_B_C:  # camera to IMU: p_B = T_B_C * p_C\n";
  const Eigen::Matrix4d T = camera.T_B_C.matrix();
  for (int row = 0; row < 4; ++row)
    out += fmt::format("      - [{}, {}, {}, {}]\n", T(row, 0), T(row, 1), T(row, 2), T(row, 3));
  const Eigen::Quaterniond& q = camera.T_B_C.rotation();
  out += fmt::format("    q_B_C: [{}, {}, {}, {}]  # rotation of T_B_C to the last bit: w x y z\n", q.w(), q.x(), q.y(),
                     q.z());
  return out + fmt::format("    time_offset: {}  # s: t_imu = t_cam + time_offset\n",
                           format_seconds(Timestamp(camera.time_offset)));
}

/// For a lens without extrinsics.
constexpr const char* kPoseToFillIn =
    "    # Camera to IMU, p_B = T_B_C * p_C: columns are the camera's x (right), y (down) and z (forward) axes in the\n"
    "    # IMU's, then its place in metres. T_C_B instead is the inverse.\n"
    "    T_B_C:\n"
    "      - [FILL_IN, FILL_IN, FILL_IN, FILL_IN]\n"
    "      - [FILL_IN, FILL_IN, FILL_IN, FILL_IN]\n"
    "      - [FILL_IN, FILL_IN, FILL_IN, FILL_IN]\n"
    "      - [0.0, 0.0, 0.0, 1.0]\n"
    "    time_offset: 0.0  # s: t_imu = t_cam + time_offset\n";

/// Degrees rounded to nine decimals. An angle that a user wrote with up to nine decimals reads back to the last bit.
double plain_degrees(double angle_rad) { return std::round(1e9 * kDegreesPerRadian * angle_rad) / 1e9; }

std::string camera_yaml(const RigCamera& camera, const std::string& topic, bool has_extrinsics) {
  const CameraModel& m = camera.model;
  std::string out =
      fmt::format("  - name: {}\n    modality: {}\n    resolution: [{}, {}]\n    intrinsics: [{}, {}, {}, {}]\n",
                  quoted(camera.name), camera.modality == Modality::Events ? "events" : "frames", m.width(), m.height(),
                  m.fx(), m.fy(), m.cx(), m.cy());
  if (!topic.empty()) out += "    topic: " + quoted(topic) + "\n";
  const auto& k = m.coefficients();
  if (const LensModel& lens = lens_model(m.distortion()); lens.max_coefficients > 0)
    out += fmt::format("    distortion: {}\n    coefficients: [{}]\n", lens.name,
                       fmt::join(std::span(k).first(lens.max_coefficients), ", "));
  const CameraModel whole(m.width(), m.height(), m.fx(), m.fy(), m.cx(), m.cy(), m.distortion(), k);
  if (m.view_limit() != whole.view_limit())
    out += fmt::format("    max_angle: {}  # deg off the axis: further out nothing is used\n",
                       plain_degrees(*m.view_limit()));
  if (m.is_masked())
    out += "    mask_runs: \"" + mask_runs(m) + "\"  # pixels used, then ignored, and so on, row by row\n";
  return out + (has_extrinsics ? pose_yaml(camera) : kPoseToFillIn);
}

}  // namespace

CalibrationFile read_own_yaml(const YamlReader& root) {
  root.allow_only({"edged_rig", "name", "imu", "cameras"});
  if (root.at("edged_rig").text() != "1") root.at("edged_rig").fail("only version 1 of the format is known");
  CalibrationFile out;
  out.name = root.text_or("name", "");
  if (const auto imu = root.find("imu")) out.imu = read_own_noise(*imu);
  for (const YamlReader& node : root.at("cameras").items()) {
    Lens lens = read_own_camera(node, out.lenses);
    for (const Lens& other : out.lenses)
      if (other.name == lens.name) node.at("name").fail("the name " + lens.name + " is taken by a camera above");
    out.lenses.push_back(std::move(lens));
  }
  if (out.lenses.empty()) root.at("cameras").fail("must list a camera");
  return out;
}

std::string to_yaml(const Calibration& calibration) {
  const ImuNoise& n = calibration.imu;
  std::string out = fmt::format("edged_rig: 1\nname: {}\n", quoted(calibration.rig.name));
  if (calibration.has_imu_noise)
    out += fmt::format(
        "imu:\n  gyro_noise: {}  # rad/s/sqrt(Hz)\n  accel_noise: {}  # m/s^2/sqrt(Hz)\n  gyro_walk: {}  # "
        "rad/s^2/sqrt(Hz)\n  accel_walk: {}  # m/s^3/sqrt(Hz)\n  gyro_saturation: {}  # rad/s\n  accel_saturation: {}  "
        "# m/s^2\n  saturation_inflation: {}\n",
        n.gyro_noise, n.accel_noise, n.gyro_walk, n.accel_walk, n.gyro_saturation, n.accel_saturation,
        n.saturation_inflation);
  out += "cameras:\n";
  for (const RigCamera& camera : calibration.rig.cameras) {
    const auto topic = calibration.topics.find(camera.name);
    out += camera_yaml(camera, topic == calibration.topics.end() ? "" : topic->second, calibration.has_extrinsics);
  }
  return out;
}

}  // namespace edged
