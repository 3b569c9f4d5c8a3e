// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The interface of the writers of all formats.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "edged/dataset.hpp"
#include "edged/io/sensor_head.hpp"

namespace edged {

/// Writes a recording in the order of Dataset, the ground truth first. It is not given what its format cannot hold.
class RecordingWriter {
 public:
  virtual ~RecordingWriter() = default;
  virtual void write(const EventBatch& batch) = 0;
  virtual void write(const Frame& /*frame*/) {}
  virtual void write(const ImuSample& /*sample*/) {}
  virtual void write(const ExternalSample& /*sample*/) {}
  virtual void write(const GroundTruth& /*truth*/) {}
  /// Completes the files. All members throw InputError if the files cannot be written.
  virtual void finish() = 0;
};

/// The input of a writer before the first measurement.
struct WriterSetup {
  std::filesystem::path path;              ///< folder or file to create
  DatasetInfo info;                        ///< of the recording
  std::optional<Calibration> calibration;  ///< from the recording or the user, if any

  /// Size of the event sensor [px]. Throws InputError if it is unknown.
  cv::Size event_sensor() const;

  /// The name of this frame for readers that name their cameras "events" and "frames"; else "body".
  std::string name_when_read(const std::string& frame) const;
};

}  // namespace edged
