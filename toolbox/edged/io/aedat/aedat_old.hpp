// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The header of AEDAT 2.0 files of jAER and AEDAT 3.1 files of cAER, and the reader of the former.
#pragma once

#include <optional>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// The content of the header lines, which begin with `#`.
struct OldAedatHeader {
  std::uint64_t bytes = 0;
  std::string version;             ///< "2.0"
  std::string chip;                ///< "DAVIS240C"; "" if unknown
  std::optional<cv::Size> sensor;  ///< size of that chip [px]
  double gyro_lsb_per_dps = 32.8;  ///< +-1000 deg/s, as of the MPU-6150 of these cameras
  double accel_lsb_per_g = 4096;   ///< +-8 g
};

Recording open_aedat2(const std::filesystem::path& file, const OldAedatHeader& header, cv::Size sensor);

}  // namespace edged
