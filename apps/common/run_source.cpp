// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/run_source.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "common/log.hpp"
#include "edged/camera/field_of_view.hpp"
#include "edged/core/check.hpp"

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

namespace {

/// The recording with all cameras, where the run uses all of them; else nothing, as it is opened again with those of
/// the run: so far it has said nothing then, to say it once. Puts the cameras of the run into options, and why not all
/// can be read into refusal.
std::optional<Recording> opened_with_all_cameras(SourceOptions& options, std::string& refusal) {
  HeldWarnings held;
  SourceOptions every = options;
  every.all_cameras = true;
  std::optional<Recording> recording;
  try {
    recording = open_uncalibrated(every);
  } catch (const InputError& e) {
    refusal = e.what();
    held.take();
    return std::nullopt;
  }
  const DatasetInfo& info = recording->dataset->info();
  if (recording->calibration) options.cameras = stereo_cameras(recording->calibration->rig, info);
  if (info.more_cameras.empty() || options.cameras.size() == recorded_cameras(info).size()) return recording;
  held.take();
  return std::nullopt;
}

}  // namespace

Source open_run_source(SourceOptions& options) {
  if (!options.cameras.empty() || is_live(options) || simulator_config(options)) return open_source(options);
  std::string refusal;
  std::optional<Recording> recording = opened_with_all_cameras(options, refusal);
  if (!options.cameras.empty())
    spdlog::info(fmt::format("cameras {}: views overlap; --set cameras=first uses one of each kind",
                             fmt::join(options.cameras, ", ")));
  if (recording) return calibrated(options, std::move(*recording));
  Source source = open_source(options);  // throws where it is the recording that is wrong
  if (!refusal.empty()) spdlog::warn(fmt::format("{}; one camera of each kind is used", refusal));
  return source;
}

}  // namespace edged
