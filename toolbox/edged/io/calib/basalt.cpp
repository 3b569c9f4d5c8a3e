// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The json files of basalt, as TUM-VI and TUM-VIE publish them.
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "edged/io/calib/calibration_readers.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr double kUnitQuaternion = 1e-3;

/// p_imu = T_imu_cam * p_cam: T_imu_cam is T_B_C.
SE3 read_basalt_pose(const YamlReader& node) {
  const auto number = [&node](const char* key) { return node.at(key).number(); };
  const Eigen::Quaterniond q(number("qw"), number("qx"), number("qy"), number("qz"));
  if (!(std::abs(q.norm() - 1.0) <= kUnitQuaternion))
    node.fail(fmt::format("the quaternion has a norm of {:.4g}, must be 1", q.norm()));
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R = q.normalized().toRotationMatrix();
  return node.rigid({R.data(), 9}, std::array{number("px"), number("py"), number("pz")});
}

/// A camera type, the distortion that it is, and its coefficients in the order of that.
struct BasaltType {
  std::string_view name, distortion;
  std::vector<std::string> keys;
};

const std::vector<BasaltType>& basalt_types() {
  static const std::vector<BasaltType> types{
      {"pinhole", "none", {}},
      {"pinhole-radtan8", "radtan", {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}},
      {"kb4", "equidistant", {"k1", "k2", "k3", "k4"}},
      {"ds", "ds", {"xi", "alpha"}},
      {"eucm", "eucm", {"alpha", "beta"}},
      {"ucm", "eucm", {"alpha"}},  // whose beta is 1
      {"fov", "fov", {"w"}},
  };
  return types;
}

CameraModel read_basalt_camera(const YamlReader& node, const std::vector<double>& size) {
  const std::string name = node.at("camera_type").text();
  const auto type = std::ranges::find(basalt_types(), name, &BasaltType::name);
  if (type == basalt_types().end()) {
    node.at("camera_type")
        .fail(fmt::format("camera type {} is not supported; these are: {}", name,
                          fmt::join(texts_of(basalt_types(), &BasaltType::name), ", ")));
  }
  const YamlReader values = node.at("intrinsics");
  Intrinsics in{size[0], size[1], {}, std::string(type->distortion), {}};
  for (const char* key : {"fx", "fy", "cx", "cy"}) in.projection.push_back(values.at(key).number());
  for (const std::string& key : type->keys) in.coefficients.push_back(values.at(key).number());
  if (name == "ucm") in.coefficients.push_back(1.0);
  return make_model(values, in);
}

/// The cameras of TUM-VIE: left and right frames, left and right events. The file does not name them.
bool is_tum_vie(const std::vector<Lens>& lenses) {
  const auto size_is = [&lenses](std::size_t i, int width, int height) {
    return lenses[i].model.width() == width && lenses[i].model.height() == height;
  };
  return lenses.size() == 4 && size_is(0, 1024, 1024) && size_is(1, 1024, 1024) && size_is(2, 1280, 720) &&
         size_is(3, 1280, 720);
}

/// The *_std of basalt are densities in continuous time, as in ImuNoise: basalt itself multiplies them by
/// sqrt(imu_update_rate). The largest of the three axes is used.
std::optional<ImuNoise> read_basalt_noise(const YamlReader& value) {
  if (!value.find("gyro_noise_std")) return std::nullopt;
  const auto largest = [&value](const char* key) {
    const std::vector<double> axes = value.at(key).numbers();
    if (axes.empty() || *std::min_element(axes.begin(), axes.end()) <= 0) value.at(key).fail("must be above 0");
    return *std::max_element(axes.begin(), axes.end());
  };
  ImuNoise noise;
  for (const NoiseKey& key : noise_keys())
    if (*key.basalt) noise.*key.value = largest(key.basalt);
  return noise;
}

}  // namespace

CalibrationFile read_basalt(const YamlReader& root) {
  const YamlReader value = root.at("value0");
  const std::vector<YamlReader> poses = value.at("T_imu_cam").items(), intrinsics = value.at("intrinsics").items(),
                                resolutions = value.at("resolution").items();
  if (poses.size() != intrinsics.size() || poses.size() != resolutions.size())
    value.fail(fmt::format(
        "{} of T_imu_cam, {} of intrinsics and {} of resolution do not match: each camera needs one of each",
        poses.size(), intrinsics.size(), resolutions.size()));
  CalibrationFile out;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Lens lens;
    lens.name = "cam" + std::to_string(i);
    lens.model = read_basalt_camera(intrinsics[i], resolutions[i].numbers(2, "[width, height]"));
    lens.T_B_C = read_basalt_pose(poses[i]);
    // Added to the stamps of images: t_imu = t_cam + cam_time_offset_ns, the sign of time_offset.
    if (const auto offset = value.find("cam_time_offset_ns"))
      lens.time_offset = Duration(static_cast<std::int64_t>(std::clamp(offset->number(), -1e10, 1e10)));
    out.lenses.push_back(std::move(lens));
  }
  if (is_tum_vie(out.lenses)) {
    const char* const names[] = {"frames", "frames_right", "events", "events_right"};
    for (std::size_t i = 0; i < out.lenses.size(); ++i) {
      out.lenses[i].name = names[i];
      out.lenses[i].sees = i < 2 ? Sees::Frames : Sees::Events;
    }
  }
  out.imu = read_basalt_noise(value);
  return out;
}

}  // namespace edged
