// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The images of a folder in the order of their names belong to the lines of the stamps. Poses in HDF5 are seven numbers
// or matrices, converted to T_W_X.
#include "edged/io/hdf5/side_files.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/io/parse/imu_table.hpp"
#include "edged/io/parse/trajectory_io.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

bool is_file(const fs::path& path) { return SourcePath(path).is_file(); }

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
  static const TableKind kind{
      {"timestamp"},
      [](const ColumnName& name) { return names_time(name) ? std::optional<std::size_t>(0) : std::nullopt; },
      "timestamp [us]"};
  const TextTable table = heading_or(file, kind, {.at = {0}, .unit = TimeUnit::Microseconds});
  return [column = table.at[0], unit = table.unit](std::string_view line) {
    FieldReader fields(line);
    for (std::size_t i = 0; i < column; ++i) fields.next();
    return parse_stamp(fields.next(), unit);
  };
}

/// Start and end of the exposure in seconds.
std::optional<Timestamp> middle_of_exposure(std::string_view line) {
  FieldReader fields(line);
  const auto start = parse_stamp(fields.next(), TimeUnit::Seconds), end = parse_stamp(fields.next(), TimeUnit::Seconds);
  if (!start || !end) return std::nullopt;
  return *start + (*end - *start) / 2;
}

TruthSource truth_lines(const fs::path& file, TimeUnit unit, const std::string& frame) {
  return {frame,
          [file, unit, frame](Repairs& repairs) { return read_ground_truth(file, tum_table(unit), frame, repairs); }};
}

/// The names of the files of a data set. PREFIX is the part of the name of the events file before its mark, SIDE left
/// or right. Of several names, the first that exists counts.
struct SideNames {
  using Names = std::vector<std::string_view>;
  std::string_view set, layout;
  Names marks = {};    ///< parts of the name of the events file; none: the files beside it tell the set
  Names witness = {};  ///< a file beside the events file that tells the set, too
  cv::Size sensor = {};
  Names roots = {"."};  ///< folders of the files, relative to that of the events
  Names sides = {"left", "right"};
  Names stamps = {};          ///< lists of the stamps of the images of a side, a line each [us]
  Names lengths = {};         ///< list of the exposures [us], beside the stamps, which are those of the start
  bool spans = false;         ///< stamps are the start and the end of the exposure [s] instead
  Names images = {};          ///< folders
  bool needs_images = false;  ///< stamps without images are left out
  Names imu = {};
  TimeUnit imu_unit = TimeUnit::Microseconds;
  Names truth = {};
  TimeUnit truth_unit = TimeUnit::Seconds;
  const char* truth_frame = "body";
};

const std::vector<SideNames>& side_names() {
  static const std::vector<SideNames> kNames = {
      // NAME.synced.left_event.hdf5
      {.set = "vector",
       .layout = "dsec",
       .marks = {"left_event.", "right_event."},
       .sensor = {640, 480},
       .stamps = {"PREFIXSIDE_camera/timestamp.txt"},
       .spans = true,
       .images = {"PREFIXSIDE_camera"},
       .imu = {"PREFIXimu.txt", "PREFIXimu.csv"},
       .imu_unit = TimeUnit::Seconds,
       .truth = {"PREFIXgt.txt"}},
      // NAME-events_left.h5, beside the other files or a folder with these
      {.set = "tum-vie",
       .layout = "dsec",
       .marks = {"-events_left.", "-events_right."},
       .sensor = {1280, 720},
       .roots = {".", "PREFIX-vi_gt_data", "data"},
       .stamps = {"SIDE_images/image_timestamps_SIDE.txt", "image_timestamps_SIDE.txt"},
       .lengths = {"image_exposures_SIDE.txt"},
       .images = {"SIDE_images"},
       .imu = {"imu_data.txt"},
       .truth = {"mocap_data.txt"},
       .truth_unit = TimeUnit::Microseconds},
      // SEQUENCE/events/left/events.h5; both sides have the same stamps, the middle of the exposure
      {.set = "dsec",
       .layout = "dsec",
       .witness = {"rectify_map.h5", "rectify_maps.h5"},
       .sensor = {640, 480},
       .roots = {".", "..", "../.."},
       .stamps = {"images/timestamps.txt", "image_timestamps.txt", "images_timestamps.txt"},
       .images = {"images/SIDE/distorted", "images/SIDE/rectified", "images_SIDE/distorted", "images_SIDE/rectified"},
       .needs_images = true},
      {.set = "eds",
       .layout = "eds",
       .sensor = {640, 480},
       .sides = {"left"},
       .stamps = {"images_timestamps.txt"},
       .images = {"images"},
       .imu = {"imu.csv"},
       .truth = {"stamped_groundtruth.txt"},
       .truth_frame = "events"},
  };
  return kNames;
}

