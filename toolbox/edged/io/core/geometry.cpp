// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/core/geometry.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "edged/core/check.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

std::optional<int> pixels(std::string_view text) {
  const auto value = parse_whole<int>(text);
  return value && *value >= 1 && *value <= 16384 ? value : std::nullopt;
}

}  // namespace

const RigCamera* find_camera(const Rig& rig, Modality modality, std::string_view name) {
  const auto fits = [&](const RigCamera& camera) { return camera.name == name && camera.modality == modality; };
  const auto found = std::ranges::find_if(rig.cameras, fits);
  return found == rig.cameras.end() ? rig.find(modality) : &*found;
}

std::optional<cv::Size> parse_geometry(std::string_view text) {
  const std::size_t cut = text.find('x');
  if (cut == std::string_view::npos) return std::nullopt;
  const auto width = pixels(text.substr(0, cut)), height = pixels(text.substr(cut + 1));
  return width && height ? std::optional(cv::Size(*width, *height)) : std::nullopt;
}

void warn_of_other_lens(const std::string& file, double focal_px, const Rig& rig, Modality modality,
                        std::string_view name) {
  constexpr double kTolerance = 0.02;
  const RigCamera* camera = find_camera(rig, modality, name);
  if (!camera || std::abs(focal_px / camera->model.mean_focal() - 1.0) <= kTolerance) return;
  spdlog::warn(fmt::format("{}: focal length {:.1f} px, but the rig {} has {:.1f} px: is it the right one?", file,
                           focal_px, rig.name, camera->model.mean_focal()));
}

cv::Size event_sensor_size(const std::filesystem::path& file, std::optional<cv::Size> said, const Rig* rig,
                           std::string_view name) {
  if (const RigCamera* camera = rig ? find_camera(*rig, Modality::Events, name) : nullptr) {
    const cv::Size size(camera->model.width(), camera->model.height());
    if (said && *said != size)
      spdlog::warn(fmt::format(
          "{}: the sensor has {} x {} px, but the event camera of rig {} has {} x {} px: is it the right one?",
          file.string(), said->width, said->height, rig->name, size.width, size.height));
    return size;
  }
  if (said) return *said;
  throw UnknownSensorSize(
      fmt::format("{}: does not hold the size of its sensor; give --geometry WIDTHxHEIGHT", file.string()));
}

}  // namespace edged
