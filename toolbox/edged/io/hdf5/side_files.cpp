// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The file names of each data set, and the formats of their lines. The images of a folder in the order of their names
// belong to the lines of the stamps.
#include "edged/io/hdf5/side_files.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "edged/io/parse/imu_lines.hpp"
#include "edged/io/parse/trajectory_io.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

std::optional<fs::path> first_file(const std::vector<fs::path>& candidates) {
  const auto found = std::ranges::find_if(candidates, is_file);
  return found == candidates.end() ? std::nullopt : std::optional(*found);
}

/// The images of the first folder with images, sorted by name.
std::vector<fs::path> images_in(const std::vector<fs::path>& folders) {
  std::vector<fs::path> images;
  for (const fs::path& folder : folders) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".png" || extension == ".jpg" || extension == ".jpeg") images.push_back(entry.path());
    }
    if (!images.empty()) break;
  }
  std::ranges::sort(images);
  return images;
}

/// Line k of `stamps` belongs to image k. parse returns its stamp.
StampedLines<FrameEntry>::Spec images_by_line(const fs::path& stamps, std::string layout, std::vector<fs::path> images,
                                              std::function<std::optional<Timestamp>(std::string_view)> parse) {
  const auto parse_entry = [images = std::move(images), parse = std::move(parse),
                            line = std::size_t{0}](std::string_view text) mutable -> std::optional<FrameEntry> {
    if (is_heading(text)) return std::nullopt;
    const std::size_t k = line++;
    const auto t = parse(text);
    if (!t) return std::nullopt;
    return FrameEntry{*t, k < images.size() ? images[k] : fs::path("(no image for this stamp)")};
  };
  return {stamps, "frames", std::move(layout), LastLine::MayLackEnd, parse_entry};
}

/// The stamp of a line, in microseconds unless the heading names another unit.
std::function<std::optional<Timestamp>(std::string_view)> microseconds_in(const fs::path& file) {
  static const ColumnRoles roles{
      {"timestamp"},
      [](const ColumnName& name) { return names_time(name) ? std::optional<std::size_t>(0) : std::nullopt; },
      "timestamp [us]"};
  const auto named = named_columns(file, roles);
  const std::size_t column = named ? named->at[0] : 0;
  const TimeUnit unit =
      named ? time_unit_of(named->name_of(0)).value_or(TimeUnit::Microseconds) : TimeUnit::Microseconds;
  return [column, unit](std::string_view line) {
    FieldReader fields(line);
    for (std::size_t i = 0; i < column; ++i) fields.next();
    return parse_stamp(fields.next(), unit);
  };
}

/// Start and end of the exposure in seconds.
std::optional<Timestamp> middle_of_exposure(std::string_view line) {
  FieldReader fields(line);
  const auto start = parse_seconds(fields.next()), end = parse_seconds(fields.next());
  if (!start || !end) return std::nullopt;
  return *start + (*end - *start) / 2;
}

/// Angular velocity first, as in all these data sets, unless the heading names another order.
StampedLines<ImuSample>::Spec imu_of(const fs::path& file, TimeUnit unit) {
  return documented_imu_lines(file, gyro_first(unit));
}

using ReadTrajectory = Trajectory (*)(const SourcePath&, const DamageHandler&);

TruthSource truth_lines(const fs::path& file, ReadTrajectory read, const std::string& frame) {
  const auto read_lines = [file, read, frame](Repairs& repairs) -> std::optional<GroundTruth> {
    LineDamage damage(file.string(), "groundtruth", repairs);
    GroundTruth truth{
        read(file, [&](std::size_t line, const std::string& detail) { damage.bad(line, "bad line", detail); }), frame};
    if (truth.trajectory.empty()) return std::nullopt;
    return truth;
  };
  return {frame, read_lines};
}

/// SEQUENCE/events/left/events.h5, SEQUENCE/images/timestamps.txt: the middle of the exposure of each image.
SideFiles dsec_files(const fs::path& events) {
  SideFiles files;
  const fs::path folder = fs::absolute(events).parent_path();
  for (const fs::path& root : {folder, folder.parent_path(), folder.parent_path().parent_path()}) {
    const auto stamps =
        first_file({root / "images/timestamps.txt", root / "image_timestamps.txt", root / "images_timestamps.txt"});
    if (!stamps) continue;
    for (const std::string side : {"left", "right"}) {  // of both sides the stamps are the same
      auto images = images_in({root / "images" / side / "distorted", root / "images" / side / "rectified",
                               root / ("images_" + side) / "distorted", root / ("images_" + side) / "rectified"});
      if (images.empty()) break;
      files.set = "dsec";
      files.frames.push_back(images_by_line(*stamps, "t [us]", std::move(images), microseconds_in(*stamps)));
    }
    if (!files.frames.empty()) break;
  }
  if (is_file(folder / "rectify_map.h5")) files.set = "dsec";
  if (!files.set.empty()) files.sensor = cv::Size(640, 480);
  return files;
}

