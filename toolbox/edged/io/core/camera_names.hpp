// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Assigns the cameras of a recording to the cameras of a rig, chooses those of a run, and checks their sizes and focal
// lengths.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/dataset.hpp"
#include "edged/io/recording.hpp"
#include "edged/rig.hpp"

namespace edged {

/// The remedy where a calibration has a camera of one kind alone, but the recording is of a DAVIS; file: to be written.
std::string davis_remedy(std::string_view camera, std::string_view file);

/// Assigns the camera of the recording of this modality to a camera of the rig: the one of the same name, else the only
/// one of the modality. Renames that camera to the name in the recording, which ground truth and output frames use, so
/// that Rig::find returns it. Returns the assumption in one line, empty if the names agree. Throws InputError, with the
/// cameras of both, if no camera or several fit.
std::string match_camera(Rig& rig, const DatasetInfo& info, Modality modality);

/// The places of the cameras of one kind that are read: all, else those of the wanted names, else the first.
std::vector<std::size_t> cameras_to_read(const std::vector<std::string>& names, const std::vector<std::string>& wanted,
                                         bool all);

/// "events", "events2", ..., "frames", "frames2", ...: the names of cameras in formats that do not name them.
std::string usual_camera_name(Modality modality, std::size_t index);

/// The camera that readers without names of their own would call so: "events2" is the second event camera of `all`,
/// which are those of the recording, read or not, of each kind the first first.
std::optional<std::string> camera_by_usual_name(const std::vector<RecordedCamera>& all, std::string_view name);

/// "left, right": the cameras of a recording, for messages.
std::string recorded_camera_names(const DatasetInfo& info);

/// "events" or "frames".
std::string kind_name(Modality modality);

/// The camera names of the streams of one kind in a recording.
struct NamedStreams {
  std::vector<std::string> names;  ///< in the order of the streams
  std::string said;                ///< an assumption in one line; empty without one
};

/// The usual names, but those of the rig where it has several cameras of the kind, or where one is wanted by its name:
/// by the words of the names ("left" of "/left/events"), else in order if the rig has as many as there are streams.
/// file: for the line.
NamedStreams name_streams(const Rig* rig, Modality modality, const std::vector<std::string>& streams,
                          const std::vector<std::string>& wanted, const std::string& file);

/// The cameras of a run by default: of each kind that the recording delivers the first, and one more of the rig whose
/// view overlaps the first one's. Empty where there is none of these: then the first of each kind are used.
std::vector<std::string> stereo_cameras(const Rig& rig, const DatasetInfo& info);

/// Opens a recording with these cameras, else all, else the first of each kind.
using OpenCameras = std::function<Recording(const std::vector<std::string>& cameras, bool all)>;

/// Opens a recording with the cameras of stereo_cameras(), which it puts into `cameras`; where there are none and where
/// not all cameras can be read, with the first of each kind. Throws as `open`.
Recording open_with_stereo_cameras(const OpenCameras& open, std::vector<std::string>& cameras);

/// Parses "640x480". Nothing if the text is no size.
std::optional<cv::Size> parse_geometry(std::string_view text);

/// The camera of that modality and name; if the rig has none of that name, its first of the modality; null without one.
const RigCamera* find_camera(const Rig& rig, Modality modality, std::string_view name);

/// Warns if the focal length [px] of a camera of the recording differs by more than 2 % from that of the rig, whose
/// camera is that of find_camera().
void warn_of_other_lens(const std::string& file, double focal_px, const Rig& rig, Modality modality,
                        std::string_view name = {});

/// The size of the event sensor is unknown.
class UnknownSensorSize : public InputError {
 public:
  using InputError::InputError;
};

/// The size of the event sensor of a file: of the rig, else `said` by the user or the file. Warns if the two differ.
/// Throws UnknownSensorSize without either. name: of the camera, as in find_camera().
cv::Size event_sensor_size(const std::filesystem::path& file, std::optional<cv::Size> said, const Rig* rig,
                           std::string_view name = {});

}  // namespace edged
