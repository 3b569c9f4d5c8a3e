// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// One reader per calibration format. Each says which way its transform points.
#include "edged/io/calib/calibration_formats.hpp"

#include <cmath>

#include "edged/core/check.hpp"
#include "edged/io/formats.hpp"
#include "edged/io/text.hpp"

namespace edged {
namespace {

struct Distortion {
  DistortionModel model = DistortionModel::None;
  std::array<double, 5> k{};
};

Distortion read_distortion(const YamlReader& camera, const std::string& model_key, const std::string& numbers_key) {
  Distortion out;
  const auto model = camera.find(model_key);
  const std::string name = model ? model->text() : "none";
  if (name == "none") return out;
  const YamlReader list = camera.at(numbers_key);
  const std::vector<double> k = list.numbers();
  if (name == "radtan" || name == "radial-tangential" || name == "plumb_bob") {
    out.model = DistortionModel::RadTan;
    if (k.size() != 4 && k.size() != 5) list.fail("radtan takes 4 or 5 numbers: k1 k2 p1 p2 [k3]");
  } else if (name == "equidistant") {
    out.model = DistortionModel::Equidistant;
    if (k.size() != 4) list.fail("equidistant takes 4 numbers: k1 k2 k3 k4");
  } else {
    model->fail("distortion " + name + " is not supported; radtan, equidistant and none are");
  }
  std::copy(k.begin(), k.end(), out.k.begin());
  return out;
}

CameraModel read_model(const YamlReader& camera, const Distortion& distortion) {
  if (const auto model = camera.find("camera_model"); model && model->text() != "pinhole")
    model->fail("camera model " + model->text() + " is not supported; pinhole is");
  const YamlReader resolution = camera.at("resolution"), intrinsics = camera.at("intrinsics");
  const std::vector<double> size = resolution.numbers(), f = intrinsics.numbers();
  if (size.size() != 2 || size[0] != std::floor(size[0]) || size[1] != std::floor(size[1]) || size[0] > 65535 ||
      size[1] > 65535)
    resolution.fail("must be [width, height] in whole pixels");
  if (f.size() != 4) intrinsics.fail("must be [fx, fy, cx, cy]");
  try {
    return CameraModel(static_cast<int>(size[0]), static_cast<int>(size[1]), f[0], f[1], f[2], f[3], distortion.model,
                       distortion.k);
  } catch (const InputError& e) {
    intrinsics.fail(e.what());
  }
}

Modality read_modality(const YamlReader& value) {
  const std::string text = value.text();
  if (text == "events") return Modality::Events;
  if (text == "frames") return Modality::Frames;
  value.fail("must be events or frames");
}

double positive(const YamlReader& value) {
  const double x = value.number();
  if (x <= 0) value.fail("must be above 0");
  return x;
}

ImuNoise read_own_noise(const YamlReader& imu) {
  imu.allow_only({"gyro_noise", "accel_noise", "gyro_walk", "accel_walk", "gyro_saturation", "accel_saturation",
                  "saturation_inflation"});
  ImuNoise noise;
  const auto take = [&imu](const char* key, double& field) {
    if (const auto value = imu.find(key)) field = positive(*value);
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

RigCamera read_own_camera(const YamlReader& node, const Rig& before) {
  node.allow_only({"name", "modality", "same_as", "camera_model", "resolution", "intrinsics", "distortion",
                   "coefficients", "T_B_C", "T_C_B", "time_offset"});
  RigCamera camera;
  const auto base = node.find("same_as");
  if (base) {
    for (const char* key : {"resolution", "intrinsics", "distortion", "coefficients", "T_B_C", "T_C_B", "time_offset"})
      if (const auto extra = node.find(key)) extra->fail("cannot stand beside same_as");
    try {
      camera = before.camera(base->text());
    } catch (const InputError& e) {
      base->fail(std::string("must name a camera above; ") + e.what());
    }
  }
  camera.name = node.at("name").text();
  camera.modality = read_modality(node.at("modality"));
  if (base) return camera;

  camera.model = read_model(node, read_distortion(node, "distortion", "coefficients"));
  const auto T_B_C = node.find("T_B_C"), T_C_B = node.find("T_C_B");
  if (T_B_C.has_value() == T_C_B.has_value())
    node.fail("needs one of T_B_C (camera to IMU, p_B = T_B_C * p_C) and T_C_B (its inverse)");
  camera.T_B_C = T_B_C ? T_B_C->transform() : T_C_B->transform().inverse();
  if (const auto offset = node.find("time_offset")) camera.time_offset = duration_from_seconds(offset->number());
  return camera;
}

}  // namespace

Calibration read_own_yaml(const YamlReader& root) {
  root.allow_only({"edged_rig", "name", "imu", "cameras"});
  if (root.at("edged_rig").text() != "1") root.at("edged_rig").fail("only version 1 of the format is known");
  Calibration out;
  if (const auto name = root.find("name")) out.rig.name = name->text();
  const auto imu = root.find("imu");
  out.has_imu_noise = imu.has_value();
  if (imu) out.imu = read_own_noise(*imu);
  for (const YamlReader& node : root.at("cameras").items()) {
    RigCamera camera = read_own_camera(node, out.rig);
    for (const RigCamera& other : out.rig.cameras)
      if (other.name == camera.name) node.at("name").fail("the name " + camera.name + " is taken by a camera above");
    out.rig.cameras.push_back(std::move(camera));
  }
  if (out.rig.cameras.empty()) root.at("cameras").fail("must list a camera");
  return out;
}

Calibration read_kalibr(const YamlReader& root) {
  Calibration out;
  out.has_imu_noise = false;
  for (int i = 0;; ++i) {
    const auto node = root.find("cam" + std::to_string(i));
    if (!node) break;
    RigCamera camera;
    camera.name = "cam" + std::to_string(i);
    camera.model = read_model(*node, read_distortion(*node, "distortion_model", "distortion_coeffs"));
    // p_cam = T_cam_imu * p_imu: the inverse of ours. t_imu = t_cam + timeshift_cam_imu: the same as ours.
    if (const auto T_cam_imu = node->find("T_cam_imu")) {
      camera.T_B_C = T_cam_imu->transform().inverse();
    } else {
      out.has_extrinsics = false;
    }
    if (const auto shift = node->find("timeshift_cam_imu")) camera.time_offset = duration_from_seconds(shift->number());
    // Ours, unknown to Kalibr: `modality: events | frames | both`; both is a DAVIS, whose streams share one lens.
    const auto modality = node->find("modality");
    if (modality && modality->text() == "both") {
      camera.name = "events", camera.modality = Modality::Events;
      out.rig.cameras.push_back(camera);
      camera.name = "frames", camera.modality = Modality::Frames;
    } else if (modality) {
      camera.modality = read_modality(*modality);
    }
    if (const auto name = node->find("name"); name && !(modality && modality->text() == "both"))
      camera.name = name->text();
    out.rig.cameras.push_back(camera);
  }
  return out;
}

ImuNoise read_kalibr_noise(const YamlReader& root) {
  const YamlReader imu = root.find("imu0").value_or(root);
  ImuNoise noise;
  noise.gyro_noise = positive(imu.at("gyroscope_noise_density"));
  noise.gyro_walk = positive(imu.at("gyroscope_random_walk"));
  noise.accel_noise = positive(imu.at("accelerometer_noise_density"));
  noise.accel_walk = positive(imu.at("accelerometer_random_walk"));
  return noise;
}

Calibration read_euroc(const SourcePath& file) {
  const YamlReader node(file);
  if (node.at("sensor_type").text() != "camera") node.at("sensor_type").fail("must be camera: give cam0/sensor.yaml");
  const SourcePath folder = file.parent_path();
  RigCamera camera;
  camera.name = folder.name();
  camera.model = read_model(node, read_distortion(node, "distortion_model", "distortion_coefficients"));
  camera.T_B_C = node.at("T_BS").transform();  // p_B = T_BS * p_S: the same as ours while the IMU is the body

  Calibration out;
  const SourcePath mav0 = folder.parent_path();
  out.rig.name = (mav0.name() == "mav0" ? mav0.parent_path() : mav0).name();
  const SourcePath imu_file = mav0 / "imu0" / "sensor.yaml";
  out.has_imu_noise = imu_file.is_file();
  if (out.has_imu_noise) {
    const YamlReader imu(imu_file);
    out.imu = read_kalibr_noise(imu);
    camera.T_B_C = imu.at("T_BS").transform().inverse() * camera.T_B_C;
  }
  out.rig.cameras = {camera};
  return out;
}

Calibration read_ecd_calib(const SourcePath& file) {
  std::vector<double> v;
  std::size_t line_number = 1;
  LineReader lines(file);
  while (const auto line = lines.next()) {
    line_number = line->number;
    FieldReader fields(line->text);
    for (std::string_view field = fields.next(); !field.empty(); field = fields.next()) {
      const auto number = parse_number(field);
      if (!number) throw InputError::format("{}:{}: \"{}\" is not a finite number", file.string(), line_number, field);
      v.push_back(*number);
    }
  }
  if (v.size() != 4 && v.size() != 9)
    throw InputError::format("{}: has {} numbers; `fx fy cx cy [k1 k2 p1 p2 k3]` has 4 or 9", file.string(), v.size());

  const auto size = ecd_image_size(file.parent_path()).value_or(cv::Size(kEcdWidth, kEcdHeight));
  std::array<double, 5> k{};
  std::copy(v.begin() + 4, v.end(), k.begin());
  RigCamera camera{"events", Modality::Events, {}, {}, Duration(0)};
  try {
    camera.model = CameraModel(size.width, size.height, v[0], v[1], v[2], v[3],
                               v.size() == 9 ? DistortionModel::RadTan : DistortionModel::None, k);
  } catch (const InputError& e) {
    throw InputError::format("{}:{}: {}", file.string(), line_number, e.what());
  }
  Calibration out;
  out.has_extrinsics = out.has_imu_noise = false;
  out.rig.name = "calib.txt";
  out.rig.cameras = {camera, camera};
  out.rig.cameras[1].name = "frames";
  out.rig.cameras[1].modality = Modality::Frames;
  return out;
}

}  // namespace edged
