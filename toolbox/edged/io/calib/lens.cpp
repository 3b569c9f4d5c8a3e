// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/calib/calibration_readers.hpp"

#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "edged/camera/lens_table.hpp"
#include "edged/core/check.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/parse/distortion.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr double kMaxPixels = 65535;

constexpr NoiseKey kNoiseKeys[] = {
    {&ImuNoise::gyro_noise, "gyro_noise", "gyroscope_noise_density", "gyro_noise_std", "rad/s/sqrt(Hz)"},
    {&ImuNoise::accel_noise, "accel_noise", "accelerometer_noise_density", "accel_noise_std", "m/s^2/sqrt(Hz)"},
    {&ImuNoise::gyro_walk, "gyro_walk", "gyroscope_random_walk", "gyro_bias_std", "rad/s^2/sqrt(Hz)"},
    {&ImuNoise::accel_walk, "accel_walk", "accelerometer_random_walk", "accel_bias_std", "m/s^3/sqrt(Hz)"},
    {&ImuNoise::gyro_saturation, "gyro_saturation", "", "", "rad/s"},
    {&ImuNoise::accel_saturation, "accel_saturation", "", "", "m/s^2"},
    {&ImuNoise::saturation_inflation, "saturation_inflation", "", "", ""}};

bool has_any(const std::string& text, std::initializer_list<std::string_view> words) {
  return std::any_of(words.begin(), words.end(), [&text](auto w) { return text.find(w) != std::string::npos; });
}

std::string_view name_space(const Lens& lens) {
  return std::string_view(lens.topic).substr(0, lens.topic.rfind('/') + 1);
}

/// What the topic without its name space says.
std::optional<Sees> topic_sees(const Lens& lens) {
  return guess_sees(lens.topic.substr(name_space(lens).size()), lens.model.width(), lens.model.height());
}

/// Events and frames of a DAVIS were calibrated each by itself: the topic of another lens is beside that of this one,
/// and of the other kind.
bool has_partner(const Lens& lens, const std::vector<Lens>& all) {
  const auto sees = topic_sees(lens);
  return sees && !name_space(lens).empty() && std::ranges::any_of(all, [&](const Lens& other) {
           return name_space(other) == name_space(lens) && topic_sees(other).value_or(*sees) != *sees;
         });
}

Sees decide(const Lens& lens, const std::vector<Lens>& all, const CalibrationOptions& options, const SourcePath& path) {
  if (const auto said = options.sees.find(lens.name); said != options.sees.end()) return said->second;
  if (lens.sees) return *lens.sees;
  auto guess = guess_sees(lens.words, lens.model.width(), lens.model.height());
  if (guess == Sees::Both && has_partner(lens, all)) guess = topic_sees(lens);
  if (!guess && !options.otherwise)
    throw InputError::format(
        "{0}: camera {1}: its names do not show whether it is an event or a frame camera: say it with `edged calib {0} "
        "--camera {1}=events --out rig.yaml` (or =frames, or =both for a DAVIS, one lens for the two)",
        path.string(), lens.name);
  return guess ? *guess : *options.otherwise;
}

/// Names of cameras: `events` and `frames` for the first lens of both, cam1_events and cam1_frames for the next.
void add_cameras(Calibration& out, const Lens& lens, Sees sees) {
  Rig& rig = out.rig;
  RigCamera camera{lens.name, Modality::Events, lens.model, lens.T_B_C, lens.time_offset};
  const bool taken =
      std::ranges::any_of(rig.cameras, [](const RigCamera& c) { return c.name == "events" || c.name == "frames"; });
  for (const Sees one : {Sees::Events, Sees::Frames}) {
    if (sees != Sees::Both && sees != one) continue;
    camera.modality = one == Sees::Events ? Modality::Events : Modality::Frames;
    if (sees == Sees::Both) camera.name = (taken ? lens.name + "_" : "") + kind_name(camera.modality);
    rig.cameras.push_back(camera);
    if (!lens.topic.empty()) out.topics[camera.name] = lens.topic;
  }
}

