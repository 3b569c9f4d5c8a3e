// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/hdf5/side_files.hpp"

#include <spdlog/spdlog.h>

#include <string>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/io/core/camera_names.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

std::optional<H5Images> find_images(const H5File& file, const Hdf5Layout& layout, std::size_t camera) {
  auto pixels = file.find(path_of_camera(layout.images, camera)),
       stamps = file.find(path_of_camera(layout.image_stamps, camera));
  if (!pixels || !stamps || pixels->shape().size() < 3 || pixels->shape().size() > 4) return std::nullopt;
  return H5Images{std::move(*pixels), H5Stamps(std::move(*stamps))};
}

/// Width and height from the file.
std::optional<cv::Size> stated_sensor(const H5File& file, const Hdf5Layout& layout, std::size_t camera) {
  const auto pair = [](double width, double height) -> std::optional<cv::Size> {
    if (!(width >= 1 && width <= 16384 && height >= 1 && height <= 16384)) return std::nullopt;
    return cv::Size(static_cast<int>(width), static_cast<int>(height));
  };
  for (const std::string& object : {path_of_camera(layout.events, camera), std::string("/")}) {
    if (object.empty()) continue;
    const auto width = file.number_attribute(object, "width"), height = file.number_attribute(object, "height");
    if (width && height) return pair(static_cast<double>(*width), static_cast<double>(*height));
    if (const auto text = file.text_attribute(object, "geometry")) return parse_geometry(*text);
  }
  const auto sensor = file.find(path_of_camera(layout.sensor, camera));
  if (!sensor || sensor->rows() != 2 || sensor->columns() != 1) return std::nullopt;
  try {
    const auto size = sensor->read<double>(0, 2);
    return pair(size[0], size[1]);
  } catch (const Damage&) {
    return std::nullopt;
  }
}

/// Where the events of a camera lie.
struct EventsPlace {
  fs::path file;
  std::size_t camera = 0;  ///< within the file
};

/// The places of all event cameras: in the file itself, else in that of the right camera.
std::vector<EventsPlace> event_places(const H5File& file, const Hdf5Layout& layout) {
  std::vector<EventsPlace> places = {{file.path(), 0}};
  while (H5Events::find(file, layout, places.size())) places.push_back({file.path(), places.size()});
  const bool one_a_file = places.size() < 2 && !layout.offset.empty();
  if (const auto right = one_a_file ? find_right_events(file.path()) : std::nullopt) places.push_back({*right, 0});
  return places;
}

/// Names the cameras of a kind and adds them to those that are known. Returns the places of those that are read. Logs
/// how they are assigned to the rig.
std::vector<std::size_t> choose_cameras(H5Cameras& cameras, const std::vector<std::string>& streams, Modality modality,
                                        const Rig* rig, const RecordingOptions& options) {
  if (streams.empty()) return {};
  const NamedStreams named = name_streams(rig, modality, streams, options.cameras, streams.front());
  if (!named.said.empty()) spdlog::warn(named.said);
  for (std::size_t i = 0; i < streams.size(); ++i) cameras.known.push_back({named.names[i], modality, streams[i]});
  return cameras_to_read(named.names, options.cameras, options.all_cameras);
}

void add_event_cameras(H5Cameras& cameras, const H5File& main, const Hdf5Layout& layout,
                       const std::optional<cv::Size>& usual_sensor, const Rig* rig, const RecordingOptions& options) {
  const std::vector<EventsPlace> places = event_places(main, layout);
  std::vector<std::string> streams;
  for (const EventsPlace& place : places)
    streams.push_back(place.file == main.path() ? path_of_camera(layout.events, place.camera) : place.file.string());
  for (const std::size_t i : choose_cameras(cameras, streams, Modality::Events, rig, options)) {
    RecordedCamera recorded = cameras.known[i];
    const auto& [path, camera] = places[i];
    const H5File file(path);
    auto events = H5Events::find(file, layout, camera);
    if (!events)
      throw InputError::format("{}: has no events in the layout of {}; leave it out with --set cameras={}",
                               path.string(), main.path().filename().string(), cameras.known.front().name);
    if (file.cut()) cameras.cut.push_back(path);
    auto stated = options.geometry ? options.geometry : stated_sensor(file, layout, camera);
    if (!stated) stated = usual_sensor;
    if (!stated && layout.width > 0) stated = cv::Size(layout.width, layout.height);
    recorded.sensor = event_sensor_size(path, stated, rig, recorded.name);
    cameras.recorded.push_back(recorded);
    cameras.events.push_back(std::move(*events));
  }
}

void add_frame_cameras(H5Cameras& cameras, const H5File& file, const Hdf5Layout& layout, const SideFiles& side,
                       const Rig* rig, const RecordingOptions& options) {
  decltype(H5Cameras::frames) frames;
  std::vector<std::string> streams;
  while (auto images = find_images(file, layout, streams.size())) {
    streams.push_back(path_of_camera(layout.images, streams.size()));
    frames.emplace_back(std::move(*images));
  }
  if (frames.empty())
    for (const auto& list : side.frames) {
      streams.push_back(list.file.string());
      frames.emplace_back(list);
    }
  const std::size_t before = cameras.known.size();
  for (const std::size_t i : choose_cameras(cameras, streams, Modality::Frames, rig, options)) {
    cameras.recorded.push_back(cameras.known[before + i]);
    cameras.frames.push_back(std::move(frames[i]));
  }
}

}  // namespace

H5Cameras find_h5_cameras(const H5File& file, const Hdf5Layout& layout, const SideFiles& side, const Rig* rig,
                          const RecordingOptions& options) {
  H5Cameras cameras;
  add_event_cameras(cameras, file, layout, side.sensor, rig, options);
  add_frame_cameras(cameras, file, layout, side, rig, options);
  return cameras;
}

}  // namespace edged
