// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the readers of one stream of bytes have in common. Internal to io.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <set>
#include <span>

#include "edged/dataset.hpp"
#include "edged/io/bytes.hpp"
#include "edged/io/merger.hpp"

namespace edged {

/// A recording whose reader takes measurements out of its files about in order. The reader pushes them as they come;
/// here they are bounded to the sensor, put in order and handed out.
class StreamedDataset : public Dataset {
 public:
  const DatasetInfo& info() const final { return info_; }
  std::optional<Measurement> next() final;
  void leave_out(Modality unwanted) final;
  std::map<std::string, std::size_t> repairs() const final { return repairs_.counts(); }

 protected:
  /// path: of the file or folder, for messages and for the name of the recording.
  StreamedDataset(const std::filesystem::path& path, std::string format);

  /// Reads up to the first measurement, for info().begin: the last act of a reader's constructor. Throws InputError
  /// where there is none.
  void begin(const Merger::Streams& expected);

  /// Pushes what comes next, any amount of it. False at the end.
  virtual bool read_on() = 0;

  /// False: what is pushed of these is passed over, and a reader saves itself the decoding. The IMU is wanted always.
  bool wants(std::optional<Modality> modality) const { return !modality || !left_out_.contains(*modality); }

  /// The size of the event sensor [px] once it is known; without one no pixel is outside.
  void set_sensor(cv::Size size) { info_.event_sensor = size; }

  /// Events outside the sensor are left out; a recording with more than 1 % of them is refused (InputError).
  void push_events(std::span<const Event> events);
  /// image: CV_8UC1. Throws Damage for another size than that of the first.
  void push_frame(Timestamp t, cv::Mat image);
  void push_imu(const ImuSample& sample) { merger_.push(sample); }
  void push_external(const ExternalSample& sample) { merger_.push(sample); }

  /// So many events, which the reader has left out itself, were outside the sensor.
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
  std::optional<Measurement> first_;  ///< read for the begin
};

}  // namespace edged
