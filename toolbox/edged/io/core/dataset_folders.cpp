// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/core/dataset_folders.hpp"

#include <algorithm>
#include <utility>

#include "edged/io/parse/text_table.hpp"

namespace edged {
namespace {

/// 0: time, 1: file.
std::optional<std::size_t> image_role(const ColumnName& column) {
  if (has_word(column, {"image", "images", "img", "file", "filename", "path", "name", "frame"}) &&
      !has_word(column, {"id", "index", "number"}))
    return 1;
  return names_time(column) ? std::optional<std::size_t>(0) : std::nullopt;
}

TextTable image_table(const SourcePath& list, TimeUnit unit) {
  static const TableKind kind{{"timestamp", "image_name"}, image_role, "timestamp image_name"};
  return heading_or(list, kind, {.at = {0, 1}, .unit = unit});
}

/// Stamp and file of a line. A file name in the last column may contain blanks.
std::optional<std::pair<Timestamp, std::string_view>> read_image_line(std::string_view line, const TextTable& columns) {
  FieldReader fields(line);
  std::optional<Timestamp> t;
  std::string_view file;
  for (std::size_t i = 0; i <= std::max(columns.at[0], columns.at[1]); ++i) {
    if (i == columns.at[1] && columns.at[1] > columns.at[0]) {
      file = fields.rest();
      break;
    }
    const std::string_view field = fields.next();
    if (i == columns.at[0]) t = parse_stamp(field, columns.unit);
    if (i == columns.at[1]) file = field;
  }
  if (!t || file.empty()) return std::nullopt;
  return std::pair(*t, file);
}

bool holds_sensors(const SourcePath& folder) {
  return (folder / "cam0" / "data.csv").is_file() || (folder / "imu0" / "data.csv").is_file();
}

}  // namespace

bool is_ecd_folder(const SourcePath& folder) {
  return (folder / "events.txt").is_file() || find_ecd_image_list(folder) || (folder / "imu.txt").is_file();
}

std::string ecd_number(std::size_t camera) { return camera == 0 ? "" : std::to_string(camera + 1); }

std::optional<SourcePath> find_ecd_image_list(const SourcePath& folder, std::size_t camera) {
  std::vector<std::string> names = {"images" + ecd_number(camera) + ".txt"};
  if (camera < 2) names.emplace_back(camera == 0 ? "left_images.txt" : "right_images.txt");
  for (const std::string& name : names)
    if (SourcePath list = folder / name; list.is_file()) return list;
  return std::nullopt;
}

StampedLines<FrameEntry>::Spec image_lines(const SourcePath& list, const SourcePath& folder, TimeUnit unit) {
  const auto parse = [folder, columns = image_table(list, unit)](std::string_view line) -> std::optional<FrameEntry> {
    const auto read = read_image_line(line, columns);
    if (!read) return std::nullopt;
    return FrameEntry{read->first, folder / read->second};
  };
  return {list, "frames", "t path", LastLine::MayLackEnd, parse};
}

StampedLines<FrameEntry>::Spec ecd_images(const SourcePath& folder, std::size_t camera) {
  return image_lines(find_ecd_image_list(folder, camera).value(), folder, TimeUnit::Seconds);
}

std::optional<std::string> first_ecd_image(const SourcePath& folder, std::size_t camera) {
  const auto list = find_ecd_image_list(folder, camera);
  if (!list) return std::nullopt;
  const TextTable columns = image_table(*list, TimeUnit::Seconds);
  LineReader lines(*list);
  while (const auto line = lines.next())
    if (const auto read = read_image_line(line->text, columns)) return std::string(read->second);
  return std::nullopt;
}

std::optional<cv::Size> ecd_image_size(const SourcePath& folder) {
  constexpr int kTries = 20;
  if (!find_ecd_image_list(folder)) return std::nullopt;
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
