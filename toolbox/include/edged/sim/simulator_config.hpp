// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Every number of a simulation: motion, scene, sensors and what goes wrong.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "edged/config.hpp"
#include "edged/imu_noise.hpp"
#include "edged/rig.hpp"
#include "edged/se3.hpp"
#include "edged/target/target.hpp"

namespace edged {

/// Circle: three laps of 1.6 m radius, heading along them. Aggressive: fast shifts to the sides with the roll that they
/// take. Square: two laps of four legs with a stop and a quarter turn at each corner. Line: to and fro along x. Turned:
/// slow path, fast changes of yaw. Free: loops with swaying yaw. Hover: at one place.
enum class Manoeuvre { None, Circle, Aggressive, Square, Line, Turned, Free, Hover };

/// Where random motion goes. Free: to all sides. Approach: ahead and back. Altitude: up and down. Pan: the camera turns
/// on a tripod about a point beside it.
enum class MotionStyle { Free, Approach, Altitude, Pan };

enum class PoseOf { Camera, Body };

struct MotionConfig {
  std::string file;  ///< TUM trajectory to follow; empty: random motion
  Manoeuvre flight = Manoeuvre::None;
  double start_s = 0.0;
  PoseOf pose_of = PoseOf::Camera;
  double rest_s = 1.0;
  double blend_s = 1.0;
  double knot_s = 0.05;
  double extent_m = 0.6;
  double max_angle_deg = 35.0;
  double max_speed = 0.8;
  double max_rate_deg_s = 45.0;
  MotionStyle style = MotionStyle::Free;
  double lever_m = 0.0;    ///< of a pan: the camera is so far ahead of the axes
  double go_s = 2.0;       ///< of motion between pauses
  double pause_s = 0.0;    ///< 0: no pauses
  double tremor_mm = 0.0;  ///< of a hand
  double wind = 1.0;       ///< of a flight
  /// Random motion around a target at (0, 0, 1.3) that faces -x, at this mean distance; 0: none [m].
  double target_m = 0.0;
  double aim_deg = 20.0;

  void visit(ConfigFields& fields);
};

enum class LightingKind { Even, Lamps, Switched, Sun };

enum class SceneKind { Boxes, Poster, Shapes, Hall, Corridors, Target };

struct SceneConfig {
  SceneKind kind = SceneKind::Boxes;
  int objects = 16;
  double twin_m = 0.0;
  double clearance_m = 0.45;
  double wall_m = 1.6;
  double poster_distance_m = 1.3;
  double light = 1.0;
  LightingKind lighting = LightingKind::Even;
  double gloss = 0.0;
  TargetSpec target{.rows = 3, .columns = 4, .size_m = 0.08};

  void visit(ConfigFields& fields);
};

/// Size, intrinsics and distortion shared by events and frames; a DAVIS240C. A model takes the coefficients that it
/// has.
struct SimulatedCameraConfig {
  int width = 240, height = 180;
  double fx = 199.37143, fy = 199.70787, cx = 133.75438, cy = 113.99217;
  DistortionModel distortion = DistortionModel::RadTan;
  double k1 = -0.38289916, k2 = 0.18933637, p1 = -0.00100247, p2 = -0.00056378;
  double k3 = 0.0, k4 = 0.0, k5 = 0.0, k6 = 0.0;
  double xi = 0.1, alpha = 0.6, beta = 1.1, w = 0.9;
  double residual_px = 0.0;
  double flare = 0.0;

  void visit(ConfigFields& fields);
  CameraModel model() const;

 private:
  double coefficient(std::string_view name) const;
};

/// The model of Hu, Liu, Delbruck, "v2e" (CVPRW 2021): threshold mismatch, refractory time, one-pole bandwidth
/// that grows with the light, leak and shot noise, hot pixels.
struct EventCameraConfig {
  double threshold_on = 0.3;
  double threshold_off = 0.3;
  double threshold_sigma = 0.03;
  double refractory_us = 300.0;
  double bandwidth_hz = 0.0;
  double bandwidth_per_radiance_hz = 0.0;
  double leak_hz = 0.1;
  double shot_hz = 0.03;
  int hot_pixels = 0;
  double hot_hz = 200.0;
  double dark_radiance = 0.003;

  void visit(ConfigFields& fields);
};

struct FrameCameraConfig {
  double rate_hz = 24.0;
  double exposure_ms = 8.0;
  bool auto_exposure = false;
  double min_exposure_ms = 0.1, max_exposure_ms = 25.0;
  double target_level = 90.0;
  double electrons_per_ms = 2500.0;
  double electrons_per_level = 80.0;
  double read_noise_electrons = 45.0;
  double pixel_gain_sigma = 0.0;
  double vignetting = 0.0;

