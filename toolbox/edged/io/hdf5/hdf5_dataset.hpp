// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Data sets with events in HDF5: DSEC, VECtor, TUM-VIE, M3ED, MVSEC, EDS and Metavision.
#pragma once

#include <filesystem>
#include <optional>

#include "edged/io/recording.hpp"

namespace edged {

/// The event file of a folder and its subfolders, down to some depth. Of several, that of the left camera. Nothing if
/// the folder holds no HDF5. Throws InputError for several files with events, and for none.
std::optional<std::filesystem::path> find_hdf5_events(const std::filesystem::path& folder);

/// Detects the layout by the content of the file, and the files of frames, IMU and ground truth by their names in the
/// data sets. Options used: the geometry of the event sensor. Throws InputError, with the content, for an unknown
/// layout.
Recording open_hdf5(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options);

}  // namespace edged
