// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The calibration format of this program: docs/calibration.md.
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "edged/camera/lens_table.hpp"
#include "edged/core/angles.hpp"
#include "edged/io/calib/calibration_readers.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/parse/image_codec.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

ImuNoise read_own_noise(const YamlReader& imu) {
  std::vector<std::string_view> keys;
  for (const NoiseKey& key : noise_keys()) keys.emplace_back(key.own);
  imu.allow_only(keys);
  ImuNoise noise;
  for (const NoiseKey& key : noise_keys())
    if (const auto value = imu.find(key.own)) noise.*key.value = value->positive();
  return noise;
}

std::string noise_yaml(const ImuNoise& noise) {
  std::string out = "imu:\n";
  for (const NoiseKey& key : noise_keys())
    out += fmt::format("  {}: {}{}{}\n", key.own, noise.*key.value, *key.unit ? "  # " : "", key.unit);
  return out;
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
    if (const auto extra = node.find(key)) extra->fail("cannot be combined with same_as");
  const std::string name = same_as.text();
  const auto base = std::ranges::find(above, name, &Lens::name);
  if (base == above.end()) same_as.fail("must name a camera above; there is no " + name);
  return *base;
}

/// The quaternion q_B_C, which a matrix does not reproduce to the last bit. A run is repeatable only with the same
/// bits. A T_B_C that differs from q_B_C takes precedence.
void take_last_bits(const YamlReader& node, SE3& T_B_C) {
  constexpr double kSame = 1e-12;
  const std::vector<double> q = node.numbers(4, "[qw, qx, qy, qz]; it may be left out");
  const Eigen::Quaterniond exact(q[0], q[1], q[2], q[3]);
  if ((exact.coeffs() - T_B_C.rotation().coeffs()).norm() < kSame ||
      (exact.coeffs() + T_B_C.rotation().coeffs()).norm() < kSame)
    T_B_C.rotation() = exact;
}

std::size_t pixels_of(const CameraModel& camera) {
  return static_cast<std::size_t>(camera.width()) * static_cast<std::size_t>(camera.height());
}

/// The mask from a picture, whose name is relative to the calibration file: 0 where it is darker than middle grey.
/// Throws InputError if the picture is missing, unreadable, or not of the size of the camera.
std::vector<std::uint8_t> read_mask(const YamlReader& picture, const CameraModel& camera) {
  constexpr std::uint8_t kWhite = 128;  // used from this grey level on
  const std::string name = picture.text();
  const SourcePath file = std::filesystem::path(name).is_absolute() ? SourcePath(std::filesystem::path(name))
                                                                    : picture.file().parent_path() / name;
  if (!file.is_file())
    picture.fail(fmt::format("{}: no such picture; its name is relative to this file", file.string()));
  const cv::Mat image = read_gray_image(file);
  if (image.empty()) picture.fail(fmt::format("{}: cannot be read as a picture; write it as PNG", file.string()));
  if (image.cols != camera.width() || image.rows != camera.height())
    picture.fail(fmt::format("{}: has {} x {} px, the camera {} x {}: draw it on one of the camera's own pictures",
                             file.string(), image.cols, image.rows, camera.width(), camera.height()));
  std::vector<std::uint8_t> used(image.begin<std::uint8_t>(), image.end<std::uint8_t>());
  for (std::uint8_t& pixel : used) pixel = pixel < kWhite ? 0 : 255;
  return used;
}

/// The mask from run lengths: alternately numbers of used and ignored pixels, row by row, beginning with used ones.
std::vector<std::uint8_t> read_mask_runs(const YamlReader& runs, const CameraModel& camera) {
  std::vector<std::uint8_t> used;
  const std::string text = runs.text();
  FieldReader fields(text);
  std::uint8_t value = 255;
  for (std::string_view field = fields.next(); !field.empty(); field = fields.next()) {
    const auto count = parse_whole<std::size_t>(field);
    if (!count || *count > pixels_of(camera) - used.size())
      runs.fail(fmt::format("must be numbers of pixels that make up {} x {}; or give a picture, with mask",
                            camera.width(), camera.height()));
    used.insert(used.end(), *count, std::exchange(value, static_cast<std::uint8_t>(255 - value)));
  }
  if (used.size() != pixels_of(camera))
    runs.fail(fmt::format("describes {} pixels, the camera has {}", used.size(), pixels_of(camera)));
  return used;
}

/// The run lengths for read_mask_runs, in lines of bounded length.
std::string mask_runs(const CameraModel& camera) {
  constexpr std::size_t kLine = 100;  // characters
  std::string text;
  std::size_t count = 0, line = 0;
  bool used = true;
  const auto end_run = [&] {
    const std::string number = std::to_string(count);
    if (line + number.size() > kLine)
      text += "\n      ", line = 0;
    else if (!text.empty())
      text += " ";
    text += number;
    line += number.size() + 1;
    used = !used;
    count = 0;
  };
  for (int y = 0; y < camera.height(); ++y)
    for (int x = 0; x < camera.width(); ++x) {
      if (camera.uses(x, y) != used) end_run();
      ++count;
    }
  end_run();
  return text;
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
  const CameraModel& model = lens.model;
  const auto mask = node.find("mask"), runs = node.find("mask_runs");
  if (mask && runs) runs->fail("cannot be combined with mask");
  if (const auto angle = node.find("max_angle")) {
    const double limit = angle->number() * kDegree;
    lens.model = angle->checked([&] { return model.within(limit); });
  }
  if (mask) lens.model = mask->checked([&, used = read_mask(*mask, model)] { return model.masked(used); });
  if (runs) lens.model = runs->checked([&, used = read_mask_runs(*runs, model)] { return model.masked(used); });
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
  out += yaml_rows(camera.T_B_C, "      ");
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
  std::string out = fmt::format(
      "  - name: {}\n    modality: {}\n    resolution: [{}, {}]\n    intrinsics: [{}, {}, {}, {}]\n",
      quoted(camera.name), kind_name(camera.modality), m.width(), m.height(), m.fx(), m.fy(), m.cx(), m.cy());
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
    if (std::ranges::find(out.lenses, lens.name, &Lens::name) != out.lenses.end())
      node.at("name").fail("the name " + lens.name + " is taken by a camera above");
    out.lenses.push_back(std::move(lens));
  }
  if (out.lenses.empty()) root.at("cameras").fail("must list a camera");
  return out;
}

std::string to_yaml(const Calibration& calibration) {
  std::string out = fmt::format("edged_rig: 1\nname: {}\n", quoted(calibration.rig.name));
  if (calibration.has_imu_noise) out += noise_yaml(calibration.imu);
  out += "cameras:\n";
  for (const RigCamera& camera : calibration.rig.cameras) {
    const auto topic = calibration.topics.find(camera.name);
    out += camera_yaml(camera, topic == calibration.topics.end() ? "" : topic->second, calibration.has_extrinsics);
  }
  return out;
}

}  // namespace edged
