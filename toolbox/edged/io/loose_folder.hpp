// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Folders that people put together themselves: one file is the recording, others lie beside it. Internal to io.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "edged/io/bytes.hpp"
#include "edged/io/source_path.hpp"

namespace edged {

/// The name of the one file of the folder that is a recording by its content: one that `recognizes` takes by its first
/// bytes, else a plain event file. Throws InputError where there are several.
std::optional<std::string> find_main_file(const SourcePath& folder, bool (*recognizes)(ByteSpan head));

/// The one text file of the folder, but for those named, that holds IMU samples by its heading or its name. Where there
/// are several, says so and takes none.
std::optional<SourcePath> find_imu_beside(const SourcePath& folder, const std::set<std::string>& others);

/// Says which of the folder's folders, and of its files with data, pictures or a calibration, are not read.
void tell_unread(const SourcePath& folder, const std::set<std::string>& read);

}  // namespace edged
