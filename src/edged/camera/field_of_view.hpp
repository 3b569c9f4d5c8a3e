// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Field of view of a camera, which cameras share a lens, and how much of a view two share.
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

/// CameraModel::mean_focal() over (fx + fy) / 2: the slope of the radius by the angle on the axis.
double axis_slope(const CameraModel& camera);

/// The share of the image of `a`, 0 to 1, whose points `b` sees, too, if all are at that distance from `a` [m].
double shared_view(const RigCamera& a, const RigCamera& b, double distance_m);

/// Whether two cameras are behind one lens, as in a DAVIS, whose lens gives events and frames.
bool is_same_lens(const RigCamera& a, const RigCamera& b);

/// Whether they are far enough apart, 1 cm, to see depth together. An event camera and a frame camera that are nearer
/// are taken for one lens, a DAVIS, whatever a calibration says of their rotations.
bool have_baseline(const RigCamera& a, const RigCamera& b);

}  // namespace edged
