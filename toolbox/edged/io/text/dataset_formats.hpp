// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Folders with one text file for each sensor: the Event-Camera Dataset and EuRoC.
#pragma once

#include <memory>

#include "edged/io/archive/source_path.hpp"
#include "edged/io/core/recording_writer.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// Opens a folder of the Event-Camera Dataset or of UZH-FPV, for which is_ecd_folder() is true.
Recording open_ecd(const SourcePath& folder, const Rig* rig, const RecordingOptions& options);

/// Opens a folder of EuRoC or TUM-VI. mav0: as returned by find_mav0().
Recording open_euroc(const SourcePath& mav0, const RecordingOptions& options);

/// Writes events.txt, images.txt with images/, imu.txt, groundtruth.txt, height.txt and velocity.txt, but no empty
/// file. With a calibration, also calib.txt (event camera) and calibration.yaml (complete). groundtruth.txt holds poses
/// of the camera, so ground truth of the body is transformed by the calibration. Each stamp, event, pixel and number
/// reads back to the same bits. Throws InputError if the folder cannot be written or already holds a recording, for a
/// second camera of a modality, and for ground truth of the body without extrinsics.
std::unique_ptr<RecordingWriter> write_ecd(const WriterSetup& setup);

}  // namespace edged
