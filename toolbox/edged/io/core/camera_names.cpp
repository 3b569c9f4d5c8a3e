// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/core/camera_names.hpp"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "edged/camera/field_of_view.hpp"
#include "edged/core/check.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

/// "left (events), right (frames)"
std::string camera_list(const auto& cameras) {
  const auto described = [](const auto& camera) {
    return fmt::format("{} ({})", camera.name, kind_name(camera.modality));
  };
  return cameras.empty() ? "none" : fmt::format("{}", fmt::join(texts_of(cameras, described), ", "));
}

[[noreturn]] void refuse(const Rig& rig, const DatasetInfo& info, Modality modality, const std::string& reason) {
  const bool events = modality == Modality::Events;
  const std::string& wanted = events ? info.event_camera : info.frame_camera;
  const bool one_of_others = rig.cameras.size() == 1 && rig.cameras.front().modality != modality;
  const std::string remedy =
      one_of_others ? "; " + davis_remedy(rig.cameras.front().name, "rig.yaml")
                    : fmt::format(
                          "; name the camera of the {} '{}' in the calibration (`edged calib FILE --camera "
                          "NAME={}:{} --out rig.yaml` renames it)",
                          kind_name(modality), wanted, kind_name(modality), wanted);
  throw InputError::format("{}: holds {}; rig '{}' has the cameras {}: {}{}, or run with --mode {}", info.name,
                           camera_list(recorded_cameras(info)), rig.name, camera_list(rig.cameras), reason, remedy,
                           events ? "frames" : "events");
}

/// The cameras beside the first must have the names of the rig: readers name them so where they can.
void check_further_cameras(const Rig& rig, const DatasetInfo& info, Modality modality) {
  for (const RecordedCamera& recorded : info.more_cameras) {
    if (recorded.modality != modality) continue;
    const auto named = std::ranges::find(rig.cameras, recorded.name, &RigCamera::name);
    if (named == rig.cameras.end())
      throw InputError::format(
          "{}: holds {}; rig '{}' has the cameras {}: none is called '{}'; name it so in the calibration, or choose "
          "others in the option cameras",
          info.name, camera_list(recorded_cameras(info)), rig.name, camera_list(rig.cameras), recorded.name);
    if (named->modality != modality)
      refuse(rig, info, modality, fmt::format("'{}' is not of {}", recorded.name, kind_name(modality)));
  }
}

/// The words that tell cameras apart: "left", or the name of a camera.
bool is_stream_of(const std::string& camera, const std::string& stream) {
  const std::string name = lower_case(camera), text = lower_case(stream);
  for (const char* word : {"left", "right", "front", "rear", "back"})
    if (name.find(word) != std::string::npos) return text.find(word) != std::string::npos;
  return text.find(name) != std::string::npos;
}

/// The camera of each stream by words, if there is exactly one for each.
std::vector<std::string> named_by_words(const std::vector<std::string>& cameras,
                                        const std::vector<std::string>& streams) {
  std::vector<std::string> names;
  for (const std::string& stream : streams) {
    const auto fits = [&](const std::string& camera) { return is_stream_of(camera, stream); };
    const auto first = std::ranges::find_if(cameras, fits);
    if (first == cameras.end() || std::ranges::count_if(cameras, fits) > 1) return {};
    if (std::ranges::find(names, *first) != names.end()) return {};
    names.push_back(*first);
  }
  return names;
}

/// Those of one kind in the rig; none without a rig.
std::vector<std::string> rig_names(const Rig* rig, Modality modality) {
  std::vector<std::string> names;
  if (rig)
    for (const RigCamera& camera : rig->cameras)
      if (camera.modality == modality) names.push_back(camera.name);
  return names;
}

constexpr double kUsualDistance_m = 3.0;   // of what the cameras see
constexpr double kLeastSharedView = 0.25;  // fewer features have a match than tracking needs

/// Null where the rig does not name it.
const RigCamera* named_camera(const Rig& rig, Modality modality, std::string_view name) {
  const auto fits = [&](const RigCamera& camera) { return camera.name == name && camera.modality == modality; };
  const auto found = std::ranges::find_if(rig.cameras, fits);
  return found == rig.cameras.end() ? nullptr : &*found;
}

std::optional<int> pixels(std::string_view text) {
  const auto value = parse_whole<int>(text);
  return value && *value >= 1 && *value <= 16384 ? value : std::nullopt;
}

}  // namespace

std::string kind_name(Modality modality) { return modality == Modality::Events ? "events" : "frames"; }

std::vector<std::size_t> cameras_to_read(const std::vector<std::string>& names, const std::vector<std::string>& wanted,
                                         bool all) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (all || std::ranges::find(wanted, names[i]) != wanted.end()) places.push_back(i);
  if (places.empty() && !names.empty()) places.push_back(0);
  return places;
}

std::string usual_camera_name(Modality modality, std::size_t index) {
  return kind_name(modality) + (index == 0 ? "" : std::to_string(index + 1));
}

