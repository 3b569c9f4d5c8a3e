// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The files of data sets beside the event file: images, IMU samples, ground truth.
#pragma once

#include <filesystem>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>

#include "edged/io/hdf5/h5_truth.hpp"
#include "edged/io/image_file.hpp"
#include "edged/io/stamped_lines.hpp"

namespace edged {

struct SideFiles {
  std::string set = {};                 ///< "dsec", "vector", "tum-vie", "eds"; "" if no data set is recognised
  std::optional<cv::Size> sensor = {};  ///< of the event camera [px] in all recordings of the data set
  std::optional<StampedLines<FrameEntry>::Spec> frames = {};
  std::optional<StampedLines<ImuSample>::Spec> imu = {};
  TruthSource truth = {};
};

/// The files around an event file in the layout of DSEC ("dsec") or EDS ("eds"), found by their names. own_imu: false
/// to leave the IMU file unopened.
SideFiles find_side_files(const std::filesystem::path& events_file, std::string_view layout, bool own_imu = true);

}  // namespace edged
