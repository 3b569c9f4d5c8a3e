// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which sensors beside the IMU: their cameras, modes by name, and the one that fits a recording.
#pragma once

#include <string>

#include "edged/camera/rig.hpp"
#include "edged/core/dataset.hpp"

namespace edged {

enum class Mode { Events, Frames, Fused };

constexpr bool uses(Mode mode, Modality modality) {
  return mode != (modality == Modality::Events ? Mode::Frames : Mode::Events);
}

/// The rig's first camera of the modality, null where the mode does not use one. Throws InputError when the rig lacks
/// it.
const RigCamera* used_camera(const Rig& rig, Mode mode, Modality modality);

/// "events", "frames" or "fused".
std::string mode_name(Mode mode);

/// The mode of that name. Throws InputError that lists them.
Mode parse_mode(const std::string& name);

/// The mode asked for, or for "auto" the most that the recording holds. Throws InputError where it lacks a sensor.
Mode choose_mode(const std::string& wanted, const DatasetInfo& info);

}  // namespace edged
