// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How wide a camera sees.
#pragma once

#include "edged/rig.hpp"

namespace edged {

/// Angles between the rays of opposite borders of the raw image, distortion included [rad]: left to right and top to
/// bottom through the principal point (held within the image), and the larger one between opposite corners.
struct FieldOfView {
  double horizontal = 0.0;
  double vertical = 0.0;
  double diagonal = 0.0;
};

FieldOfView field_of_view(const CameraModel& camera);

}  // namespace edged
