// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/calib/calibration_readers.hpp"

#include <spdlog/fmt/fmt.h>

#include <utility>

#include "edged/core/check.hpp"
#include "edged/io/parse/image_codec.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

std::size_t pixels_of(const CameraModel& camera) {
  return static_cast<std::size_t>(camera.width()) * static_cast<std::size_t>(camera.height());
}

}  // namespace

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

double ignored_share(const CameraModel& camera) {
  std::size_t ignored = 0;
  for (int y = 0; y < camera.height(); ++y)
    for (int x = 0; x < camera.width(); ++x) ignored += camera.uses(x, y) ? 0 : 1;
  return static_cast<double>(ignored) / static_cast<double>(pixels_of(camera));
}

}  // namespace edged
