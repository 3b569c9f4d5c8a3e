// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes a folder as a zip archive.
#pragma once

#include <filesystem>

namespace edged {

/// Writes all files of the folder and its subfolders, under its name, except `file` itself. Replaces `file` atomically,
/// after all is written. Throws InputError if a file cannot be read or the archive cannot be written.
void zip_folder(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace edged
