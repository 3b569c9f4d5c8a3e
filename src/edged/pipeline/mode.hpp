// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which cameras a mode uses, and the mode that fits a recording.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "edged/options.hpp"
#include "edged/rig.hpp"

namespace edged {

struct DatasetInfo;

constexpr bool uses(Mode mode, Modality modality) {
  return mode != (modality == Modality::Events ? Mode::Frames : Mode::Events);
}

/// Value of the option `cameras`: the first camera of each modality.
inline constexpr std::string_view kFirstCameras = "first";

/// The names in the option `cameras`, separated by commas, without blanks.
std::vector<std::string> camera_names(const std::string& list);

/// The cameras of a run: event cameras, then frame cameras, each in the order of the rig. wanted: their names,
/// separated by commas, of which the mode uses those of its modalities; empty or kFirstCameras: the first of each.
/// Throws an InputError that lists the known names, for a name that is unknown or given twice, and if a modality has
/// none.
Rig used_cameras(const Rig& rig, Mode mode, const std::string& wanted = "");

/// The given mode, or for "auto" the one with all modalities of the recording. Throws InputError if it lacks a sensor.
Mode choose_mode(const std::string& wanted, const DatasetInfo& info);

}  // namespace edged
