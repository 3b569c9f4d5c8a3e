// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/mode.hpp"

#include <algorithm>
#include <map>
#include <sstream>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/dataset.hpp"

namespace edged {
namespace {

const std::map<std::string, Mode> kModes = {{"events", Mode::Events}, {"frames", Mode::Frames}, {"fused", Mode::Fused}};

const char* kind_of(Modality modality) { return modality == Modality::Events ? "event" : "frame"; }

std::string listed(const Rig& rig) {
  std::string list;
  for (const RigCamera& camera : rig.cameras)
    list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", camera.name,
                        camera.modality == Modality::Events ? "events" : "frames");
  return list;
}

void check_names(const Rig& rig, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (std::ranges::find(rig.cameras, name, &RigCamera::name) == rig.cameras.end())
      throw InputError::format("option 'cameras': rig '{}' has no '{}'; there are {}", rig.name, name, listed(rig));
    if (std::ranges::count(names, name) > 1)
      throw InputError::format("option 'cameras': '{}' is listed twice; rig '{}' has {}", name, rig.name, listed(rig));
  }
}

}  // namespace

std::vector<std::string> camera_names(const std::string& list) {
  std::vector<std::string> names;
  std::istringstream fields(list);
  for (std::string field; std::getline(fields, field, ',');) {
    const std::size_t begin = field.find_first_not_of(' '), end = field.find_last_not_of(' ');
    names.push_back(begin == std::string::npos ? "" : field.substr(begin, end - begin + 1));
  }
  return names;
}

Rig used_cameras(const Rig& rig, Mode mode, const std::string& wanted) {
  const std::vector<std::string> names = camera_names(wanted == kFirstCameras ? "" : wanted);
  check_names(rig, names);
  Rig used{rig.name, {}};
  for (const Modality modality : {Modality::Events, Modality::Frames}) {
    if (!uses(mode, modality)) continue;
    const std::size_t before = used.cameras.size();
    for (const RigCamera& camera : rig.cameras) {
      const bool chosen = names.empty() ? &camera == rig.find(modality) : std::ranges::count(names, camera.name) > 0;
      if (chosen && camera.modality == modality) used.cameras.push_back(camera);
    }
    if (used.cameras.size() > before) continue;
    if (rig.find(modality) != nullptr)
      throw InputError::format("option 'cameras': '{}' names no {} camera, which --mode {} needs; there are {}", wanted,
                               kind_of(modality), mode_name(mode), listed(rig));
    throw InputError::format("rig '{}' has no {} camera: choose --mode {} or another rig", rig.name, kind_of(modality),
                             modality == Modality::Events ? "frames" : "events");
  }
  return used;
}

std::string mode_name(Mode mode) {
  for (const auto& [name, value] : kModes) {
    if (value == mode) return name;
  }
  EDGED_CHECK(false, "mode {}", static_cast<int>(mode));
}

Mode parse_mode(const std::string& name) {
  const auto found = kModes.find(name);
  if (found == kModes.end()) throw InputError::format("mode '{}': use events, frames or fused", name);
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
