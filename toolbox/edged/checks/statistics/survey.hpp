// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The content of a recording, determined in one pass.
#pragma once

#include <functional>
#include <map>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "edged/checks/statistics/event_survey.hpp"
#include "edged/checks/statistics/external_survey.hpp"
#include "edged/checks/statistics/imu_survey.hpp"
#include "edged/checks/statistics/stream_survey.hpp"
#include "edged/dataset.hpp"

namespace edged {

struct TruthSurvey {
  StreamSurvey stream;
  std::string frame;    ///< whose pose it is
  double path_m = 0.0;  ///< length of the path
};

struct Survey {
  DatasetInfo info;
  StreamSurvey events, frames, imu;
  EventSurvey event_details;
  ImuSurvey imu_details;
  cv::Size image_size;           ///< of the first image
  double mean_brightness = 0.0;  ///< of all images, 0 to 255
  ExternalSurveys external;
  std::optional<TruthSurvey> truth;
  std::map<std::string, std::size_t> repairs;
  /// Of the cameras beside the first of a kind, in the order of DatasetInfo::more_cameras: their events or frames
  /// alone.
  std::vector<Survey> more;
  /// The name of such a camera.
  const std::string& camera() const { return info.has_events ? info.event_camera : info.frame_camera; }

  /// Time that all present sensors cover; negative: minus the gap between them.
  Duration overlap() const;
  /// From the first to the last stamp of events and frames.
  std::optional<std::pair<Timestamp, Timestamp>> cameras() const;
  /// Duration of the IMU over that of events and frames; 0 without these.
  double imu_span_ratio() const;
};

/// Surveys measurements in the order of the recording, in bounded memory.
class Surveyor {
 public:
  explicit Surveyor(const DatasetInfo& info);

  enum class Detail {
    All,
    Stamps,  ///< only the stamps of events and frames: cheap, if a part of them is surveyed with All
  };
  /// every: that of EventSurveyor::add.
  void add(const Measurement& measurement, Detail detail = Detail::All, std::size_t every = 1);
  /// The survey of the measurements so far, without ground truth and repairs.
  Survey so_far() const;
  /// The complete survey, after the last measurement. truth: that of the dataset, which is slow to read.
  Survey result(const Dataset& dataset, const std::optional<GroundTruth>& truth) const;

 private:
  void watch_image(const Frame& frame);
  void watch_image(const EventBatch& batch);

  DatasetInfo info_;
  StreamSurveyor events_, frames_, imu_;
  EventSurveyor event_details_;
  ImuSurveyor imu_details_;
  std::vector<Surveyor> more_;  ///< of further cameras
  std::map<std::string, ExternalSurveyor> external_;
  cv::Size image_size_;
  double brightness_sum_ = 0.0;
  std::size_t measured_frames_ = 0;  ///< in that sum
  cv::Mat compared_;                 ///< the frame that later ones are compared with
  Timestamp compared_at_, counted_from_;
  std::size_t counted_ = 0;  ///< events since that frame
};

}  // namespace edged
