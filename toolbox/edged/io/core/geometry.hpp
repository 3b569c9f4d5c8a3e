// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The size of the event sensor of a file, and checks of size and focal length against the rig.
#pragma once

#include <filesystem>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "edged/core/check.hpp"
#include "edged/rig.hpp"

namespace edged {

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
