// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Lenses to start from, where nothing is known of them.
#pragma once

#include <vector>

#include "edged/calibrate/target_view.hpp"

namespace edged {

/// Focal lengths from a quarter to three times the width, each with shapes that the model may have; a model with
/// distortion starts without.
std::vector<FreeLens> lenses_to_try(DistortionModel distortion, int width, int height);

}  // namespace edged
