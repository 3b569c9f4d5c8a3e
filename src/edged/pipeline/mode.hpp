// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which cameras a mode uses, and the mode that fits a recording.
#pragma once

#include <string>
#include <vector>

#include "edged/options.hpp"
#include "edged/rig.hpp"

namespace edged {

struct DatasetInfo;

constexpr bool uses(Mode mode, Modality modality) {
  return mode != (modality == Modality::Events ? Mode::Frames : Mode::Events);
}

/// Of the option `cameras`: what stands between its commas, without the blanks around.
std::vector<std::string> camera_names(const std::string& list);

/// The cameras of a run: those of events, then those of frames, each as the rig has them. wanted: their names,
/// separated by commas, of which the mode uses what is of its modalities; empty: the first of each. Throws InputError,
/// with the names there are, for a name that there is not or that comes twice, and where none is left of a modality.
Rig used_cameras(const Rig& rig, Mode mode, const std::string& wanted = "");

/// The mode asked for, or for "auto" the most that the recording holds. Throws InputError where it lacks a sensor.
Mode choose_mode(const std::string& wanted, const DatasetInfo& info);

}  // namespace edged
