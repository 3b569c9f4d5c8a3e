// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/mode.hpp"

#include <map>

#include "edged/core/check.hpp"
#include "edged/core/dataset.hpp"

namespace edged {
namespace {

const std::map<std::string, Mode> kModes = {{"events", Mode::Events}, {"frames", Mode::Frames}, {"fused", Mode::Fused}};

}  // namespace

const RigCamera* used_camera(const Rig& rig, Mode mode, Modality modality) {
  if (!uses(mode, modality)) return nullptr;
  if (const RigCamera* camera = rig.find(modality)) return camera;
  const bool events = modality == Modality::Events;
  throw InputError::format("rig '{}' has no {} camera: choose --mode {} or another rig", rig.name,
                           events ? "event" : "frame", events ? "frames" : "events");
}

std::string mode_name(Mode mode) {
  for (const auto& [name, value] : kModes) {
    if (value == mode) return name;
  }
  EDGED_CHECK(false, "mode {}", static_cast<int>(mode));
}

Mode parse_mode(const std::string& name) {
  const auto found = kModes.find(name);
  if (found == kModes.end()) throw InputError::format("mode '{}': there are events, frames and fused", name);
  return found->second;
}

Mode choose_mode(const std::string& wanted, const DatasetInfo& info) {
  if (!info.has_imu) throw InputError::format("{}: has no IMU samples, and every mode needs them", info.name);
  const bool fusible = info.has_events && info.has_frames;
  const Mode mode = wanted != "auto"  ? parse_mode(wanted)
                    : fusible         ? Mode::Fused
                    : info.has_events ? Mode::Events
                                      : Mode::Frames;
  if (mode != Mode::Frames && !info.has_events) {
    throw InputError::format("{}: has no events; use --mode frames", info.name);
  }
  if (mode != Mode::Events && !info.has_frames) {
    throw InputError::format("{}: has no frames; use --mode events", info.name);
  }
  return mode;
}

}  // namespace edged