  void visit(ConfigFields& fields);
};

struct ImuModelConfig {
  double rate_hz = 1000.0;
  double time_offset_ms = 2.4;  ///< t_imu = t_cam + time_offset
  double gyro_noise = 1.2e-4;   ///< [rad/s/sqrt(Hz)]
  double accel_noise = 4e-3;    ///< [m/s^2/sqrt(Hz)]
  double gyro_walk = 1e-5;      ///< [rad/s^2/sqrt(Hz)]
  double accel_walk = 1e-4;     ///< [m/s^3/sqrt(Hz)]
  double gyro_bias = 0.012;     ///< length of each constant bias, its direction is random [rad/s]
  double accel_bias = 0.1;      ///< [m/s^2]
  /// Errors of scale and of the axes' directions, standard deviation of each, of either sensor.
  double scale_error = 0.0;
  double cross_axis_mrad = 0.0;
  double gyro_range = 34.9;    ///< readings end here [rad/s]
  double accel_range = 156.9;  ///< [m/s^2]
  /// The vibration of running motors in the sensor: a narrow band at their speed and half as much at twice of it,
  /// too small for a camera to observe, and a broad band.
  double vibration_hz = 130.0;
  double gyro_vibration = 0.0;   ///< rms of the narrow band on each axis [rad/s]
  double accel_vibration = 0.0;  ///< [m/s^2]
  double gyro_broadband = 0.0;   ///< [rad/s/sqrt(Hz)]
  double accel_broadband = 0.0;  ///< [m/s^2/sqrt(Hz)]
  double motors_on_s = 0.0;      ///< on the camera's clock
  double motors_off_s = 1e6;

  void visit(ConfigFields& fields);

  /// A calibration of this sensor, with the broad band of the vibration; no density is below a
  /// millionth of the default one.
  ImuNoise noise() const;
};

/// The errors of any of them, in the unit of the sensor.
struct ExternalErrors {
  double rate_hz = 0.0;        ///< 0: there is no such sensor
  double noise = 0.0;          ///< standard deviation of a sample
  double walk = 0.0;           ///< random walk of the offset, per square root of a second
  double scale_error = 0.0;    ///< reads (1 + scale_error) times the truth
  double outlier_share = 0.0;  ///< share of the samples
  double outlier = 0.0;        ///< standard deviation of these
  double gap_at_s = 0.0, gap_s = 0.0;
  double late_ms = 0.0;  ///< stamped so long after they were measured

  void visit(ConfigFields& fields, const char* unit);
};

/// A barometer at 25 Hz has errors of 0.1 m.
struct HeightModelConfig {
  ExternalErrors errors{.noise = 0.1, .outlier = 5.0};
  double zero_m = 0.0;  ///< reads this at the origin
  void visit(ConfigFields& fields);
};

/// Its axes are those of the body.
struct VelocityModelConfig {
  ExternalErrors errors{.noise = 0.05, .outlier = 2.0};
  Eigen::Vector3d p_B_S = Eigen::Vector3d::Zero();  ///< where it sits [m]
  void visit(ConfigFields& fields);
};

struct ExternalModelConfig {
  HeightModelConfig height;
  VelocityModelConfig velocity;
};

/// What goes wrong. Of the sensors: LensCovered, FramesMissing, EventsMissing, ImuGap and EventStorm (noise on the
/// whole array). Of the scene: LightsOff, Person (walks past right before the camera), Walkers (two people cross the
/// view repeatedly), WanderingLamp and SwitchingLamp (a spot of light far brighter than the rest moves over the
/// scene; the latter's also goes on and off), BlankWall (half of the room is painted white and bare, and the camera
/// turns round to it) and Flicker (lamps on mains or with PWM, FlickerConfig). Of the motion: GyroSaturation (a turn
/// beyond the gyro's range and back), Shake, PureRotation, Standstill and PutDown (a standstill that begins and ends
/// with a knock).
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
  EventStorm,
  Flicker
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

/// Mains: the light follows the power of the rectified mains. Pwm: it is switched.
enum class FlickerWave { Mains, Pwm };

/// The light of the lamps while the disturbance is Flicker. Its mean is that without flicker.
struct FlickerConfig {
  FlickerWave wave = FlickerWave::Mains;
  double hz = 100.0;
  double duty = 0.5;
  double reach_m = 0.0;

  void visit(ConfigFields& fields);
};

/// Every number of a simulation. The defaults are the preset "room"; simulator_preset gives the others.
struct SimulatorConfig {
  std::string name = "room";  ///< name of the preset it started from; only a label
  int seed = 1;
  double duration_s = 20.0;
  double max_motion_px = 0.5;
  MotionConfig motion;
  SceneConfig scene;
  SimulatedCameraConfig camera;
  EventCameraConfig events;
  FrameCameraConfig frames;
  ImuModelConfig imu;
  ExternalModelConfig external;
  Disturbance disturbance;
  FlickerConfig flicker;

  /// Pose of the camera in the body; not an option.
  SE3 T_B_C = davis240c_extrinsics();

  void visit(ConfigFields& fields);
  static SE3 davis240c_extrinsics();

  /// A further camera on the same flight through the same scene, which are designed for the one at T_B_C.
  struct Mount {
    SE3 T_C_M;           ///< its pose relative to that
    std::string suffix;  ///< appended to its cameras' names; with one its noise is its own
  };
  Mount mount;
  SE3 T_B_M() const { return T_B_C * mount.T_C_M; }
};

/// A file presets/NAME.yaml (core/resources.hpp); "room" is there without one. Throws InputError that lists
/// simulator_presets().
SimulatorConfig simulator_preset(const std::string& name);

/// What a preset simulates, in a line.
std::string preset_summary(const std::string& name);

/// The names of all presets: a DAVIS240C in the hand, then the eleven flights of the paper's Table III in its order (a
/// DAVIS346 on a quadrotor in a hall), then what a user adds.
std::vector<std::string> simulator_presets();

}  // namespace edged
