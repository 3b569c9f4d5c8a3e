// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Detects the format of a folder or a file, by a table of formats for each.
#include "edged/io/open_recording.hpp"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <set>
#include <string_view>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/io/aedat/aedat.hpp"
#include "edged/io/archive/bytes.hpp"
#include "edged/io/core/dataset_folders.hpp"
#include "edged/io/event_stream/event_stream.hpp"
#include "edged/io/hdf5/hdf5.hpp"
#include "edged/io/parse/imu_table.hpp"
#include "edged/io/prophesee/raw.hpp"
#include "edged/io/ros/ros.hpp"
#include "edged/io/text/dataset_formats.hpp"
#include "edged/io/text/event_text.hpp"
#include "edged/io/text/sample_files.hpp"

namespace edged {
namespace {

Recording open_file(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options);
Recording open_archive(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options);

/// A format of files that their first bytes identify.
struct FileFormat {
  std::string_view name;  ///< for the error message
  bool (*recognizes)(ByteSpan head) = nullptr;
  Recording (*open)(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options) = nullptr;
  bool alone = false;  ///< a folder with one such file is a recording, regardless of other files
};

/// In the order of the checks. Text has no such bytes and is checked last.
constexpr std::array kFileFormats = {
    FileFormat{.name = "ROS bag", .recognizes = is_bag, .open = open_bag, .alone = true},
    FileFormat{.name = "Prophesee RAW or DAT", .recognizes = is_prophesee_file, .open = open_prophesee, .alone = true},
    FileFormat{.name = "zip", .recognizes = is_zip, .open = open_archive},
    FileFormat{.name = "HDF5", .recognizes = is_hdf5, .open = open_hdf5},
    FileFormat{.name = "AEDAT4", .recognizes = is_aedat4, .open = open_aedat4, .alone = true},
    FileFormat{.name = "Event Stream", .recognizes = is_event_stream, .open = open_event_stream, .alone = true},
    FileFormat{.name = "AEDAT 2.0 or 3.1", .recognizes = is_old_aedat, .open = open_old_aedat, .alone = true},
};

bool is_alone_format(ByteSpan head) {
  return std::ranges::any_of(kFileFormats, [head](const FileFormat& f) { return f.alone && f.recognizes(head); });
}

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

/// The name of the only file of the folder that is a recording: one of a format that is `alone`, else a plain event
/// file. Throws InputError for several.
std::optional<std::string> find_main_file(const SourcePath& folder) {
  constexpr std::size_t kHeadBytes = 4096;
  std::vector<std::string> binary, text;
  for (const std::string& name : files_in(folder)) {
    if (is_text_file(name))
      text.push_back(name);
    else if (is_alone_format((folder / name).head(kHeadBytes)))
      binary.push_back(name);
  }
  if (const auto path = folder.disk_path(); path && binary.size() > 1)
    for (const std::string& first : binary)  // the parts of a bag are one recording
      if (split_bag_parts(*path / first).size() == binary.size()) return first;
  if (!binary.empty()) return only_one(folder, binary);
  std::erase_if(text, [&folder](const std::string& name) { return !find_event_form(folder / name); });
  return only_one(folder, text);
}

/// The only text file of the folder, without those named, that holds IMU samples by its heading or its name. Of
/// several, none is chosen, with a warning.
std::optional<SourcePath> find_imu_beside(const SourcePath& folder, const std::set<std::string>& others) {
  std::vector<std::string> found = files_in(folder);
  std::erase_if(found, [&](const std::string& name) {
    return others.contains(name) || !is_text_file(name) || !holds_imu(folder / name);
  });
  if (found.size() > 1)
    spdlog::warn(fmt::format("{}: several files hold IMU samples, none is read: give one to --imu", folder.string()));
  return found.size() == 1 ? std::optional(folder / found.front()) : std::nullopt;
}

/// Logs the subfolders, and the files with data, pictures or a calibration, that are not read.
void warn_unread(const SourcePath& folder, const std::set<std::string>& read) {
  static const std::set<std::string> kData = {".csv",   ".txt", ".bag",  ".raw", ".dat", ".aedat4",
                                              ".aedat", ".h5",  ".db3",  ".zip", ".npz", ".mcap",
                                              ".npy",   ".mat", ".hdf5", ".mp4", ".avi", ".es"};
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

/// Any format on disk, but within an archive plain events only: the other formats need random access.
Recording open_main_file(const SourcePath& file, const Rig* rig, const RecordingOptions& options) {
  if (const auto path = file.disk_path()) return open_file(*path, rig, options);
  if (const auto form = find_event_form(file)) return open_event_csv(file, *form, rig, options);
  throw InputError::format("{}: only csv and txt are read within an archive: unpack it", file.string());
}

/// The calibration.yaml of the folder, if any. Logs why it cannot be used.
std::optional<Calibration> own_calibration(const SourcePath& folder) try {
  const SourcePath own = folder / "calibration.yaml";
  return own.is_file() ? std::optional(read_calibration(own)) : std::nullopt;
} catch (const InputError& e) {
  spdlog::warn(fmt::format("{}; opened without this calibration", e.what()));
  return std::nullopt;
}

/// The only recording of the folder, with the IMU file and the calibration.yaml of the folder, if any. Logs what is not
/// read.
Recording open_single_file_folder(const SourcePath& folder, const std::string& file, const Rig* rig,
                                  const RecordingOptions& options) {
  std::set<std::string> read = {file, "calibration.yaml"};
  if (const auto path = folder.disk_path())
    for (const auto& part : split_bag_parts(*path / file)) read.insert(part.filename().string());
  std::optional<Calibration> calibration = own_calibration(folder);
  RecordingOptions with_topics = options;
  if (!rig && calibration) {
    rig = &calibration->rig;
    with_topics.camera_topics = calibration->topics;
  }
  Recording recording = open_main_file(folder / file, rig, with_topics);
  const auto imu = recording.dataset->info().has_imu || !options.own_imu ? std::nullopt : find_imu_beside(folder, read);
  if (imu) {
    try {
      recording.dataset = with_imu_file(std::move(recording.dataset), *imu, options.imu_has_own_clock);
      read.insert(imu->name());
    } catch (const InputError& e) {
      spdlog::warn(e.what());
      recording = open_main_file(folder / file, rig, with_topics);
    }
  }
  if (calibration) recording.calibration = std::move(calibration);
  read.merge(external_file_names());
  warn_unread(folder, read);
  recording.dataset = with_external_files(std::move(recording.dataset), folder);
  return recording;
}

/// The folder of the first image of a camera, or the names of the images if these are in the folder of the list.
std::set<std::string> images_of(const SourcePath& folder, std::size_t camera) {
  const std::filesystem::path path =
      std::filesystem::path(first_ecd_image(folder, camera).value_or("")).lexically_normal();
  if (path.has_parent_path()) return {path.begin()->string()};
  std::set<std::string> beside;
  for (const std::string& name : folder.names())
    if (path.has_extension() && name.ends_with(path.extension().string())) beside.insert(name);
  return beside;
}

std::optional<Recording> try_bag_folder(const SourcePath& folder, const Rig* rig, const RecordingOptions& options) {
  const auto path = folder.disk_path();
  return path && is_bag_folder(*path) ? std::optional(open_bag(*path, rig, options)) : std::nullopt;
}

std::optional<Recording> try_ecd(const SourcePath& folder, const Rig* rig, const RecordingOptions& options) {
  if (!is_ecd_folder(folder)) return std::nullopt;
  // An imu.txt alone does not identify the Event-Camera Dataset if another file has the events.
  const bool imu_alone = !(folder / "events.txt").is_file() && !find_ecd_image_list(folder);
  if (const auto file = imu_alone ? find_main_file(folder) : std::nullopt)
    return open_single_file_folder(folder, *file, rig, options);
  Recording recording = open_ecd(folder, rig, options);
  // Files of further cameras are known, even if the run uses the first only.
  std::set<std::string> read;
  for (std::size_t i = 0; i == 0 || (folder / ("events" + ecd_number(i) + ".txt")).is_file(); ++i)
    read.insert("events" + ecd_number(i) + ".txt");
  for (std::size_t i = 0; const auto list = find_ecd_image_list(folder, i); ++i) {
    if (list->name() == "right_images.txt" && recording.dataset->info().more_cameras.empty()) break;
    read.merge(images_of(folder, i));
    read.insert(list->name());
  }
  read.insert({"imu.txt", "groundtruth.txt", "calib.txt", "calibration.yaml", "depthmaps.txt", "depthmaps"});
  read.merge(external_file_names());
  warn_unread(folder, read);
  recording.dataset = with_external_files(std::move(recording.dataset), folder);
  return recording;
}

std::optional<Recording> try_euroc(const SourcePath& folder, const Rig*, const RecordingOptions& options) {
  const auto mav0 = find_mav0(folder);
  if (!mav0) return std::nullopt;
  Recording recording = open_euroc(*mav0, options);
  recording.dataset = with_external_files(std::move(recording.dataset), *mav0);
  return recording;
}

std::optional<Recording> try_hdf5_folder(const SourcePath& folder, const Rig* rig, const RecordingOptions& options) {
  const auto path = folder.disk_path();
  const auto file = path ? find_hdf5_events(*path) : std::nullopt;
  if (!file) return std::nullopt;
  Recording recording = open_hdf5(*file, rig, options);
  const DatasetInfo& info = recording.dataset->info();
  const bool bare = !info.has_frames && !info.has_imu && file->parent_path() == *path;  // no data set with side files
  if (bare) return open_single_file_folder(folder, file->filename().string(), rig, options);
  if (!recording.calibration && (recording.calibration = own_calibration(folder)) && !rig)
    recording.dataset = open_hdf5(*file, &recording.calibration->rig, options).dataset;
  return recording;
}

std::optional<Recording> try_single_file_folder(const SourcePath& folder, const Rig* rig,
                                                const RecordingOptions& options) {
  const auto file = find_main_file(folder);
  return file ? std::optional(open_single_file_folder(folder, *file, rig, options)) : std::nullopt;
}

/// A format of folders that file names identify.
struct FolderFormat {
  std::string_view files;  ///< with their data set, for the error message
  /// Nothing if the folder is not of the format, or if it is in an archive and the format is read on disk only.
  std::optional<Recording> (*open)(const SourcePath& folder, const Rig* rig, const RecordingOptions& options) = nullptr;
};

/// In the order of the checks. Folders with other file names are checked last.
constexpr std::array kFolderFormats = {
    FolderFormat{.files = ".db3 or .mcap files (ROS 2)", .open = try_bag_folder},
    FolderFormat{.files = "events.txt, images.txt or imu.txt (Event-Camera Dataset, UZH-FPV)", .open = try_ecd},
    FolderFormat{.files = "[mav0/]cam0/data.csv or [mav0/]imu0/data.csv (EuRoC)", .open = try_euroc},
    FolderFormat{.files = ".h5 or .hdf5 files", .open = try_hdf5_folder},
};

std::optional<Recording> try_named_folder(const SourcePath& folder, const Rig* rig, const RecordingOptions& options) {
  for (const FolderFormat& format : kFolderFormats)
    if (auto recording = format.open(folder, rig, options)) return recording;
  return std::nullopt;
}

/// The archive is the folder of the recording, or contains it.
Recording open_archive(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options) {
  const SourcePath top = SourcePath::in_archive(file);
  for (const auto attempt : {try_named_folder, try_single_file_folder}) {
    if (auto recording = attempt(top, rig, options)) return std::move(*recording);
    std::optional<Recording> found;
    for (const std::string& name : top.names()) {
      if (!(top / name).is_folder()) continue;
      auto recording = attempt(top / name, rig, options);
      if (recording && found)
        throw InputError::format("{}: holds several recordings ({}, {}): unpack it and give one of them", file.string(),
                                 found->dataset->info().name, recording->dataset->info().name);
      if (recording) found = std::move(recording);
    }
    if (found) return std::move(*found);
  }
  throw InputError::format(
      "{}: no recording at the top of the archive or in one folder; looked for those of the Event-Camera Dataset "
      "(events.txt, images.txt, imu.txt) and EuRoC (mav0), and for a csv or txt of events; unpack any other",
      file.string());
}

Recording open_file(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options) {
  constexpr std::size_t kHeadBytes = 4096;
  const Bytes head = BinaryFile(file).read(0, kHeadBytes);
  for (const FileFormat& format : kFileFormats)
    if (format.recognizes(head)) return format.open(file, rig, options);
  if (const auto form = find_event_form(file)) return open_event_csv(file, *form, rig, options);
  std::vector<std::string_view> names;
  for (const FileFormat& format : kFileFormats) names.push_back(format.name);
  const std::string why = why_no_event_file(file);
  throw InputError::format(
      "{}: unknown file format; looked for {} and text with an event in each line (`t x y p`, or columns named in the "
      "first line; also as .gz{}). Of a recording in several files give the folder (unpack an archive other than zip "
      "first, and what is not text out of .gz)",
      file.string(), fmt::join(names, ", "), why.empty() ? why : "; " + why);
}

Recording open_folder(const std::filesystem::path& folder, const Rig* rig, const RecordingOptions& options) {
  for (const auto attempt : {try_named_folder, try_single_file_folder})
    if (auto recording = attempt(folder, rig, options)) return std::move(*recording);
  std::vector<std::string_view> files, names;
  for (const FolderFormat& format : kFolderFormats) files.push_back(format.files);
  for (const FileFormat& format : kFileFormats)
    if (format.alone) names.push_back(format.name);
  throw InputError::format("{}: no recording found; looked for {}, and for one file of {} or text of events",
                           folder.string(), fmt::join(files, "; "), fmt::join(names, ", "));
}

}  // namespace

Recording open_recording(const std::filesystem::path& path, const Rig* rig, const RecordingOptions& options) {
  if (path.string().starts_with(kTcpPrefix)) return open_aedat4_tcp(path.string(), rig, options);
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    throw InputError::format("{}: {}", path.string(),
                             std::filesystem::status_known(status) ? "no such file or folder" : error.message());
  return std::filesystem::is_directory(status) ? open_folder(path, rig, options) : open_file(path, rig, options);
}

}  // namespace edged
