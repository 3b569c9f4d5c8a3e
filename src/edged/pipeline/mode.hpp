// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which cameras a mode uses, and the mode that fits a recording.
#pragma once

#include <string>

#include "edged/options.hpp"
#include "edged/rig.hpp"

namespace edged {

struct DatasetInfo;

constexpr bool uses(Mode mode, Modality modality) {
  return mode != (modality == Modality::Events ? Mode::Frames : Mode::Events);
}

/// The rig's first camera of the modality, null where the mode does not use one. Throws InputError when the rig lacks
/// it.
const RigCamera* used_camera(const Rig& rig, Mode mode, Modality modality);

/// The mode asked for, or for "auto" the most that the recording holds. Throws InputError where it lacks a sensor.
Mode choose_mode(const std::string& wanted, const DatasetInfo& info);

}  // namespace edged
