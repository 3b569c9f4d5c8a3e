// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The interface of the writers of all formats.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "edged/dataset.hpp"
#include "edged/io/calibration_data.hpp"

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
  DatasetInfo info;                        ///< what is known of the recording
  std::optional<Calibration> calibration;  ///< from the recording or the user, if any

  /// Size of an event sensor [px]. camera: its place. Throws InputError if it is unknown.
  cv::Size event_sensor(std::size_t camera = 0) const;

  /// Number of cameras of a kind in the recording, at least 1.
  std::size_t cameras(Modality modality) const;
  /// The name of the camera at that place among those of its kind.
  std::string camera_name(Modality modality, std::size_t place) const { return of_kind(modality).at(place).name; }
  /// The place of that camera of the recording among those of its kind: 0 of a single one, whatever its name. Throws
  /// InputError for an unknown one.
  std::size_t place_of(const std::string& camera, Modality modality) const;

  /// The calibration with the usual names (usual_camera_name) of the cameras, as readers of formats without names give
  /// them. There must be a calibration.
  Calibration calibration_when_read() const;
  /// The usual name of this frame; "body" as it is.
  std::string name_when_read(const std::string& frame) const;

 private:
  std::vector<RecordedCamera> of_kind(Modality modality) const;
};

}  // namespace edged