/// "omni, ds, ...": the camera models of Kalibr beside pinhole.
std::string camera_model_names() {
  std::vector<std::string_view> names;
  for (const LensModel& lens : lens_models())
    if (lens.projection_parameters > 0) names.push_back(lens.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// From Kalibr's camera model with its own coefficients before the focal lengths, and a distortion, to ours, which
/// lists the coefficients of both.
void take_camera_model(const YamlReader& camera, const std::string& model, Intrinsics& in) {
  const LensModel* lens = find_lens_model(model);
  if (!lens || lens->projection_parameters == 0)
    camera.at("camera_model")
        .fail("camera model " + model + " is not supported; these are: " + camera_model_names() +
              ", and pinhole with distortion: " + lens_model_names());
  const std::size_t own = lens->projection_parameters;
  if (in.projection.size() != own + 4)
    camera.at("intrinsics")
        .fail(fmt::format("must have {} numbers for camera model {}: {} {}, fx fy cx cy", own + 4, lens->name,
                          own == 1 ? "its coefficient" : "its coefficients",
                          lens->coefficients.substr(0, lens->coefficients.find(" ["))));
  const auto begin = in.projection.begin(), end = begin + static_cast<std::ptrdiff_t>(own);
  const Distortion second = camera.checked([&] { return make_distortion(in.distortion, in.coefficients); });
  std::vector<double> coefficients(begin, end);
  if (lens->model == DistortionModel::Omni && second.model == DistortionModel::Equidistant) {
    lens = &lens_model(DistortionModel::OmniEquidistant);
    coefficients.insert(coefficients.end(), second.k.begin(), second.k.begin() + 4);
  } else if (second.k != LensCoefficients{}) {
    if (second.model != DistortionModel::RadTan || lens->max_coefficients < own + 4 || second.k[4] != 0.0)
      camera.at("camera_model")
          .fail(fmt::format("camera model {} with distortion {} is not supported{}", lens->name, in.distortion,
                            lens->max_coefficients > own ? "; with radtan (k1 k2 p1 p2), equidistant and none it is"
                                                         : "; with none it is"));
    coefficients.insert(coefficients.end(), second.k.begin(), second.k.begin() + 4);
  }
  in.projection.erase(begin, end);
  in.distortion = std::string(lens->name);
  in.coefficients = coefficients;
}

}  // namespace

std::span<const NoiseKey> noise_keys() { return kNoiseKeys; }

CameraModel make_model(const YamlReader& place, const Intrinsics& in) {
  if (in.width != std::floor(in.width) || in.height != std::floor(in.height) || !(in.width <= kMaxPixels) ||
      !(in.height <= kMaxPixels) || !(in.width >= 1) || !(in.height >= 1))
    place.fail(fmt::format("image size {} x {}: must be whole pixels, from 1 to {}", in.width, in.height, kMaxPixels));
  if (in.projection.size() != 4) place.fail("intrinsics must be [fx, fy, cx, cy]");
  return place.checked([&] {
    const Distortion distortion = make_distortion(in.distortion, in.coefficients);
    const auto& f = in.projection;
    return CameraModel(static_cast<int>(in.width), static_cast<int>(in.height), f[0], f[1], f[2], f[3],
                       distortion.model, distortion.k);
  });
}

CameraModel read_model(const YamlReader& camera, const std::string& distortion_key,
                       const std::string& coefficients_key) {
  const YamlReader resolution = camera.at("resolution"), intrinsics = camera.at("intrinsics");
  const std::vector<double> size = resolution.numbers(2, "[width, height]");
  Intrinsics in{size[0], size[1], intrinsics.numbers(), camera.text_or(distortion_key, "none"), {}};
  const auto coefficients = in.distortion == "none" ? camera.find(coefficients_key) : camera.at(coefficients_key);
  if (coefficients) in.coefficients = coefficients->numbers();
  if (const std::string model = camera.text_or("camera_model", "pinhole"); model != "pinhole")
    take_camera_model(camera, model, in);
  return make_model(intrinsics, in);
}

std::optional<Sees> parse_sees(std::string_view text) {
  if (text == "events") return Sees::Events;
  if (text == "frames") return Sees::Frames;
  if (text == "both") return Sees::Both;
  return std::nullopt;
}

std::optional<Sees> guess_sees(std::string_view words, int width, int height) {
  const std::string text = lower_case(words);
  const bool davis_size = (width == 240 && height == 180) || (width == 346 && height == 260);
  const bool images = has_any(text, {"image", "frame", "standard", "regular", "rgb", "mono", "gray", "grey", "color"});
  const bool davis = has_any(text, {"davis"});
  if (davis || has_any(text, {"event", "dvs", "dvx", "prophesee", "metavision", "evk", "e2vid", "e2calib"}))
    return davis_size && (davis || images) ? Sees::Both : Sees::Events;
  if (images) return Sees::Frames;
  return std::nullopt;
}

Calibration to_calibration(const CalibrationFile& file, const CalibrationOptions& options, const SourcePath& path) {
  for (const auto& choice : options.sees)
    if (std::ranges::find(file.lenses, choice.first, &Lens::name) == file.lenses.end())
      throw InputError::format("{}: has no camera {}; it has: {}", path.string(), choice.first,
                               fmt::join(texts_of(file.lenses, &Lens::name), ", "));
  Calibration out;
  out.rig.name = file.name.empty() ? std::filesystem::path(path.name()).stem().string() : file.name;
  out.has_extrinsics = file.has_extrinsics;
  out.has_imu_noise = file.imu.has_value();
  out.imu = file.imu.value_or(ImuNoise{});
  out.warnings = file.warnings;
  for (const Lens& lens : file.lenses) add_cameras(out, lens, decide(lens, file.lenses, options, path));
  if (out.rig.cameras.empty()) throw InputError::format("{}: holds no camera", path.string());
  for (auto camera = out.rig.cameras.begin(); camera != out.rig.cameras.end(); ++camera)
    if (std::any_of(out.rig.cameras.begin(), camera, [&](const RigCamera& c) { return c.name == camera->name; }))
      throw InputError::format("{}: two cameras are called {}: give each a name of its own", path.string(),
                               camera->name);
  return out;
}

}  // namespace edged
