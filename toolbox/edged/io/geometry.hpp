// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The size of an event sensor and the lens before it, from whoever knows them.
#pragma once

#include <filesystem>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "edged/core/check.hpp"
#include "edged/rig.hpp"

namespace edged {

/// "640x480"; nothing where it is no size.
std::optional<cv::Size> parse_geometry(std::string_view text);

/// Warns where the focal length [px] of a recording's camera differs by more than 2 % from that of the rig.
void warn_of_other_lens(const std::string& file, double focal_px, const Rig& rig, Modality modality);

/// Nobody says how large the sensor is.
class UnknownSensorSize : public InputError {
 public:
  using InputError::InputError;
};

/// Size of the event sensor of a file: of the rig, else as said by the user or the file. Warns where they differ,
/// throws UnknownSensorSize where nobody says it.
cv::Size event_sensor_size(const std::filesystem::path& file, std::optional<cv::Size> said, const Rig* rig);

}  // namespace edged
