// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Converts poses of the body to poses of the sensor that the user chose.
#pragma once

#include <string>

#include "edged/rig.hpp"
#include "edged/state.hpp"

namespace edged {

/// The given rig with the estimated lens, pose and clock of these cameras. Other cameras behind the same lens get its
/// lens and pose, and so remain behind one lens.
Rig with_estimated(const Rig& given, const Rig& estimated);

/// That rig as poses of its cameras follow from those of the body: the time offset estimated for an event camera
/// contains the latency of its pixels, which no pose has, so it is the given one.
Rig rig_for_poses(const Rig& given, const Rig& estimated);

/// The body or one camera, with what turns a body pose into its pose.
class OutputFrame {
 public:
  /// name: "body" or a camera of the rig. Throws an InputError that lists the known names.
  OutputFrame(const Rig& rig, const std::string& name);

  const std::string& name() const { return name_; }

  /// T_W_B on the IMU clock -> T_W_X on X's own clock: T_W_C = T_W_B * T_B_C, t_cam = t_imu - time_offset.
  StampedPose operator()(const StampedPose& body) const { return {body.t - time_offset_, body.T * T_B_X_}; }
  Trajectory operator()(const Trajectory& body) const;

  /// The other way round.
  StampedPose to_body(const StampedPose& X) const { return {X.t + time_offset_, X.T * T_B_X_.inverse()}; }

  /// For the comment line of a file: which frame, which clock.
  std::string describe() const;

 private:
  std::string name_;
  SE3 T_B_X_;
  Duration time_offset_ = Duration(0);
};

}  // namespace edged
