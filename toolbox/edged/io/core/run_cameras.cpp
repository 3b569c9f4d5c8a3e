// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/core/run_cameras.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "edged/camera/field_of_view.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

constexpr double kUsualDistance_m = 3.0;   // of what the cameras see
constexpr double kLeastSharedView = 0.25;  // fewer features have a match than tracking needs

/// Null where the rig does not name it: its only camera of that kind is taken for it then.
const RigCamera* named_camera(const Rig& rig, const RecordedCamera& recorded) {
  const auto found = std::ranges::find_if(rig.cameras, [&](const RigCamera& camera) {
    return camera.name == recorded.name && camera.modality == recorded.modality;
  });
  return found == rig.cameras.end() ? nullptr : &*found;
}

}  // namespace

std::vector<std::string> stereo_cameras(const Rig& rig, const DatasetInfo& info) {
  const std::vector<RecordedCamera> recorded = recorded_cameras(info);
  std::vector<std::string> names;
  bool pair = false;
  for (const Modality modality : {Modality::Events, Modality::Frames}) {
    const auto first = std::ranges::find(recorded, modality, &RecordedCamera::modality);
    if (first == recorded.end()) continue;
    names.push_back(first->name);
    const RigCamera* one = named_camera(rig, *first);
    const auto second = std::find_if(std::next(first), recorded.end(), [&](const RecordedCamera& camera) {
      const RigCamera* other = camera.modality == modality ? named_camera(rig, camera) : nullptr;
      return one && other && shared_view(*one, *other, kUsualDistance_m) >= kLeastSharedView;
    });
    if (second == recorded.end()) continue;
    names.push_back(second->name);
    pair = true;
  }
  return pair ? names : std::vector<std::string>();
}

Recording open_with_stereo_cameras(const OpenCameras& open, std::vector<std::string>& cameras) {
  std::optional<Recording> recording;
  try {
    recording = open({}, true);
  } catch (const InputError& e) {
    Recording one = open({}, false);  // throws where it is the recording that is wrong
    spdlog::warn(fmt::format("{}; one camera of each kind is used", e.what()));
    return one;
  }
  const DatasetInfo& info = recording->dataset->info();
  if (recording->calibration) cameras = stereo_cameras(recording->calibration->rig, info);
  if (!cameras.empty())
    spdlog::info(
        fmt::format("cameras {}: views overlap; --set cameras=first uses one of each kind", fmt::join(cameras, ", ")));
  if (info.more_cameras.empty() || cameras.size() == recorded_cameras(info).size()) return std::move(*recording);
  recording.reset();
  return open(cameras, false);
}

}  // namespace edged
