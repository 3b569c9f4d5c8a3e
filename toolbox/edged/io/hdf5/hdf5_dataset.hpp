// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Data sets whose events come as HDF5: DSEC, VECtor, TUM-VIE, M3ED, MVSEC, EDS and Prophesee's Metavision.
#pragma once

#include <filesystem>
#include <optional>

#include "edged/io/recording.hpp"

namespace edged {

/// The file of a folder that holds the events, some folders deep; of several that of the left camera. Nothing where the
/// folder holds no HDF5. Throws InputError where there are several or none with events.
std::optional<std::filesystem::path> find_hdf5_events(const std::filesystem::path& folder);

/// The layout is found by what the file holds; frames, IMU and ground truth by the names that the sets give the files
/// beside it. Of options: geometry of the event sensor. Throws InputError for an unknown layout, listing
/// what there is.
Recording open_hdf5(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options);

}  // namespace edged
