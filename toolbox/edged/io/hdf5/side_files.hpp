// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The files of data sets beside the event file, images, IMU samples, ground truth; and the cameras of a data set: in
// one file, or in a file of its own for each.
#pragma once

#include <filesystem>
#include <functional>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "edged/dataset.hpp"
#include "edged/io/hdf5/layouts.hpp"
#include "edged/io/parse/image_codec.hpp"
#include "edged/io/parse/repairs.hpp"
#include "edged/io/parse/stamped_lines.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// Ground truth, read on demand.
struct TruthSource {
  std::string frame = "body";                                     ///< X of its T_W_X
  std::function<std::optional<GroundTruth>(Repairs&)> read = {};  ///< empty without ground truth
};

struct SideFiles {
  std::string set = {};                 ///< "dsec", "vector", "tum-vie", "eds"; "" if no data set is recognised
  std::optional<cv::Size> sensor = {};  ///< size of the event camera [px] in all recordings of the data set
  std::vector<StampedLines<FrameEntry>::Spec> frames = {};  ///< one for each frame camera, left first
  std::optional<StampedLines<ImuSample>::Spec> imu = {};
  TruthSource truth = {};
};

/// The files around an event file in the layout of DSEC ("dsec") or EDS ("eds"), found by their names. own_imu: false
/// to leave the IMU file unopened.
SideFiles find_side_files(const std::filesystem::path& events_file, std::string_view layout, bool own_imu = true);

/// The events file of the right camera beside or around that of the left one, if it is there.
std::optional<std::filesystem::path> find_right_events(const std::filesystem::path& left_file);

/// Ground truth in HDF5: in the file of the events, or in another file of its folder (MVSEC, M3ED).
TruthSource find_h5_truth(const H5File& events_file, const Hdf5Layout& layout);

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
