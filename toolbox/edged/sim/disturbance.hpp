// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A disturbance of a recording: one at a known time, in the scene, in the motion or in the sensors.
#pragma once

#include "edged/config.hpp"
#include "edged/sim/trajectory.hpp"

namespace edged {

/// Of the sensors: LensCovered, FramesMissing, EventsMissing, ImuGap and EventStorm (noise on the whole array). Of the
/// scene: LightsOff, Person (walks past right before the camera), Walkers (two people cross the view again and again),
/// WanderingLamp and SwitchingLamp (a spot of light far brighter than the rest moves over the scene; the latter's also
/// goes on and off) and BlankWall (half of the room is painted white and bare, and the camera turns round to it). Of
/// the motion: GyroSaturation (a turn beyond the gyro's range and back), Shake, PureRotation, Standstill and PutDown (a
/// standstill that begins and ends with a knock).
enum class DisturbanceKind {
  None,
  LensCovered,
  LightsOff,
  FramesMissing,
  EventsMissing,
  ImuGap,
  GyroSaturation,
  Shake,
  Person,
  Walkers,
  WanderingLamp,
  SwitchingLamp,
  BlankWall,
  PureRotation,
  Standstill,
  PutDown,
  EventStorm
};

/// Times are seconds on the camera's clock.
struct Disturbance {
  DisturbanceKind kind = DisturbanceKind::None;
  double at_s = 5.0;
  double length_s = 0.0;  ///< 0: as long as its kind usually is
  double strength = 0.0;  ///< 0: as strong as its kind usually is; its unit is that of the kind

  void visit(ConfigFields& fields);

  /// With the usual length and strength in place of zeros, in a recording of this length.
  Disturbance filled_in(double recording_s) const;

  double end_s() const { return at_s + length_s; }
  double middle_s() const { return at_s + 0.5 * length_s; }
  /// Whether there is one, and whether it is active at this time.
  bool is(DisturbanceKind of, double t_s) const { return kind == of && t_s >= at_s && t_s < end_s(); }

  /// Share of the scene's light that reaches the sensors. Covering a lens takes 60 ms, switching a lamp 20 ms.
  double light(double t_s) const;
};

/// A motion with a disturbance (with its defaults set): the clock of the path is stopped, for the position alone
/// in pure rotation; or the body turns about an axis of its own on top of it; or it is knocked. Transitions, such as
/// slowing down or turning to a wall, take place before the disturbance and after it.
class DisturbedTrajectory {
 public:
  /// gyro_range [rad/s]; axis_B: of the turns, unit.
  DisturbedTrajectory(ContinuousTrajectory trajectory, const Disturbance& disturbance, double gyro_range,
                      const Eigen::Vector3d& axis_B)
      : trajectory_(std::move(trajectory)), disturbance_(disturbance), gyro_range_(gyro_range), axis_B_(axis_B) {}

  /// t: seconds since the start of the rest.
  Kinematics at(double t) const;

 private:
  /// Angle on top of the path [rad] and its rate [rad/s].
  struct Turn {
    double angle = 0.0, rate = 0.0;
  };
  Kinematics on_stopped_clock(double t) const;
  Turn turn(double t) const;
  void knock(double t, Kinematics& k) const;

  ContinuousTrajectory trajectory_;
  Disturbance disturbance_;
  double gyro_range_;
  Eigen::Vector3d axis_B_;
};

}  // namespace edged
