// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The distortion of a lens, from the names and coefficients in calibrations and messages. Internal to io.
#pragma once

#include <string_view>
#include <vector>

#include "edged/rig.hpp"

namespace edged {

struct Distortion {
  DistortionModel model = DistortionModel::None;
  LensCoefficients k{};
};

/// name: in the naming of any format. Files contain 4, 5, 8, 12 or 14 coefficients, as in OpenCV; those that the model
/// lacks must be zero. radtan with k4, k5 or k6 is rational; rational_polynomial without them is radtan. If all are
/// zero, there is no distortion for unknown models. Throws InputError, with the model and the first coefficient that is
/// not supported.
Distortion make_distortion(std::string_view name, const std::vector<double>& coefficients);

}  // namespace edged
