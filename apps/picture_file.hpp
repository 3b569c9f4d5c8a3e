// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Pictures that a command leaves in the folder of --out.
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace edged {

/// Both throw InputError where --out cannot be used.
void make_picture_folder(const std::filesystem::path& folder);
void write_picture(const std::filesystem::path& file, const cv::Mat& image);

}  // namespace edged
