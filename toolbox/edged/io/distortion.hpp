// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The distortion of a lens as files name it, alike in all calibrations and messages. Internal to io.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "edged/rig.hpp"

namespace edged {

struct Distortion {
  DistortionModel model = DistortionModel::None;
  std::array<double, 5> k{};
};

/// name: as any of the formats has it. Files write as many coefficients as OpenCV can have (4, 5, 8, 12 or 14); those
/// that the model lacks must be zero. Where all are zero there is no distortion, whatever the model. Throws InputError,
/// which names the model and the first coefficient that is not supported.
Distortion make_distortion(std::string_view name, const std::vector<double>& coefficients);

}  // namespace edged