std::string recorded_camera_names(const DatasetInfo& info) {
  return fmt::format("{}", fmt::join(texts_of(recorded_cameras(info), &RecordedCamera::name), ", "));
}

std::optional<std::string> camera_by_usual_name(const std::vector<RecordedCamera>& all, std::string_view name) {
  std::size_t events = 0, frames = 0;
  for (const RecordedCamera& camera : all) {
    std::size_t& place = camera.modality == Modality::Events ? events : frames;
    if (name == usual_camera_name(camera.modality, place++)) return camera.name;
  }
  return std::nullopt;
}

NamedStreams name_streams(const Rig* rig, Modality modality, const std::vector<std::string>& streams,
                          const std::vector<std::string>& wanted, const std::string& file) {
  NamedStreams named;
  for (std::size_t i = 0; i < streams.size(); ++i) named.names.push_back(usual_camera_name(modality, i));
  const std::vector<std::string> cameras = rig_names(rig, modality);
  const auto is_among = [](const std::vector<std::string>& names) {
    return [&names](const std::string& name) { return std::ranges::find(names, name) != names.end(); };
  };
  if (cameras.size() < streams.size() || std::ranges::all_of(named.names, is_among(cameras))) return named;
  if (cameras.size() < 2 && std::ranges::none_of(cameras, is_among(wanted))) return named;
  std::vector<std::string> by_words = named_by_words(cameras, streams);
  const bool words = !by_words.empty();
  if (!words && cameras.size() != streams.size()) return named;
  named.names = words ? std::move(by_words) : cameras;
  if (cameras.size() < 2) return named;
  named.said = fmt::format("{}: cameras are assigned {}:", file, words ? "by their names" : "in order");
  for (std::size_t i = 0; i < streams.size(); ++i)
    named.said += fmt::format("{} {} is '{}'", i == 0 ? "" : ",", streams[i], named.names[i]);
  return named;
}

std::string davis_remedy(std::string_view camera, std::string_view file) {
  return fmt::format("of a DAVIS, `edged calib FILE --camera {}=both --out {}` gives both its lens", camera, file);
}

std::string match_camera(Rig& rig, const DatasetInfo& info, Modality modality) {
  check_further_cameras(rig, info, modality);
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

std::vector<std::string> stereo_cameras(const Rig& rig, const DatasetInfo& info) {
  const std::vector<RecordedCamera> recorded = recorded_cameras(info);
  std::vector<std::string> names;
  bool pair = false;
  for (const Modality modality : {Modality::Events, Modality::Frames}) {
    const auto first = std::ranges::find(recorded, modality, &RecordedCamera::modality);
    if (first == recorded.end()) continue;
    names.push_back(first->name);
    const RigCamera* one = named_camera(rig, modality, first->name);
    const auto second = std::find_if(std::next(first), recorded.end(), [&](const RecordedCamera& camera) {
      const RigCamera* other = camera.modality == modality ? named_camera(rig, modality, camera.name) : nullptr;
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

const RigCamera* find_camera(const Rig& rig, Modality modality, std::string_view name) {
  const RigCamera* named = named_camera(rig, modality, name);
  return named ? named : rig.find(modality);
}

std::optional<cv::Size> parse_geometry(std::string_view text) {
  const std::size_t cut = text.find('x');
  if (cut == std::string_view::npos) return std::nullopt;
  const auto width = pixels(text.substr(0, cut)), height = pixels(text.substr(cut + 1));
  return width && height ? std::optional(cv::Size(*width, *height)) : std::nullopt;
}

void warn_of_other_lens(const std::string& file, double focal_px, const Rig& rig, Modality modality,
                        std::string_view name) {
  constexpr double kTolerance = 0.02;
  const RigCamera* camera = find_camera(rig, modality, name);
  if (!camera || std::abs(focal_px / camera->model.mean_focal() - 1.0) <= kTolerance) return;
  spdlog::warn(fmt::format("{}: focal length {:.1f} px, but the rig {} has {:.1f} px: is it the right one?", file,
                           focal_px, rig.name, camera->model.mean_focal()));
}

cv::Size event_sensor_size(const std::filesystem::path& file, std::optional<cv::Size> said, const Rig* rig,
                           std::string_view name) {
  if (const RigCamera* camera = rig ? find_camera(*rig, Modality::Events, name) : nullptr) {
    const cv::Size size(camera->model.width(), camera->model.height());
    if (said && *said != size)
      spdlog::warn(fmt::format(
          "{}: the sensor has {} x {} px, but the event camera of rig {} has {} x {} px: is it the right one?",
          file.string(), said->width, said->height, rig->name, size.width, size.height));
    return size;
  }
  if (said) return *said;
  throw UnknownSensorSize(
      fmt::format("{}: does not hold the size of its sensor; give --geometry WIDTHxHEIGHT", file.string()));
}

}  // namespace edged
