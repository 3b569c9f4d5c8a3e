// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How the folders of the Event-Camera Dataset and of EuRoC are laid out. Internal to io.
#pragma once

#include <opencv2/core/types.hpp>
#include <optional>
#include <string>

#include "edged/io/image_file.hpp"
#include "edged/io/stamped_lines.hpp"

namespace edged {

/// Something of an Event-Camera Dataset text folder is there.
bool is_ecd_folder(const SourcePath& folder);
/// Its list of images: images.txt, or left_images.txt of UZH-FPV. Nothing where it has none.
std::optional<SourcePath> find_ecd_image_list(const SourcePath& folder);
/// A list of stamps and images, below `folder`: the columns that its heading names, else `t path`.
StampedLines<FrameEntry>::Spec image_lines(const SourcePath& list, const SourcePath& folder, TimeUnit unit);
/// The image list of the folder, which it has.
StampedLines<FrameEntry>::Spec ecd_images(const SourcePath& folder);
/// The first image that the list names, as it is written there.
std::optional<std::string> first_ecd_image(const SourcePath& folder);
/// Size of the first readable image of its list.
std::optional<cv::Size> ecd_image_size(const SourcePath& folder);
inline constexpr int kEcdWidth = 240, kEcdHeight = 180;  ///< DAVIS240: the data set's sensor where nothing else tells

/// The folder itself or its mav0, whichever holds cam0 or imu0.
std::optional<SourcePath> find_mav0(const SourcePath& folder);

}  // namespace edged
