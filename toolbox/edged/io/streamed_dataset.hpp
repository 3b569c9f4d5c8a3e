// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The common part of readers of a single stream of bytes. Internal to io.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <set>
#include <span>

#include "edged/dataset.hpp"
#include "edged/io/bytes.hpp"
#include "edged/io/merger.hpp"

namespace edged {

/// A recording whose reader pushes measurements approximately in order, as they are read. This class checks the bounds
/// of the sensor, restores the order and returns the measurements.
class StreamedDataset : public Dataset {
 public:
  const DatasetInfo& info() const final { return info_; }
  std::optional<Measurement> next() final;
  void leave_out(Modality unwanted) final;
  std::map<std::string, std::size_t> repairs() const final { return repairs_.counts(); }

 protected:
  /// path: of the file or folder, for messages and the name of the recording.
  StreamedDataset(const std::filesystem::path& path, std::string format);

  /// Reads up to the first measurement, for info().begin. To be called last in the constructor of a reader. Throws
  /// InputError without measurements.
  void begin(const Merger::Streams& expected);

  /// Pushes the next measurements, any number of them. False at the end.
  virtual bool read_on() = 0;

  /// False: measurements of this modality are ignored, so a reader need not decode them. The IMU is always wanted.
  bool wants(std::optional<Modality> modality) const { return !modality || !left_out_.contains(*modality); }

  /// Sets the size of the event sensor [px]. Without it, no pixel is outside.
  void set_sensor(cv::Size size) { info_.event_sensor = size; }

  /// Events outside the sensor are left out; a recording with more than 1 % of them is refused (InputError).
  void push_events(std::span<const Event> events);
  /// image: CV_8UC1. Throws Damage if its size differs from that of the first image.
  void push_frame(Timestamp t, cv::Mat image);
  void push_imu(const ImuSample& sample) { merger_.push(sample); }
  void push_external(const ExternalSample& sample) { merger_.push(sample); }

  /// Counts events outside the sensor that the reader itself has left out.
  void count_outside(std::size_t count);

  const std::string name_;  ///< the path, for messages
  DatasetInfo info_;
  Repairs repairs_;

 private:
  std::optional<Measurement> merged();

  Merger merger_;
  cv::Size image_size_;  ///< of the first image
  std::size_t inside_ = 0, outside_ = 0;
  bool finished_ = false;
  std::set<Modality> left_out_;
  std::optional<Measurement> first_;  ///< read by begin()
};

}  // namespace edged
