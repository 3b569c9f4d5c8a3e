// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Files that are read and replaced as a whole.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace edged {

/// The content; nothing if it cannot be read or is a folder, or a pipe, which would be waited for.
std::optional<std::string> read_file(const std::filesystem::path& file);

/// Whether there is content that does not begin as its kind does: a recording, say.
bool begins_otherwise(const std::filesystem::path& file, std::string_view kind_begins);

/// Replaces the file atomically: readers see the old file or the new one, even if the program is killed meanwhile.
/// Throws InputError if it cannot be written.
void write_file(const std::filesystem::path& file, const std::string& content);

/// The temporary file of write_file.
std::filesystem::path part_of(std::filesystem::path file);

}  // namespace edged
