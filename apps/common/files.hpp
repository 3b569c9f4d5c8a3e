// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Output files of a command: complete or absent, and errors with a remedy.
#pragma once

#include <filesystem>
#include <fstream>
#include <opencv2/core/mat.hpp>
#include <string>

namespace edged {

/// Replaces the file atomically: readers find the old one or the new one, even if the program is killed meanwhile.
/// Throws InputError when it cannot be written.
void write_file(const std::filesystem::path& file, const std::string& content);

/// The temporary file of write_file.
std::filesystem::path part_of(std::filesystem::path file);

/// Throws InputError where the file cannot be written, as those below do.
std::ofstream open_for_writing(const std::filesystem::path& file);

/// Throws InputError, which names the option, if the file cannot be written. Called before a long run whose result
/// could not be saved.
void check_writable(const std::filesystem::path& file, const char* option);

/// Throw InputError where --out cannot be used.
void make_picture_folder(const std::filesystem::path& folder);
void write_picture(const std::filesystem::path& file, const cv::Mat& image);

}  // namespace edged