/// NAME.synced.left_event.hdf5 beside NAME.synced.imu.txt, NAME.synced.left_camera and NAME.synced.gt.txt.
SideFiles vector_files(const fs::path& events, const std::string& prefix, bool own_imu) {
  SideFiles files{.set = "vector", .sensor = cv::Size(640, 480)};
  const fs::path folder = fs::absolute(events).parent_path();
  for (const char* side : {"left_camera", "right_camera"}) {
    const fs::path camera = folder / (prefix + side), stamps = camera / "timestamp.txt";
    if (!is_file(stamps)) break;
    files.frames.push_back(images_by_line(stamps, "start end [s]", images_in({camera}), middle_of_exposure));
  }
  if (const auto imu = first_file({folder / (prefix + "imu.txt"), folder / (prefix + "imu.csv")}); own_imu && imu)
    files.imu = imu_of(*imu, TimeUnit::Seconds);
  if (const fs::path truth = folder / (prefix + "gt.txt"); is_file(truth))
    files.truth = truth_lines(truth, read_tum, "body");
  return files;
}

/// The images of a side in root/left_images. Stamps are those of the start of the exposure, whose length [us] is in
/// another list.
std::optional<StampedLines<FrameEntry>::Spec> tum_vie_images(const fs::path& root, const std::string& side) {
  for (const fs::path& list : {root / (side + "_images"), root}) {
    const fs::path stamps = list / ("image_timestamps_" + side + ".txt"),
                   lengths = list / ("image_exposures_" + side + ".txt");
    if (!is_file(stamps)) continue;
    const auto exposures = is_file(lengths) ? std::make_shared<LineReader>(lengths) : nullptr;
    const auto middle = [exposures, parse = microseconds_in(stamps)](std::string_view line) {
      const auto exposure = exposures ? exposures->next() : std::nullopt;
      const auto length = exposure ? parse_microseconds(FieldReader(exposure->text).next()) : std::nullopt;
      auto t = parse(line);
      if (t && length) *t += length->time_since_epoch() / 2;
      return t;
    };
    return images_by_line(stamps, "t [us]", images_in({root / (side + "_images")}), middle);
  }
  return std::nullopt;
}

/// NAME-events_left.h5 beside imu_data.txt, mocap_data.txt and left_images, or a folder with these.
SideFiles tum_vie_files(const fs::path& events, const std::string& prefix, bool own_imu) {
  SideFiles files{.set = "tum-vie", .sensor = cv::Size(1280, 720)};
  const fs::path folder = fs::absolute(events).parent_path();
  for (const fs::path& root : {folder, folder / (prefix + "-vi_gt_data"), folder / "data"}) {
    const fs::path imu = root / "imu_data.txt", truth = root / "mocap_data.txt";
    if (own_imu && !files.imu && is_file(imu)) files.imu = imu_of(imu, TimeUnit::Microseconds);
    if (!files.truth.read && is_file(truth)) files.truth = truth_lines(truth, read_tum_microseconds, "body");
    constexpr std::array kSides = {"left", "right"};
    while (files.frames.size() < kSides.size()) {
      auto images = tum_vie_images(root, kSides.at(files.frames.size()));
      if (!images) break;
      files.frames.push_back(std::move(*images));
    }
  }
  return files;
}

/// events.h5 beside images_timestamps.txt, images, imu.csv and stamped_groundtruth.txt.
SideFiles eds_files(const fs::path& events, bool own_imu) {
  SideFiles files;
  const fs::path folder = fs::absolute(events).parent_path();
  if (const fs::path stamps = folder / "images_timestamps.txt"; is_file(stamps))
    files.frames.push_back(images_by_line(stamps, "t [us]", images_in({folder / "images"}), microseconds_in(stamps)));
  if (const fs::path imu = folder / "imu.csv"; own_imu && is_file(imu)) files.imu = imu_of(imu, TimeUnit::Microseconds);
  if (const fs::path truth = folder / "stamped_groundtruth.txt"; is_file(truth))
    files.truth = truth_lines(truth, read_tum, "events");
  if (!files.frames.empty() || files.imu || files.truth.read) {
    files.set = "eds";
    files.sensor = cv::Size(640, 480);
  }
  return files;
}

/// The part of a file name before one of these texts, if it contains one.
std::optional<std::string> name_before(const fs::path& file, std::initializer_list<std::string_view> marks) {
  const std::string name = file.filename().string();
  for (const std::string_view mark : marks)
    if (const std::size_t at = name.find(mark); at != std::string::npos) return name.substr(0, at);
  return std::nullopt;
}

}  // namespace

std::optional<fs::path> find_right_events(const fs::path& left_file) {
  const fs::path file = fs::absolute(left_file), folder = file.parent_path();
  const auto right_of = [](std::string name) -> std::optional<std::string> {
    constexpr std::string_view kLeft = "left";
    const std::size_t at = name.rfind(kLeft);
    return at == std::string::npos ? std::nullopt : std::optional(name.replace(at, kLeft.size(), "right"));
  };
  std::vector<fs::path> candidates;
  if (const auto name = right_of(file.filename().string())) {
    candidates.push_back(folder / *name);
  } else if (const auto beside = right_of(folder.filename().string())) {
    candidates.push_back(folder.parent_path() / *beside / file.filename());
  }
  return first_file(candidates);
}

SideFiles find_side_files(const fs::path& events_file, std::string_view layout, bool own_imu) {
  if (layout == "eds") return eds_files(events_file, own_imu);
  if (layout != "dsec") return {};
  if (const auto prefix = name_before(events_file, {"left_event.", "right_event."}))
    return vector_files(events_file, *prefix, own_imu);
  if (const auto prefix = name_before(events_file, {"-events_left.", "-events_right."}))
    return tum_vie_files(events_file, *prefix, own_imu);
  return dsec_files(events_file);
}

}  // namespace edged
