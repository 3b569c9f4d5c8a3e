// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Folders of no known layout: one file is the recording, others may accompany it. Internal to io.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/archive/source_path.hpp"

namespace edged {

/// The name of the only file of the folder that is a recording: one whose first bytes `recognizes` accepts, else a
/// plain event file. Throws InputError for several.
std::optional<std::string> find_main_file(const SourcePath& folder, bool (*recognizes)(ByteSpan head));

/// The only text file of the folder, without those named, that holds IMU samples by its heading or its name. Of
/// several, none is chosen, with a warning.
std::optional<SourcePath> find_imu_beside(const SourcePath& folder, const std::set<std::string>& others);

/// Logs the subfolders, and the files with data, pictures or a calibration, that are not read.
void warn_unread(const SourcePath& folder, const std::set<std::string>& read);

}  // namespace edged
