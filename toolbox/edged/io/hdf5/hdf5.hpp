// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads data sets with events in HDF5 (DSEC, VECtor, TUM-VIE, M3ED, MVSEC, EDS, Metavision), and writes the layout of
// DSEC.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/core/recording_writer.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// True for the first bytes of an HDF5 file.
bool is_hdf5(ByteSpan head);
/// The event file of a folder and its subfolders, down to some depth. Of several, that of the left camera. Nothing if
/// the folder holds no HDF5. Throws InputError for several files with events, and for none.
std::optional<std::filesystem::path> find_hdf5_events(const std::filesystem::path& folder);

/// Detects the layout by the content of the file, and the files of frames, IMU and ground truth by their names in the
/// data sets. Options used: the geometry of the event sensor. Throws InputError, with the content, for an unknown
/// layout.
Recording open_hdf5(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options);

/// Writes /events/{x,y,p,t}, /t_offset and /ms_to_idx as in DSEC, compressed with Blosc, for tools that read that
/// layout. The size of the sensor is in attributes of /events. Frames, IMU samples and ground truth are in groups that
/// DSEC does not have: /frames/{images,t_ns}, /imu/{gyro,accel,t_ns}, /truth/{poses,t_ns}.
std::unique_ptr<RecordingWriter> write_hdf5(const WriterSetup& setup);

}  // namespace edged
