// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The simulator presets.
#include <cmath>
#include <map>

#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"
#include "edged/sim/motion/flight.hpp"
#include "edged/sim/simulator.hpp"

namespace edged {
namespace {

/// A DAVIS346 behind a lens of 4.6 mm, 5 cm in front of the IMU, its axis along the body's x, 4 degrees down.
void mount_davis346(SimulatorConfig& config) {
  config.camera = {.width = 346,
                   .height = 260,
                   .fx = 251.4,
                   .fy = 251.1,
                   .cx = 170.2,
                   .cy = 131.6,
                   .k1 = -0.074,
                   .k2 = 0.021,
                   .p1 = 0.0004,
                   .p2 = -0.0006};
  const double down = 4.0 * kDegree;
  Eigen::Matrix3d R_B_C;
  R_B_C << 0, -std::sin(down), std::cos(down), -1, 0, 0, 0, -std::cos(down), -std::sin(down);
  config.T_B_C = {R_B_C, Eigen::Vector3d(0.048, -0.006, 0.017)};
  config.frames.rate_hz = 25.0;
  config.frames.auto_exposure = true;
}

/// As the cameras of TUM-VI, with a quarter of the pixels: 152 degrees across, 212 from corner to corner.
void mount_fisheye(SimulatorConfig& config) {
  config.camera = {.width = 256,
                   .height = 256,
                   .fx = 95.5,
                   .fy = 95.5,
                   .cx = 127.2,
                   .cy = 128.1,
                   .distortion = DistortionModel::Equidistant,
                   .k1 = 0.0035,
                   .k2 = 0.0007};
}

void move_around_target(SimulatorConfig& config) {
  config.duration_s = 40.0;
  config.scene.kind = SceneKind::Target;
  config.motion.target_m = 0.5;
  config.motion.extent_m = 0.5;
  config.motion.max_speed = 0.8;
  config.motion.max_angle_deg = 50.0;
  config.motion.max_rate_deg_s = 110.0;
  config.motion.aim_deg = 20.0;
  config.frames.exposure_ms = 4.0;
  config.frames.electrons_per_level = 45.0;
  config.frames.rate_hz = 20.0;
}

struct FlightPlan {
  Manoeuvre manoeuvre;
  LightingKind lighting;
  double light;
};

const std::map<std::string, FlightPlan>& flight_plans() {
  static const std::map<std::string, FlightPlan> plans{
      {"circle", {Manoeuvre::Circle, LightingKind::Lamps, 1.0}},
      {"aggressive", {Manoeuvre::Aggressive, LightingKind::Lamps, 1.0}},
      {"aggressive-lowlit", {Manoeuvre::Aggressive, LightingKind::Lamps, 0.02}},
      {"square", {Manoeuvre::Square, LightingKind::Lamps, 1.0}},
      {"line", {Manoeuvre::Line, LightingKind::Lamps, 1.0}},
      {"turned", {Manoeuvre::Turned, LightingKind::Lamps, 1.0}},
      {"low-lit", {Manoeuvre::Free, LightingKind::Lamps, 0.02}},
      {"30-percent", {Manoeuvre::Free, LightingKind::Lamps, 0.3}},
      {"60-percent", {Manoeuvre::Free, LightingKind::Lamps, 0.6}},
      {"dynamic-hdr", {Manoeuvre::Free, LightingKind::Switched, 1.0}},
      {"constant-hdr", {Manoeuvre::Free, LightingKind::Sun, 1.0}},
  };
  return plans;
}

/// The vibration of motors through soft mounts, and a range of 1000 deg/s and 8 g.
void set_imu(ImuModelConfig& imu, double motors_on_s, double motors_off_s) {
  imu.gyro_range = 17.45;
  imu.accel_range = 78.5;
  imu.gyro_vibration = 0.03;
  imu.accel_vibration = 1.0;
  imu.gyro_broadband = 5e-4;
  imu.accel_broadband = 0.02;
  imu.motors_on_s = motors_on_s;
  imu.motors_off_s = motors_off_s;
}

void set_flight(SimulatorConfig& config, const FlightPlan& plan) {
  mount_davis346(config);
  // The fastest pixel of twice as many; most move half as fast.
  config.max_motion_px = 0.75;
  config.motion.flight = plan.manoeuvre;
  config.motion.rest_s = 2.5;
  config.scene.kind = SceneKind::Hall;
  config.scene.objects = 12;
  config.scene.lighting = plan.lighting;
  config.scene.light = plan.light;
  const double landed_s = config.motion.rest_s + airborne_s(plan.manoeuvre);
  config.duration_s = std::ceil(10.0 * (landed_s + 1.0)) / 10.0;
  set_imu(config.imu, config.motion.rest_s - 0.7, landed_s + 0.1);
  // The bandwidth of a pixel is proportional to its photocurrent. Its noise is largest where that is small.
  config.events.bandwidth_hz = 20.0;
  config.events.bandwidth_per_radiance_hz = 2000.0;
  config.events.shot_hz = 0.05 / std::sqrt(plan.light) + (plan.light < 0.1 ? 0.6 : 0.0);
  config.events.hot_pixels = 12;
}

SimulatorConfig flight(const std::string& name, const FlightPlan& plan) {
  SimulatorConfig config;
  config.name = name;
  set_flight(config, plan);
  return config;
}

}  // namespace

const std::vector<std::string>& flight_presets() {
  static const std::vector<std::string> names{"circle",     "aggressive",  "aggressive-lowlit", "square",
                                              "line",       "turned",      "low-lit",           "30-percent",
                                              "60-percent", "dynamic-hdr", "constant-hdr"};
  return names;
}

const std::vector<std::string>& simulator_presets() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"room",    "poster", "shapes", "handheld-fast", "handheld-wild",
                                 "walkers", "dark",   "spot",   "fisheye",       "calibration-target"};
    all.insert(all.end(), flight_presets().begin(), flight_presets().end());
    return all;
  }();
  return names;
}

