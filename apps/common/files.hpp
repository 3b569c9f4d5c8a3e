// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Files that a command leaves: complete or not there, and a refusal that says what to do.
#pragma once

#include <filesystem>
#include <fstream>
#include <opencv2/core/mat.hpp>
#include <string>

namespace edged {

/// Replaces the file, at once: whoever reads it or ends the program meanwhile finds the old one or the new one. Throws
/// InputError when it cannot be written.
void write_file(const std::filesystem::path& file, const std::string& content);

/// Where write_file writes until the file is complete.
std::filesystem::path part_of(std::filesystem::path file);

/// Throws InputError where the file cannot be written, as those below do.
std::ofstream open_for_writing(const std::filesystem::path& file);

/// Before work begins whose result could then not be kept: throws InputError, which names the option, where the file
/// cannot be written.
void check_writable(const std::filesystem::path& file, const char* option);

/// Throw InputError where --out cannot be used.
void make_picture_folder(const std::filesystem::path& folder);
void write_picture(const std::filesystem::path& file, const cv::Mat& image);

}  // namespace edged
