// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Where tests find real recordings.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace edged {

/// The folder of recordings: $EDGED_DATA, or ../shared/data beside the source. Tests are skipped if one is missing.
inline std::filesystem::path data_folder() {
  if (const char* own = std::getenv("EDGED_DATA")) return own;
  return std::filesystem::path(EDGED_SOURCE_DIR) / ".." / "shared" / "data";
}

}  // namespace edged
