// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// RECORDING on the command line: a folder, or "sim:PRESET[:SEED]" for the simulator; with the calibration that fits it.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "edged/core/dataset.hpp"
#include "edged/io/calibration.hpp"

namespace edged {

struct SourceOptions {
  std::string recording;
  std::string rig;              ///< name of a shipped rig; "" where not given
  std::filesystem::path calib;  ///< calibration file; "" where not given
};

struct Source {
  std::unique_ptr<Dataset> dataset;
  Calibration calibration;
  std::optional<int> seed;  ///< of the simulator
};

/// Throws InputError when nothing can be opened, or no calibration with extrinsics is at hand.
Source open_source(const SourceOptions& options);

}  // namespace edged