/// The part of a file name before one of these texts, if it contains one.
std::optional<std::string> name_before(const fs::path& file, const SideNames::Names& marks) {
  const std::string name = file.filename().string();
  for (const std::string_view mark : marks)
    if (const std::size_t at = name.find(mark); at != std::string::npos) return name.substr(0, at);
  return std::nullopt;
}

/// The names as paths.
std::vector<fs::path> paths_of(const SideNames::Names& names, const fs::path& folder, const std::string& prefix,
                               std::string_view side = "") {
  std::vector<fs::path> paths;
  for (const std::string_view name : names) {
    std::string path(name);
    for (const auto& [word, value] : {std::pair<std::string_view, std::string_view>("PREFIX", prefix), {"SIDE", side}})
      for (std::size_t at = path.find(word); at != std::string::npos; at = path.find(word, at + value.size()))
        path.replace(at, word.size(), value);
    paths.push_back((folder / path).lexically_normal());
  }
  return paths;
}

/// The stamps of the images of a side: the middle of their exposures, if these are known.
std::function<std::optional<Timestamp>(std::string_view)> stamps_in(const SideNames& names, const fs::path& file,
                                                                    std::string_view side) {
  if (names.spans) return middle_of_exposure;
  const auto lengths = first_file(names.lengths.empty() ? std::vector<fs::path>()
                                                        : paths_of({names.lengths}, file.parent_path(), "", side));
  const auto exposures = lengths ? std::make_shared<LineReader>(*lengths) : nullptr;
  return [exposures, parse = microseconds_in(file)](std::string_view line) {
    const auto exposure = exposures ? exposures->next() : std::nullopt;
    const auto length =
        exposure ? parse_stamp(FieldReader(exposure->text).next(), TimeUnit::Microseconds) : std::nullopt;
    auto t = parse(line);
    if (t && length) *t += length->time_since_epoch() / 2;
    return t;
  };
}

/// Adds the images of the sides that are in this folder.
void add_images(const SideNames& names, const fs::path& root, const std::string& prefix, SideFiles& files) {
  while (files.frames.size() < names.sides.size()) {
    const std::string_view side = names.sides[files.frames.size()];
    const auto stamps = first_file(paths_of(names.stamps, root, prefix, side));
    auto images = stamps ? images_in(paths_of(names.images, root, prefix, side)) : std::vector<fs::path>();
    if (!stamps || (images.empty() && names.needs_images)) return;
    files.frames.push_back(images_by_line(*stamps, names.spans ? "start end [s]" : "t [us]", std::move(images),
                                          stamps_in(names, *stamps, side)));
  }
}

SideFiles find_files(const SideNames& names, const fs::path& folder, const std::string& prefix, bool own_imu) {
  SideFiles files;
  for (const fs::path& root : paths_of(names.roots, folder, prefix)) {
    add_images(names, root, prefix, files);
    // Angular velocity first, as in all these data sets, unless the heading names another order.
    if (const auto imu = first_file(paths_of(names.imu, root, prefix)); own_imu && !files.imu && imu)
      files.imu = imu_lines(*imu, documented_imu_table(*imu, gyro_first(names.imu_unit)));
    if (const auto truth = first_file(paths_of(names.truth, root, prefix)); truth && !files.truth.read)
      files.truth = truth_lines(*truth, names.truth_unit, names.truth_frame);
  }
  if (!names.marks.empty() || !files.frames.empty() || files.imu || files.truth.read ||
      first_file(paths_of(names.witness, folder, prefix))) {
    files.set = names.set;
    files.sensor = names.sensor;
  }
  return files;
}

