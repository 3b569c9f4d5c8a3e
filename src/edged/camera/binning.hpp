// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Binning: n x n pixels of a wide sensor become one.
#pragma once

#include "edged/rig.hpp"

namespace edged {

/// The camera with pixels n times as wide and high; columns and rows that do not fill one are left out. One that is
/// masked in part is masked.
CameraModel binned(const CameraModel& camera, int n);

/// The least power of two by which an image of that width is at most widest_px wide.
int bin_for(int width, int widest_px);

}  // namespace edged
