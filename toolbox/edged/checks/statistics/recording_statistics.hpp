// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The content of a recording, determined in one pass.
#pragma once

#include <functional>
#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "edged/checks/statistics/event_statistics.hpp"
#include "edged/checks/statistics/external_statistics.hpp"
#include "edged/checks/statistics/imu_statistics.hpp"
#include "edged/checks/statistics/stream_statistics.hpp"
#include "edged/checks/statistics/truth_statistics.hpp"
#include "edged/dataset.hpp"
#include "edged/imu/imu_gate.hpp"

namespace edged {

struct RecordingStatistics {
  DatasetInfo info;
  StreamStatistics events, frames, imu;
  EventStatistics event_details;
  ImuStatistics imu_details;  ///< of the samples that pass the gate, as are those of `imu`
  ImuFaultRecords imu_faults{};
  cv::Size image_size;           ///< size of the first image
  double mean_brightness = 0.0;  ///< mean over all images, 0 to 255
  double repeated_share = 0.0;   ///< of the images: those equal to the one before, a few times in a row
  ExternalStatisticsByName external;
  std::optional<TruthStatistics> truth;
  std::map<std::string, std::size_t> repairs;
  /// The cameras beside the first of a kind, in the order of DatasetInfo::more_cameras: each has its events or
  /// frames alone.
  std::vector<RecordingStatistics> more;
  /// The name of such a camera.
  const std::string& camera() const { return info.has_events ? info.event_camera : info.frame_camera; }

  /// Time that all present sensors cover; negative: minus the gap between them.
  Duration overlap() const;
  /// From the first to the last stamp of events and frames.
  std::optional<std::pair<Timestamp, Timestamp>> cameras() const;
  /// Duration of the IMU over that of events and frames; 0 without these.
  double imu_span_ratio() const;
};

/// Collects measurements in the order of the recording, in bounded memory.
class RecordingCollector {
 public:
  explicit RecordingCollector(const DatasetInfo& info);

  enum class Detail {
    All,
    Stamps,  ///< only the stamps of events and frames: cheap, if a part of them is collected with All
  };
  /// every: that of EventCollector::add.
  void add(const Measurement& measurement, Detail detail = Detail::All, std::size_t every = 1);
  /// The IMU samples that passed the gate with the newest one.
  std::span<const ImuSample> imu_passed() const { return gate_.passed(); }
  /// The statistics of the measurements so far, without ground truth and repairs.
  RecordingStatistics so_far() const;
  /// The complete statistics, after the last measurement. truth: that of the dataset, which is slow to read.
  RecordingStatistics result(const Dataset& dataset, const std::optional<GroundTruth>& truth) const;

 private:
  void watch_image(const Frame& frame);
  void watch_image(const EventBatch& batch);
  void count_repeated(const cv::Mat& image);

  DatasetInfo info_;
  StreamCollector events_, frames_, imu_;
  ImuGate gate_;
  EventCollector event_details_;
  ImuCollector imu_details_;
  std::vector<RecordingCollector> more_;  ///< one for each further camera
  std::map<std::string, ExternalCollector> external_;
  cv::Size image_size_;
  double brightness_sum_ = 0.0;
  std::size_t measured_frames_ = 0;       ///< in that sum
  cv::Mat before_;                        ///< the previous image
  std::size_t alike_ = 0, repeated_ = 0;  ///< images like it since it changed; of all short repetitions
  cv::Mat compared_;                      ///< the frame that later ones are compared with
  Timestamp compared_at_, counted_from_;
  std::size_t counted_ = 0;  ///< events since that frame
};

}  // namespace edged
