// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The table of lens models, which calibrations, recordings, the simulator and messages follow.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "edged/camera/lens_model.hpp"

namespace edged {

std::span<const LensModel> lens_models();

const LensModel& lens_model(DistortionModel model);

/// By any of its names, in lower case; null where none has it.
const LensModel* find_lens_model(std::string_view name);

/// Both steps of a lens at a point of the unit plane.
Distorted distorted(const LensModel& lens, const LensCoefficients& k, const Eigen::Vector2d& point);

/// In the order of the model, also those that may be missing.
std::vector<std::string_view> coefficient_names(const LensModel& lens);

/// "none, radtan, ...", for messages.
std::string lens_model_names();

}  // namespace edged
