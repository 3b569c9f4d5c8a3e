// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The table of writable formats, and the loop that writes a recording.
#include "edged/io/write_recording.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <array>

#include "edged/core/check.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/aedat/aedat.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/hdf5/hdf5.hpp"
#include "edged/io/parse/text_parsing.hpp"
#include "edged/io/prophesee/raw.hpp"
#include "edged/io/ros/ros.hpp"
#include "edged/io/text/dataset_formats.hpp"
#include "edged/io/text/event_text.hpp"

namespace edged {
namespace {

constexpr Duration kMicrosecond = std::chrono::microseconds(1);

constexpr WritableContents kEventData, kCameraData{.frames = true, .imu = true, .several_cameras = true},
    kTruthData{.frames = true, .imu = true, .ground_truth = true, .several_cameras = true},
    kAllData{.frames = true, .imu = true, .ground_truth = true, .external = true, .several_cameras = true};

constexpr std::array kWritable = {
    WritableFormat{kAllData, "ecd", "", Duration(1), write_ecd},
    WritableFormat{kEventData, "raw", ".raw", kMicrosecond, write_raw},
    WritableFormat{kEventData, "dat", ".dat", kMicrosecond, write_dat},
    WritableFormat{kCameraData, "aedat4", ".aedat4", kMicrosecond, write_aedat4},
    WritableFormat{kEventData, "csv", ".csv", Duration(1), write_csv},
    WritableFormat{kTruthData, "bag", ".bag", Duration(1), write_ros1_bag},
    WritableFormat{kTruthData, "mcap", ".mcap", Duration(1), write_mcap},
    WritableFormat{kTruthData, "hdf5", ".h5", kMicrosecond, write_hdf5},
};

/// Passes the measurements that the format can hold to the writer, and counts all.
class Sieve {
 public:
  Sieve(RecordingWriter& writer, const WritableFormat& format, const DatasetInfo& info, bool round)
      : writer_(writer), format_(format), info_(info), round_(round) {}

  void operator()(EventBatch& batch) {
    keep_to_one(event_camera_, batch.camera, Modality::Events);
    if (format_.tick > Duration(1)) fit_to_tick(batch.events);
    writer_.write(batch);
    counts.events += batch.events.size();
  }

  void operator()(const Frame& frame) {
    keep_to_one(frame_camera_, frame.camera, Modality::Frames);
    if (format_.frames) writer_.write(frame);
    ++(format_.frames ? counts.frames : counts.frames_left_out);
  }

  void operator()(const ImuSample& sample) {
    if (format_.imu) writer_.write(sample);
    ++(format_.imu ? counts.imu : counts.imu_left_out);
  }

  void operator()(const ExternalSample& sample) {
    if (format_.external) writer_.write(sample);
    ++(format_.external ? counts.external : counts.external_left_out)[std::string(sensor_of(sample).name)];
  }

  void operator()(const GroundTruth& truth) {
    if (format_.ground_truth) writer_.write(truth);
    (format_.ground_truth ? counts.poses : counts.poses_left_out) = truth.trajectory.size();
  }

  WriteCounts counts;

 private:
  void fit_to_tick(std::vector<Event>& events) const {
    for (Event& event : events) {
      const Duration rest = event.t.time_since_epoch() % format_.tick;
      if (rest != Duration(0) && !round_)
        throw InputError::format(
            "an event at {} s: format {} holds whole microseconds only; take another format, or --round to cut stamps",
            format_seconds(event.t), format_.name);
      event.t -= rest;
    }
  }

  /// A camera that the recording does not name would be taken for another one.
  void keep_to_one(std::string& known, const std::string& camera, Modality modality) const {
    if (std::ranges::count(info_.more_cameras, modality, &RecordedCamera::modality) > 0) return;
    if (known.empty()) known = camera;
    if (known != camera)
      throw InputError::format("{}: names one camera of {}, not both {} and {}", info_.name, kind_name(modality), known,
                               camera);
  }

  RecordingWriter& writer_;
  const WritableFormat& format_;
  const DatasetInfo& info_;
  std::string event_camera_, frame_camera_;
  bool round_;
};

void refuse_several_event_cameras(const DatasetInfo& info, const WritableFormat& format) {
  for (const RecordedCamera& camera : info.more_cameras)
    if (camera.modality == Modality::Events)
      throw InputError::format("{}: format {} holds one event camera, not both {} and {}: choose one with --cameras",
                               info.name, format.name, info.event_camera, camera.name);
}

}  // namespace

std::span<const WritableFormat> writable_formats() { return kWritable; }

const WritableFormat& writable_format(std::string_view name, const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  const auto fits = [&](const WritableFormat& f) { return name.empty() ? f.extension == extension : f.name == name; };
  if (const auto found = std::ranges::find_if(kWritable, fits); found != kWritable.end()) return *found;
  std::vector<std::string> known;
  for (const WritableFormat& f : kWritable)
    known.push_back(fmt::format("{} ({})", f.name, f.extension.empty() ? "a folder" : f.extension));
  throw InputError::format("{}: cannot write format `{}`; give --format, one of: {}", path.string(),
                           name.empty() ? extension : name, fmt::join(known, ", "));
}

std::string external_text(const std::map<std::string, std::size_t>& counts) {
  std::string text;
  for (const auto& [sensor, count] : counts) text += fmt::format(", {} {} samples", count, sensor);
  return text;
}

WriteCounts write_recording(Dataset& dataset, const WritableFormat& format, const std::filesystem::path& path,
                            const std::optional<Calibration>& calibration, const WriteOptions& options) {
  constexpr std::size_t kProgressEvery = 256;  // measurements
  std::error_code ignored;
  const bool is_file = !format.extension.empty(), existed = std::filesystem::exists(path, ignored);
  if (is_file && existed) throw InputError::format("{}: exists already: give another name", path.string());
  if (!dataset.info().has_events && !format.frames && !format.imu)
    throw InputError::format("{}: holds no events, and format {} holds nothing else", dataset.info().name, format.name);
  if (!format.several_cameras) refuse_several_event_cameras(dataset.info(), format);
  try {
    const std::unique_ptr<RecordingWriter> writer = format.open({path, dataset.info(), calibration});
    Sieve sieve(*writer, format, dataset.info(), options.round);
    if (const auto truth = dataset.ground_truth()) sieve(*truth);
    for (std::size_t i = 1; auto measurement = dataset.next(); ++i) {
      const auto t = last_stamp(*measurement);
      std::visit(sieve, *measurement);
      if (options.progress && t && i % kProgressEvery == 0) options.progress(*t);
    }
    writer->finish();
    return sieve.counts;
  } catch (const InputError&) {
    if (!existed)
      std::filesystem::remove_all(path, ignored);  // an incomplete recording could be taken for a complete one
    throw;
  }
}

}  // namespace edged
