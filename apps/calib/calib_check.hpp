// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// `edged calib --check`: whether a calibration fits a recording, by a short run over it.
#pragma once

#include <filesystem>
#include <string>

#include "common/source.hpp"

namespace edged {

struct CalibCheckOptions {
  SourceOptions source;
  std::string mode = "auto";
  std::filesystem::path out;  ///< the calibration as found goes there; "" for nowhere
  bool quiet = false, json = false;
};

inline constexpr double kCheckedSeconds = 20.0;  ///< of a recording, unless told otherwise

/// Prints the verdict and returns the exit code: 0 fits, 5 does not, 4 cannot be told.
int check_calibration(CalibCheckOptions options);

}  // namespace edged
