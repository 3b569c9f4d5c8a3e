// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/single_file_folder.hpp"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/io/archive/bytes.hpp"
#include "edged/io/parse/imu_table.hpp"
#include "edged/io/ros/bag/bag_files.hpp"
#include "edged/io/text/event_csv.hpp"
#include "edged/io/text/sample_files.hpp"

namespace edged {
namespace {

std::vector<std::string> files_in(const SourcePath& folder) {
  std::vector<std::string> files = folder.names();
  const std::set<std::string> external = external_file_names();  // four numbers a line could be an event
  std::erase_if(files, [&](const std::string& name) { return external.contains(name) || !(folder / name).is_file(); });
  return files;
}

/// Without ".gz".
std::string extension_of(const std::filesystem::path& file) {
  const std::string last = lower_case(file.extension().string());
  return last == ".gz" ? lower_case(file.stem().extension().string()) : last;
}

bool is_text_file(const std::string& name) {
  const std::string extension = extension_of(name);
  return extension == ".csv" || extension == ".txt";
}

std::optional<std::string> only_one(const SourcePath& folder, const std::vector<std::string>& names) {
  if (names.size() > 1)
    throw InputError::format("{}: holds several recordings: give one of {}", folder.string(), fmt::join(names, ", "));
  return names.empty() ? std::nullopt : std::optional(names.front());
}

/// True if the heading names the axes of an IMU, or if the file name does and the content fits.
bool holds_imu(const SourcePath& file) try {
  return find_imu_table(file).named || lower_case(file.name()).find("imu") != std::string::npos;
} catch (const InputError&) {
  return false;
}

}  // namespace

std::optional<std::string> find_main_file(const SourcePath& folder, bool (*recognizes)(ByteSpan head)) {
  constexpr std::size_t kHeadBytes = 4096;
  std::vector<std::string> binary, text;
  for (const std::string& name : files_in(folder)) {
    if (is_text_file(name))
      text.push_back(name);
    else if (recognizes((folder / name).head(kHeadBytes)))
      binary.push_back(name);
  }
  if (const auto path = folder.disk_path(); path && binary.size() > 1)
    for (const std::string& first : binary)  // the parts of a bag are one recording
      if (split_bag_parts(*path / first).size() == binary.size()) return first;
  if (!binary.empty()) return only_one(folder, binary);
  std::erase_if(text, [&folder](const std::string& name) { return !find_event_form(folder / name); });
  return only_one(folder, text);
}

std::optional<SourcePath> find_imu_beside(const SourcePath& folder, const std::set<std::string>& others) {
  std::vector<std::string> found = files_in(folder);
  std::erase_if(found, [&](const std::string& name) {
    return others.contains(name) || !is_text_file(name) || !holds_imu(folder / name);
  });
  if (found.size() > 1)
    spdlog::warn(fmt::format("{}: several files hold IMU samples, none is read: give one to --imu", folder.string()));
  return found.size() == 1 ? std::optional(folder / found.front()) : std::nullopt;
}

void warn_unread(const SourcePath& folder, const std::set<std::string>& read) {
  static const std::set<std::string> kData = {".csv",   ".txt", ".bag",  ".raw", ".dat", ".aedat4",
                                              ".aedat", ".h5",  ".db3",  ".zip", ".npz", ".mcap",
                                              ".npy",   ".mat", ".hdf5", ".mp4", ".avi"};
  static const std::set<std::string> kCalibrations = {".yaml", ".yml", ".json", ".xml"};
  static const std::set<std::string> kPictures = {".png", ".jpg", ".jpeg", ".bmp", ".pgm"};
  std::vector<std::string> names;
  std::size_t pictures = 0;
  bool calibrations = false;
  for (const std::string& name : folder.names()) {
    const std::string lower = lower_case(name), extension = extension_of(name);
    const bool about = lower.starts_with("readme") || lower.starts_with("license") || lower.starts_with('.');
    if (about || read.contains(name)) continue;
    const bool is_folder = (folder / name).is_folder(), calibration = !is_folder && kCalibrations.contains(extension);
    calibrations |= calibration;
    if (is_folder || calibration || kData.contains(extension)) names.push_back(is_folder ? name + "/" : name);
    if (!is_folder && kPictures.contains(extension)) ++pictures;
  }
  if (pictures > 0) names.push_back(fmt::format("{} pictures", pictures));
  if (!names.empty())
    spdlog::warn(fmt::format("{}: not read: {}{}", folder.string(), fmt::join(names, ", "),
                             calibrations ? " (a calibration only where --calib names it)" : ""));
}

}  // namespace edged
