// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Collects the views of a target, and the samples of the IMU, from a recording.
#pragma once

#include <map>
#include <memory>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <vector>

#include "edged/calibrate/target_picture.hpp"
#include "edged/calibrate/target_view.hpp"

namespace edged {

struct CollectorOptions {
  bool frames = true, events = true;
  std::map<std::string, cv::Size> event_sensors = {};       ///< by the name of the event camera [px]
  Duration frame_interval = std::chrono::milliseconds(45);  ///< at least, between two pictures that are searched
  Duration event_interval = std::chrono::milliseconds(95);
};

/// Frames and pictures made of events are searched as they come. Of a recording with both, those of events are of the
/// same instants.
class ViewCollector {
 public:
  ViewCollector(const TargetSpec& spec, const CollectorOptions& options);

  void add(const Measurement& measurement);
  /// After the last measurement.
  void finish();

  /// In the order of their names.
  std::vector<TargetViews> cameras() const;
  const std::vector<ImuSample>& imu() const { return imu_; }
  const TargetLayout& layout() const { return detector_.layout(); }
  /// "frames 40 of 52, missing upper left, top; events 20 of 33": views with the target of pictures searched, and the
  /// parts of the image where it has not been.
  std::string progress() const;

 private:
  struct EventCamera {
    std::unique_ptr<TargetPictures> pictures;
    std::optional<Timestamp> last_instant;
  };

  void take_frame(const Frame& frame);
  void take_events(const EventBatch& batch);
  void search(TargetViews& camera, Timestamp t, const cv::Mat& picture);
  TargetViews& camera(const std::string& name, Modality modality, cv::Size size);
  void ask_for(EventCamera& camera, Timestamp t) const;

  TargetDetector detector_;
  CollectorOptions options_;
  std::map<std::string, TargetViews> cameras_;
  std::map<std::string, EventCamera> event_cameras_;
  std::map<std::string, Timestamp> last_frame_;
  std::vector<ImuSample> imu_;
};

}  // namespace edged
