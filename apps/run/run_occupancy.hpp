// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The options --occupancy, --occupancy-voxel and --occupancy-heights of `edged run`.
#pragma once

#include "common/cli_fwd.hpp"
#include "run/run_options.hpp"

namespace edged {

void add_occupancy_options(CLI::App& app, OccupancyOptions& options);

}  // namespace edged
