// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The common part of readers of a single stream of bytes. Internal to io.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <set>
#include <span>

#include "edged/dataset.hpp"
#include "edged/io/archive/bytes.hpp"
#include "edged/io/core/merger.hpp"

namespace edged {

/// A recording whose reader pushes measurements approximately in order, as they are read. This class checks the bounds
/// of the sensor, restores the order and returns the measurements.
class StreamedDataset : public Dataset {
 public:
  const DatasetInfo& info() const final { return info_; }
  std::optional<Measurement> next() final;
  void leave_out(Modality unwanted) final;
  std::size_t skip_events(double share) final {
    skip_share_ = share;
    return skipped_;
  }
  std::map<std::string, std::size_t> repairs() const final { return repairs_.counts(); }

 protected:
  /// path: of the file or folder, for messages and the name of the recording.
  StreamedDataset(const std::filesystem::path& path, std::string format);

  /// Reads up to the first measurement, for info().begin. To be called last in the constructor of a reader. cameras:
  /// those that are read, of each kind the first first. Throws InputError without measurements.
  void begin(const std::vector<RecordedCamera>& cameras, bool imu);
  /// For readers of one camera a kind, "events" and "frames".
  struct OneOfEach {
    bool events = false, frames = false, imu = false;
  };
  void begin(const OneOfEach& there);

  /// Pushes the next measurements, any number of them. False at the end.
  virtual bool read_on() = 0;

  /// False: measurements of this modality are ignored, so a reader need not decode them. The IMU is always wanted.
  bool wants(std::optional<Modality> modality) const { return !modality || !left_out_.contains(*modality); }

  /// Sets the size of an event sensor [px]. Without it, no pixel is outside. camera, here and below: its place among
  /// those of its kind in begin().
  void set_sensor(cv::Size size, std::size_t camera = 0) { sensor_of(camera) = size; }
  cv::Size sensor(std::size_t camera) { return sensor_of(camera); }

  /// A block of events, of which only the last is kept if it is to be skipped.
  void push_events(std::span<const Event> events, std::size_t camera = 0);
  /// Events that are not to be skipped. Those outside the sensor are left out; a recording with more than 1 % of them
  /// is refused (InputError).
  void push_wanted_events(std::span<const Event> events, std::size_t camera = 0);
  /// Whether the next block is to be skipped; then counts its events. For readers that can leave out decoding it.
  bool skips_block(std::size_t events);
  /// image: CV_8UC1. Throws Damage if its size differs from that of the camera's first image.
  void push_frame(Timestamp t, cv::Mat image, std::size_t camera = 0);
  void push_imu(const ImuSample& sample) { merger_.push(sample); }
  void push_external(const ExternalSample& sample) { merger_.push(sample); }

  /// Counts events outside the sensor that the reader itself has left out.
  void count_outside(std::size_t count, std::size_t camera = 0);

  const std::string name_;  ///< the path, for messages
  DatasetInfo info_;
  Repairs repairs_;

 private:
  std::optional<Measurement> merged();
  cv::Size& sensor_of(std::size_t camera) {
    return camera == 0 ? info_.event_sensor : info_.more_cameras.at(camera - 1).sensor;
  }

  Merger merger_;
  std::vector<cv::Size> image_sizes_;  ///< the first image of each frame camera
  std::size_t inside_ = 0, outside_ = 0;
  bool finished_ = false;
  std::set<Modality> left_out_;
  double skip_share_ = 0.0, skip_sum_ = 0.0;  ///< of the blocks; those due, less those skipped
  std::size_t skipped_ = 0;
  std::optional<Measurement> first_;  ///< read by begin()
};

}  // namespace edged
