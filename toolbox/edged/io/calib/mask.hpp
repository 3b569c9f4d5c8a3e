// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Pixels of a camera that are to be ignored: as the picture that a user draws, and as text, so that a calibration that
// is written anew stays one file. Internal to io.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edged/io/calib/yaml_reader.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Of the picture that the value names, relative to its file: 0 where it is darker than middle grey. InputError where
/// it is missing, no picture, or not of the camera's size.
std::vector<std::uint8_t> read_mask(const YamlReader& picture, const CameraModel& camera);

/// The same of numbers of pixels, used and ignored by turns, beginning with used ones, row by row.
std::vector<std::uint8_t> read_mask_runs(const YamlReader& runs, const CameraModel& camera);
/// What read_mask_runs takes, in lines of bounded length.
std::string mask_runs(const CameraModel& camera);

/// Of all pixels of the camera.
double ignored_share(const CameraModel& camera);

}  // namespace edged
