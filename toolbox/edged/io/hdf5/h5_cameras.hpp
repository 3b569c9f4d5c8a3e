// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The cameras of a data set in HDF5: in one file, or in a file of its own for each.
#pragma once

#include <filesystem>
#include <variant>
#include <vector>

#include "edged/io/hdf5/layouts.hpp"
#include "edged/io/hdf5/side_files.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// Images of a file with their stamps.
struct H5Images {
  H5Array pixels;
  H5Stamps stamps;
};

/// The cameras of a recording, those that are read.
struct H5Cameras {
  std::vector<RecordedCamera> recorded;  ///< as StreamedDataset needs them
  std::vector<RecordedCamera> known;     ///< also those that are not read
  std::vector<H5Events> events;
  std::vector<std::variant<H5Images, StampedLines<FrameEntry>::Spec>> frames;
  std::vector<std::filesystem::path> cut;  ///< files that end too early
};

/// The cameras of the file and of the files beside it. Options used: geometry, cameras, all_cameras. Throws InputError
/// for an events file beside it that holds no events.
H5Cameras find_h5_cameras(const H5File& file, const Hdf5Layout& layout, const SideFiles& side, const Rig* rig,
                          const RecordingOptions& options);

}  // namespace edged
