// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How the folders of the Event-Camera Dataset and of EuRoC are laid out. Internal to io.
#pragma once

#include <opencv2/core/types.hpp>
#include <optional>

#include "edged/io/image_file.hpp"
#include "edged/io/stamped_lines.hpp"

namespace edged {

/// Something of an Event-Camera Dataset text folder is there.
bool is_ecd_folder(const SourcePath& folder);
/// Its images.txt as entries of stamp and image.
StampedLines<FrameEntry>::Spec ecd_images(const SourcePath& folder);
/// Size of the first readable image of images.txt.
std::optional<cv::Size> ecd_image_size(const SourcePath& folder);
inline constexpr int kEcdWidth = 240, kEcdHeight = 180;  ///< DAVIS240: the data set's sensor where nothing else tells

/// The folder itself or its mav0, whichever holds cam0 or imu0.
std::optional<SourcePath> find_mav0(const SourcePath& folder);

}  // namespace edged
