// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writing of recordings as HDF5 in the layout of DSEC.
#pragma once

#include <memory>

#include "edged/io/recording_writer.hpp"

namespace edged {

/// /events/{x,y,p,t}, /t_offset and /ms_to_idx as in DSEC, packed with Blosc, for the tools that read these; the size
/// of the sensor as attributes of /events. Frames, IMU samples and ground truth in groups of our own that
/// open_recording reads: /frames/{images,t_ns}, /imu/{gyro,accel,t_ns}, /truth/{poses,t_ns}.
std::unique_ptr<RecordingWriter> write_hdf5(const WriterSetup& setup);

}  // namespace edged
