// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/dataset_folders.hpp"

namespace edged {
namespace {

bool holds_sensors(const SourcePath& folder) {
  return (folder / "cam0" / "data.csv").is_file() || (folder / "imu0" / "data.csv").is_file();
}

}  // namespace

bool is_ecd_folder(const SourcePath& folder) {
  return (folder / "events.txt").is_file() || (folder / "images.txt").is_file() || (folder / "imu.txt").is_file();
}

StampedLines<FrameEntry>::Spec ecd_images(const SourcePath& folder) {
  return {folder / "images.txt", "frames", "t path", LastLine::MayLackEnd,
          [folder](std::string_view line) -> std::optional<FrameEntry> {
            FieldReader fields(line);
            const auto t = parse_seconds(fields.next());
            if (!t || fields.rest().empty()) return std::nullopt;
            return FrameEntry{*t, folder / fields.rest()};
          }};
}

std::optional<cv::Size> ecd_image_size(const SourcePath& folder) {
  constexpr int kTries = 20;
  if (!(folder / "images.txt").is_file()) return std::nullopt;
  const auto spec = ecd_images(folder);
  LineReader lines(spec.file);
  for (int i = 0; i < kTries; ++i) {
    const auto line = lines.next();
    if (!line) break;
    const auto entry = spec.parse(line->text);
    if (!entry || !entry->image.is_file()) continue;
    const cv::Mat image = read_gray_image(entry->image);
    if (!image.empty()) return image.size();
  }
  return std::nullopt;
}

std::optional<SourcePath> find_mav0(const SourcePath& folder) {
  if (holds_sensors(folder)) return folder;
  if (holds_sensors(folder / "mav0")) return folder / "mav0";
  // TUM-VI's dso folder lists the images of the mav0 beside it.
  if (folder.name() == "dso" && holds_sensors(folder.parent_path() / "mav0")) return folder.parent_path() / "mav0";
  return std::nullopt;
}

}  // namespace edged
