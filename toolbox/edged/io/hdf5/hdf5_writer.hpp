// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes recordings as HDF5 in the layout of DSEC.
#pragma once

#include <memory>

#include "edged/io/core/recording_writer.hpp"

namespace edged {

/// Writes /events/{x,y,p,t}, /t_offset and /ms_to_idx as in DSEC, compressed with Blosc, for tools that read that
/// layout. The size of the sensor is in attributes of /events. Frames, IMU samples and ground truth are in groups that
/// DSEC does not have: /frames/{images,t_ns}, /imu/{gyro,accel,t_ns}, /truth/{poses,t_ns}.
std::unique_ptr<RecordingWriter> write_hdf5(const WriterSetup& setup);

}  // namespace edged
