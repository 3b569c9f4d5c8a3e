// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run_context.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "common/cli.hpp"

namespace edged {
namespace {

/// The chosen frame, or the convention of the format, if the calibration has that.
std::string frame_name(const std::string& wanted, const Source& source) {
  const std::string& usual = source.dataset->info().pose_frame;
  const bool has_usual = std::ranges::count(source.calibration.rig.cameras, usual, &RigCamera::name) > 0;
  return wanted != "auto" ? wanted : has_usual ? usual : "body";
}

}  // namespace

RunContext::RunContext(const RunOptions& run_options, Source recording, Mode run_mode, const RunConfig& run_config)
    : options(run_options),
      source(std::move(recording)),
      mode(run_mode),
      config(run_config),
      frame(source.calibration.rig, frame_name(options.frame, source)),
      used(used_cameras(source.calibration.rig, mode, config.odometry.cameras)),
      rig(used) {}

Rig RunContext::estimated_rig() const { return rig_for_poses(source.calibration.rig, rig); }

std::vector<std::string> RunContext::heading(const OutputFrame& of, const std::string& known_when) const {
  return {fmt::format("{}; {}", of.describe(), known_when),
          fmt::format("edged {}, recording {}, mode {}", kVersion, info().name, mode_name(mode))};
}

}  // namespace edged
