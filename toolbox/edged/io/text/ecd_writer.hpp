// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes Event-Camera Dataset text folders. Internal to io.
#pragma once

#include "edged/io/core/recording_writer.hpp"

namespace edged {

/// Writes events.txt, images.txt with images/, imu.txt, groundtruth.txt, height.txt and velocity.txt, but no empty
/// file. With a calibration, also calib.txt (event camera) and calibration.yaml (complete). groundtruth.txt holds poses
/// of the camera, so ground truth of the body is transformed by the calibration. Each stamp, event, pixel and number
/// reads back to the same bits. Throws InputError if the folder cannot be written or already holds a recording, for a
/// second camera of a modality, and for ground truth of the body without extrinsics.
std::unique_ptr<RecordingWriter> write_ecd(const WriterSetup& setup);

}  // namespace edged
