// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/run_source.hpp"

#include <algorithm>
#include <utility>

#include "edged/camera/field_of_view.hpp"

namespace edged {
namespace {

constexpr double kUsualDistance_m = 3.0;   // of what the cameras see
constexpr double kLeastSharedView = 0.25;  // fewer features have a match than tracking needs

/// Null where the rig does not name it: its only camera of that kind is taken for it then.
const RigCamera* find_camera(const Rig& rig, const RecordedCamera& recorded) {
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
    const RigCamera* one = find_camera(rig, *first);
    const auto second = std::find_if(std::next(first), recorded.end(), [&](const RecordedCamera& camera) {
      const RigCamera* other = camera.modality == modality ? find_camera(rig, camera) : nullptr;
      return one && other && shared_view(*one, *other, kUsualDistance_m) >= kLeastSharedView;
    });
    if (second == recorded.end()) continue;
    names.push_back(second->name);
    pair = true;
  }
  return pair ? names : std::vector<std::string>();
}

Source open_run_source(SourceOptions& options) {
  if (!options.cameras.empty() || is_live(options) || simulator_config(options)) return open_source(options);
  SourceOptions all = options;
  all.all_cameras = true;
  Source source = open_source(all);
  options.cameras = stereo_cameras(source.calibration.rig, source.dataset->info());
  const std::size_t recorded = recorded_cameras(source.dataset->info()).size();
  const bool several = !source.dataset->info().more_cameras.empty();
  return several && options.cameras.size() < recorded ? open_source(options) : std::move(source);
}

}  // namespace edged
