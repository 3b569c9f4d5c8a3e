// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What data sets keep in files beside that of their events: images, IMU samples, ground truth.
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
  std::string set = {};                 ///< "dsec", "vector", "tum-vie", "eds"; "" where no set is recognised
  std::optional<cv::Size> sensor = {};  ///< of the event camera [px], as all recordings of the set have it
  std::optional<StampedLines<FrameEntry>::Spec> frames = {};
  std::optional<StampedLines<ImuSample>::Spec> imu = {};
  TruthSource truth = {};
};

/// Of a file whose events are laid out as those of DSEC ("dsec") or EDS ("eds"), by the names of what lies around it.
/// own_imu: false leaves the IMU file closed.
SideFiles find_side_files(const std::filesystem::path& events_file, std::string_view layout, bool own_imu = true);

}  // namespace edged
