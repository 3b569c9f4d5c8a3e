// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The mask of a camera: as a picture drawn by the user, and as text, so that a written calibration is one file.
// Internal to io.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edged/io/calib/yaml_reader.hpp"
#include "edged/rig.hpp"

namespace edged {

/// The mask from a picture, whose name is relative to the calibration file: 0 where it is darker than middle grey.
/// Throws InputError if the picture is missing, unreadable, or not of the size of the camera.
std::vector<std::uint8_t> read_mask(const YamlReader& picture, const CameraModel& camera);

/// The mask from run lengths: alternately numbers of used and ignored pixels, row by row, beginning with used ones.
std::vector<std::uint8_t> read_mask_runs(const YamlReader& runs, const CameraModel& camera);
/// The run lengths for read_mask_runs, in lines of bounded length.
std::string mask_runs(const CameraModel& camera);

/// The share of all pixels of the camera.
double ignored_share(const CameraModel& camera);

}  // namespace edged
