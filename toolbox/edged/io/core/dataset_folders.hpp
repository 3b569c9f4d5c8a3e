// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The layout of the folders of the Event-Camera Dataset and of EuRoC, and their calibrations. Internal to io.
#pragma once

#include <opencv2/core/types.hpp>
#include <optional>
#include <string>

#include "edged/io/calibration_data.hpp"
#include "edged/io/parse/image_codec.hpp"
#include "edged/io/parse/stamped_lines.hpp"

namespace edged {

/// True if the folder contains a file of the Event-Camera Dataset.
bool is_ecd_folder(const SourcePath& folder);
/// The number in the files of a camera, from 0 on: "" of events.txt, "2" of events2.txt, an extension of the layout.
std::string ecd_number(std::size_t camera);
/// The list of images: images.txt, or left_images.txt of UZH-FPV; of the second camera images2.txt or right_images.txt.
/// Nothing if the folder has none.
std::optional<SourcePath> find_ecd_image_list(const SourcePath& folder, std::size_t camera = 0);
/// A list of stamps and images in `folder`, with the columns of its heading, else `t path`.
StampedLines<FrameEntry>::Spec image_lines(const SourcePath& list, const SourcePath& folder, TimeUnit unit);
/// The image list of a folder that has one.
StampedLines<FrameEntry>::Spec ecd_images(const SourcePath& folder, std::size_t camera = 0);
/// The first image name in the list.
std::optional<std::string> first_ecd_image(const SourcePath& folder, std::size_t camera = 0);
/// Size of the first readable image of the list.
std::optional<cv::Size> ecd_image_size(const SourcePath& folder);
inline constexpr int kEcdWidth = 240, kEcdHeight = 180;  ///< DAVIS240, the sensor of the data set: the default size

/// The folder itself or its mav0: the one that holds cam0 or imu0.
std::optional<SourcePath> find_mav0(const SourcePath& folder);

/// load_calibration(), also from files in an archive.
Calibration read_calibration(const SourcePath& path, const CalibrationOptions& options = {});

}  // namespace edged
