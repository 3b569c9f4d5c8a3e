// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the writer of a format takes.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "edged/dataset.hpp"
#include "edged/io/sensor_head.hpp"

namespace edged {

/// Takes a recording in the order of Dataset, the ground truth first. What a format cannot hold never comes to it.
class RecordingWriter {
 public:
  virtual ~RecordingWriter() = default;
  virtual void write(const EventBatch& batch) = 0;
  virtual void write(const Frame& /*frame*/) {}
  virtual void write(const ImuSample& /*sample*/) {}
  virtual void write(const ExternalSample& /*sample*/) {}
  virtual void write(const GroundTruth& /*truth*/) {}
  /// Completes the files. Throws InputError where they cannot be written, as all members do.
  virtual void finish() = 0;
};

/// What a writer may want to know beforehand.
struct WriterSetup {
  std::filesystem::path path;              ///< folder or file to make
  DatasetInfo info;                        ///< of what is written
  std::optional<Calibration> calibration;  ///< where the recording has one, or the user

  /// Size of the event sensor [px]; throws InputError where nothing tells it.
  cv::Size event_sensor() const;

  /// What the readers of formats that call their cameras "events" and "frames" will call this one, or "body".
  std::string name_when_read(const std::string& frame) const;
};

}  // namespace edged
