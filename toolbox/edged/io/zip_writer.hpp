// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A folder as one zip archive.
#pragma once

#include <filesystem>

namespace edged {

/// All files of the folder and those below, under its name; not `file` itself, where that lies there. Replaces `file`,
/// at once and only when all is written. Throws InputError where a file cannot be read or the archive not be written.
void zip_folder(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace edged