constexpr double kMostDeviation = 1e-2;

/// x y z qx qy qz qw
std::optional<SE3> pose_of_seven(const double* v) {
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!(std::abs(q.norm() - 1.0) < kMostDeviation) || !Eigen::Vector3d(v).allFinite()) return std::nullopt;
  return SE3(q, Eigen::Vector3d(v));
}

/// 4 x 4, row by row.
std::optional<SE3> pose_of_matrix(const double* v) {
  const Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> T(v);
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const double deviation = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!T.allFinite() || !(deviation < kMostDeviation) || R.determinant() < 0) return std::nullopt;
  return SE3(R, T.topRightCorner<3, 1>());
}

Trajectory read_poses(const H5Array& poses, const H5Stamps& stamps, bool inverse,
                      const std::function<void(const char* kind, const std::string& detail)>& bad) {
  constexpr std::uint64_t kPosesAtOnce = 1024;
  Trajectory read;
  const std::size_t columns = poses.columns();
  const std::uint64_t rows = std::min(poses.rows(), stamps.rows());
  for (std::uint64_t at = 0; at < rows; at += kPosesAtOnce) {
    const std::uint64_t count = std::min(kPosesAtOnce, rows - at);
    try {
      const auto t = stamps.read(at, count);
      const auto values = poses.read<double>(at, count);
      for (std::size_t i = 0; i < count; ++i) {
        const double* v = &values[columns * i];
        const auto T = columns == 7 ? pose_of_seven(v) : pose_of_matrix(v);
        const bool late = !read.empty() && t[i] <= read.back().t;
        if (!T || t[i] == Timestamp::min() || late)
          bad("bad pose", fmt::format("pose {} is invalid, or its stamp is not after the one before", at + i));
        else
          read.push_back({t[i], inverse ? T->inverse() : *T});
      }
    } catch (const Damage& damage) {
      bad("part unreadable", damage.what());
    }
  }
  return read;
}

std::optional<GroundTruth> read_truth(const fs::path& path, const Hdf5Layout& layout, const std::string& frame,
                                      Repairs& repairs) try {
  const H5File file(path);
  const auto poses = file.find(layout.poses);
  auto stamps = file.find(layout.pose_stamps);
  if (!poses || !stamps || (poses->columns() != 7 && poses->columns() != 16)) return std::nullopt;
  const auto bad = [&](const char* kind, const std::string& detail) {
    repairs.add(std::string("groundtruth: ") + kind, path.string() + ": " + detail);
  };
  Trajectory read = read_poses(*poses, H5Stamps(std::move(*stamps)), layout.inverse_poses, bad);
  return read.empty() ? std::nullopt : std::optional(GroundTruth{std::move(read), frame});
} catch (const InputError& error) {
  repairs.add("groundtruth: unreadable", error.what());
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
  for (const SideNames& names : side_names()) {
    if (names.layout != layout) continue;
    const auto prefix = names.marks.empty() ? std::string() : name_before(events_file, names.marks);
    if (prefix) return find_files(names, fs::absolute(events_file).parent_path(), *prefix, own_imu);
  }
  return {};
}

TruthSource find_h5_truth(const H5File& events_file, const Hdf5Layout& layout) {
  const auto reader = [&layout](const fs::path& file, const std::string& frame) -> TruthSource {
    return {frame, [file, frame, layout](Repairs& repairs) { return read_truth(file, layout, frame, repairs); }};
  };
  const std::string poses(layout.poses);
  if (poses.empty()) return {};
  if (layout.truth_files.front().empty()) {
    if (!events_file.has(poses)) return {};
    return reader(events_file.path(), events_file.text_attribute(poses, "frame").value_or("body"));
  }
  std::string stem = events_file.path().stem().string();
  if (stem.ends_with("_data")) stem.resize(stem.size() - 5);
  for (const std::string_view ending : layout.truth_files) {
    const fs::path file = fs::absolute(events_file.path()).parent_path() / (stem + std::string(ending));
    if (!ending.empty() && is_file(file)) return reader(file, "events");
  }
  return {};
}

}  // namespace edged