std::string_view preset_summary(const std::string& name) {
  static const std::map<std::string, std::string_view> summaries{
      {"room", "a DAVIS240C in the hand, in a furnished room"},
      {"poster", "the same in front of a wall with a photo, slower"},
      {"shapes", "the same in front of a wall with few plain shapes"},
      {"handheld-fast", "room, up to 2 m/s and 180 deg/s"},
      {"handheld-wild", "room, up to 1.5 m/s and 573 deg/s; slow pixels"},
      {"walkers", "room with people who walk through the view"},
      {"dark", "room at 3 % of the light, long exposures"},
      {"spot", "poster in the dark, lit by a wandering lamp"},
      {"fisheye", "room through a fisheye lens of 152 deg"},
      {"calibration-target", "around an AprilGrid, for `edged calib --target`"},
      {"circle", "quadrotor in a hall: three laps of 1.6 m radius"},
      {"aggressive", "quadrotor: fast shifts to the sides, with roll"},
      {"aggressive-lowlit", "the same at 2 % of the light"},
      {"square", "quadrotor: two laps with quarter turns at the corners"},
      {"line", "quadrotor: to and fro on a line"},
      {"turned", "quadrotor: slow path, fast turns of yaw"},
      {"low-lit", "quadrotor: loops at 2 % of the light"},
      {"30-percent", "quadrotor: loops at 30 % of the light"},
      {"60-percent", "quadrotor: loops at 60 % of the light"},
      {"dynamic-hdr", "quadrotor: loops under lamps that are switched"},
      {"constant-hdr", "quadrotor: loops in the hall with sun through windows"}};
  const auto found = summaries.find(name);
  EDGED_CHECK(found != summaries.end(), "preset {}", name);
  return found->second;
}

SimulatorConfig simulator_preset(const std::string& name) {
  if (const auto plan = flight_plans().find(name); plan != flight_plans().end()) return flight(name, plan->second);
  SimulatorConfig config;
  config.name = name;
  if (name == "room") return config;
  if (name == "poster" || name == "shapes") {
    config.scene.kind = name == "poster" ? SceneKind::Poster : SceneKind::Shapes;
    config.motion.max_angle_deg = 20.0;
    config.motion.max_rate_deg_s = 30.0;
    return config;
  }
  if (name == "handheld-fast") {
    config.motion.extent_m = 0.8;
    config.motion.max_speed = 2.0;
    config.motion.max_angle_deg = 45.0;
    config.motion.max_rate_deg_s = 180.0;
    return config;
  }
  if (name == "handheld-wild") {
    config.motion.extent_m = 0.7;
    config.motion.max_speed = 1.5;
    config.motion.max_angle_deg = 60.0;
    config.motion.max_rate_deg_s = 573.0;
    // At that speed, the pixels are too slow for the finest texture.
    config.events.threshold_on = config.events.threshold_off = 0.4;
    config.events.bandwidth_hz = 20.0;
    config.events.bandwidth_per_radiance_hz = 600.0;
    return config;
  }
  if (name == "fisheye") mount_fisheye(config);
  if (name == "calibration-target") move_around_target(config);
  if (name == "fisheye" || name == "calibration-target") return config;
  if (name == "walkers") {
    config.disturbance = {.kind = DisturbanceKind::Walkers, .at_s = 0.0};
    return config;
  }
  if (name == "spot") {
    // 2.5 lux. A well lit room has 200.
    config.scene.kind = SceneKind::Poster;
    config.scene.light = 0.0125;
    config.events.bandwidth_hz = 20.0;
    config.events.bandwidth_per_radiance_hz = 2000.0;
    config.events.shot_hz = 0.8;
    config.frames.auto_exposure = true;
    config.frames.target_level = 40.0;  // as much of the view is dark
    config.disturbance = {.kind = DisturbanceKind::WanderingLamp, .at_s = 0.0};
    return config;
  }
  if (name == "dark") {
    config.scene.light = 0.03;
    config.events.bandwidth_hz = 60.0;
    config.events.shot_hz = 0.8;
    config.frames.exposure_ms = 25.0;
    return config;
  }
  throw InputError::format("there is no simulator preset '{}'; choose one of {}", name,
                           fmt::join(simulator_presets(), ", "));
}

}  // namespace edged
