// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes Event-Camera Dataset text folders. Internal to io.
#pragma once

#include "edged/io/recording_writer.hpp"

namespace edged {

/// events.txt, images.txt with images/, imu.txt, groundtruth.txt, height.txt and velocity.txt, each only if there is
/// something in it; calib.txt (event camera) and calibration.yaml (everything) from a calibration, which also turns
/// ground truth of the body into that of the camera, which is what groundtruth.txt holds. Read back, every stamp,
/// event, pixel and number is the same to the last bit. Throws InputError when the folder cannot be written or holds a
/// recording already, for a second camera of a kind, and for ground truth of the body without extrinsics.
std::unique_ptr<RecordingWriter> write_ecd(const WriterSetup& setup);

}  // namespace edged
