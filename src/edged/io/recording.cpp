// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which format a folder is.
#include "edged/io/recording.hpp"

#include "edged/core/check.hpp"
#include "edged/io/formats.hpp"

namespace edged {

Recording open_recording(const std::filesystem::path& folder, const Rig* rig) {
  std::error_code ignored;
  if (!std::filesystem::exists(folder, ignored)) throw InputError::format("{}: no such folder", folder.string());
  if (!std::filesystem::is_directory(folder, ignored))
    throw InputError::format("{}: is a file; give the folder of the recording (unpack an archive first)",
                             folder.string());
  if (is_ecd_folder(folder)) return open_ecd(folder, rig);
  if (const auto mav0 = find_mav0(folder)) return open_euroc(*mav0);
  throw InputError::format(
      "{}: no recording found; looked for events.txt, images.txt or imu.txt (Event-Camera Dataset) and for "
      "[mav0/]cam0/data.csv or [mav0/]imu0/data.csv (EuRoC)",
      folder.string());
}

}  // namespace edged
