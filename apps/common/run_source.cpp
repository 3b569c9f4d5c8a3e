// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/run_source.hpp"

#include <optional>
#include <utility>

#include "common/log.hpp"
#include "edged/io/core/run_cameras.hpp"

namespace edged {

Source open_run_source(SourceOptions& options) {
  if (!options.cameras.empty() || is_live(options) || simulator_config(options)) return open_source(options);
  std::optional<HeldWarnings> of_all_cameras;  // which may be opened again, with those of the run: said once then
  const auto open = [&](const std::vector<std::string>& cameras, bool all) {
    if (of_all_cameras) of_all_cameras->take();
    of_all_cameras.reset();
    if (all) of_all_cameras.emplace();
    SourceOptions chosen = options;
    chosen.cameras = cameras;
    chosen.all_cameras = all;
    return open_uncalibrated(chosen);
  };
  std::vector<std::string> cameras;
  Recording recording = open_with_stereo_cameras(open, cameras);
  of_all_cameras.reset();
  options.cameras = cameras;
  return calibrated(options, std::move(recording));
}

}  // namespace edged
