// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/camera_names.hpp"

#include <algorithm>

#include "edged/core/check.hpp"

namespace edged {
namespace {

const char* kind_name(Modality modality) { return modality == Modality::Events ? "events" : "frames"; }

std::string stream_list(const DatasetInfo& info) {
  std::string list;
  if (info.has_events) list += fmt::format("{} (events)", info.event_camera);
  if (info.has_frames) list += fmt::format("{}{} (frames)", list.empty() ? "" : ", ", info.frame_camera);
  return list;
}

std::string camera_list(const Rig& rig) {
  std::string list;
  for (const RigCamera& camera : rig.cameras)
    list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", camera.name, kind_name(camera.modality));
  return list.empty() ? "none" : list;
}

[[noreturn]] void refuse(const Rig& rig, const DatasetInfo& info, Modality modality, const std::string& reason) {
  const bool events = modality == Modality::Events;
  throw InputError::format(
      "{}: holds {}; rig '{}' has the cameras {}: {}; name the camera of the {} '{}' in the calibration (`edged calib "
      "FILE --camera NAME={} --out rig.yaml` says what it sees), or run with --mode {}",
      info.name, stream_list(info), rig.name, camera_list(rig), reason, kind_name(modality),
      events ? info.event_camera : info.frame_camera, kind_name(modality), events ? "frames" : "events");
}

}  // namespace

std::string match_camera(Rig& rig, const DatasetInfo& info, Modality modality) {
  const std::string& wanted = modality == Modality::Events ? info.event_camera : info.frame_camera;
  const std::string kind = kind_name(modality);
  const auto is_kind = [modality](const RigCamera& camera) { return camera.modality == modality; };
  const auto named = std::ranges::find(rig.cameras, wanted, &RigCamera::name);
  if (named != rig.cameras.end() && is_kind(*named)) {
    const auto first = std::ranges::find_if(rig.cameras, is_kind);
    std::rotate(first, named, std::next(named));
    return "";
  }
  const auto count = std::ranges::count_if(rig.cameras, is_kind);
  if (count == 0) refuse(rig, info, modality, fmt::format("none is of {}", kind));
  if (named != rig.cameras.end()) refuse(rig, info, modality, fmt::format("'{}' is not of {}", wanted, kind));
  if (count > 1) refuse(rig, info, modality, fmt::format("several are of {}, none is called '{}'", kind, wanted));
  RigCamera& camera = *std::ranges::find_if(rig.cameras, is_kind);
  std::string said =
      fmt::format("camera '{}' of the calibration is taken for the recording's '{}': it is the only one of {}",
                  camera.name, wanted, kind);
  camera.name = wanted;
  return said;
}

}  // namespace edged
