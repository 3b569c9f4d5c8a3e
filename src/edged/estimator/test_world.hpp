// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A world of points, an analytic motion and exact measurements of both: the ground truth of the estimator's tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "edged/camera/intrinsics.hpp"
#include "edged/camera/lens_model.hpp"
#include "edged/estimator/estimator.hpp"
#include "edged/rig.hpp"

namespace edged {

constexpr double kPacket_s = 0.05;  ///< between packets, in most tests

struct TestWorldOptions {
  double rest_s = 0.0;               ///< at the beginning
  int cameras = 1;                   ///< 2: one more, "events", rotated and shifted relative to "frames"
  bool shared_ids = false;           ///< a point has the same id in all cameras
  double speed = 1.0;                ///< scales the amplitude of the motion; 0: rotation only
  double turn = 1.0;                 ///< scales the amplitude of the rotation
  double tempo = 1.0;                ///< speed factor of the motion
  double turn_only_s = 0.0;          ///< no translation before this, at full speed a second later
  double near_m = 1.5, far_m = 4.0;  ///< heights of the points over the origin
  Eigen::Matrix3d gyro_error = Eigen::Matrix3d::Zero();  ///< scale and axes: measured = (I + E) true + bias
  double pixel_noise = 0.5;                              ///< [px]
  double frames_noise = 1.0;                             ///< times pixel_noise, on frames
  double pixel_walk = 0.0;                               ///< [px/sqrt(s)] how fast tracks drift from their points
  double imu_noise = 1.0;                                ///< times the densities of ImuNoise
  Eigen::Vector3d bias_gyro = {0.01, -0.02, 0.015};
  Eigen::Vector3d bias_accel = {0.05, -0.08, 0.06};
  Eigen::Vector3d rotation_error = {0, 0, 0};   ///< cameras: R_B_C true = R_B_C of rig() * Exp(error) [rad]
  Eigen::Vector3d lever_arm_error = {0, 0, 0};  ///< cameras: t_B_C true = t_B_C of rig() + error [m]
  IntrinsicsCorrection intrinsics_error = IntrinsicsCorrection::Zero();  ///< true = rig() corrected by it
  LensCoefficients distortion = {};                                      ///< first camera: radtan, if it is not zero
  double time_error = 0.0;      ///< images are taken so long after their stamp [s]
  int walker = 0;               ///< number of the 120 features on a dynamic object of half a metre that passes by
  double walker_comes_s = 0.0;  ///< when it enters the view
  std::uint64_t seed = 1;
};

class TestWorld {
 public:
  static constexpr FeatureId kWalkerId = 700;  ///< features of the dynamic object are from here to 999

  explicit TestWorld(const TestWorldOptions& options) : options_(options), random_(options.seed) {
    rig_.name = "test";
    rig_.cameras.push_back({"frames", Modality::Frames, CameraModel(240, 180, 200, 200, 119.5, 89.5),
                            SE3(so3::exp({0.01, 0.02, -0.01}), {0.02, 0.01, 0.03}), Duration(0)});
    if (options_.cameras > 1) {
      const Eigen::Vector3d turned =
          options_.shared_ids ? Eigen::Vector3d(0.02, -0.05, 0.1) : Eigen::Vector3d(0.2, -0.15, 0.4);
      rig_.cameras.push_back({"events", Modality::Events, CameraModel(240, 180, 210, 200, 125, 85),
                              SE3(so3::exp(turned), {-0.06, 0.03, 0.01}), Duration(0)});
    }
    if (options_.distortion != LensCoefficients{}) {
      rig_.cameras.front().model =
          CameraModel(240, 180, 200, 200, 119.5, 89.5, DistortionModel::RadTan, options_.distortion);
    }
    noise_.gyro_noise = 2e-4;
    noise_.accel_noise = 4e-3;
    const double side = options_.far_m;
    for (int i = 0; i < 600; ++i) {
      points_W_.push_back(in_box({-side, -side, options_.near_m}, {side, side, options_.far_m}));
    }
    for (int i = 0; i < options_.walker; ++i) walker_.push_back(in_box({-0.8, -0.4, 1.6}, {-0.3, 0.4, 1.8}));
  }

  const Rig& rig() const { return rig_; }
  const ImuNoise& noise() const { return noise_; }

  /// The camera axis is along W's z (upwards: the texture is on the ceiling).
  SE3 T_W_B(double t) const {
    const double s = motion_time(t);
    const Eigen::Vector3d phi(0.2 * std::sin(1.3 * s), 0.25 * std::sin(0.9 * s), 0.3 * std::sin(0.7 * s));
    return {so3::exp(options_.turn * phi), smooth_step(t - options_.turn_only_s) * position(s)};
  }

  Eigen::Vector3d v_W(double t) const { return (T_W_B(t + 1e-5).translation() - T_W_B(t - 1e-5).translation()) / 2e-5; }

  ImuSample imu(double t) {
    constexpr double h = 1e-4;
    const SE3 T = T_W_B(t), before = T_W_B(t - h), after = T_W_B(t + h);
    const Eigen::Vector3d a_W = (after.translation() - 2 * T.translation() + before.translation()) / (h * h);
    const double density = options_.imu_noise * std::sqrt(200.0);
    ImuSample sample;
    sample.t = timestamp_from_seconds(t);
    const Eigen::Vector3d omega_B = so3::log(before.rotation().conjugate() * after.rotation()) / (2 * h);
    sample.gyro_B =
        omega_B + options_.gyro_error * omega_B + options_.bias_gyro + noise_.gyro_noise * density * normal3();
    sample.accel_B =
        T.rotation().conjugate() * (a_W - kGravity_W) + options_.bias_accel + noise_.accel_noise * density * normal3();
    return sample;
  }

  HeightSample height(double t, double sigma) {
    return {timestamp_from_seconds(t), T_W_B(t).translation().z() + sigma * normal(), sigma};
  }

  /// Measures with a sensor in the body's axes and place.
  VelocitySample velocity(double t, double sigma) {
    return {timestamp_from_seconds(t), T_W_B(t).R().transpose() * v_W(t) + sigma * normal3(),
            Eigen::Vector3d::Constant(sigma)};
  }

  /// Point i of the world; its id in camera c is i + 1 + 1000 c.
  const Eigen::Vector3d& point_W(FeatureId id) const { return points_W_.at((id - 1) % 1000); }

  /// The visible points at t, 120 at most.
  CameraObservations observe(double t, std::size_t camera_index = 0) {
    const RigCamera& camera = rig_.cameras.at(camera_index);
    CameraObservations out{camera.name, {}};
    const SE3 T_B_C = SE3(camera.T_B_C.rotation() * so3::exp(options_.rotation_error),
                          camera.T_B_C.translation() + options_.lever_arm_error);
    const CameraModel model = *corrected_model(camera.model, options_.intrinsics_error);
    const bool exact = options_.intrinsics_error.isZero(0.0);
    const SE3 T_C_W = (T_W_B(t + options_.time_error) * T_B_C).inverse();
    const Eigen::Vector3d walked = (t - options_.walker_comes_s) * Eigen::Vector3d(0.6, 0.1, 0.0);
    for (std::size_t i = 0; i < walker_.size() + points_W_.size() && out.features.size() < 120; ++i) {
      const bool walks = i < walker_.size();
      const Eigen::Vector3d p_C = T_C_W * (walks ? walker_[i] + walked : points_W_[i - walker_.size()]);
      const auto pixel = model.project(p_C);
      if (!pixel || !camera.model.contains(*pixel)) continue;
      const std::size_t of_camera = options_.shared_ids ? 0 : 1000 * camera_index;
      const FeatureId id = (walks ? kWalkerId + i : i - walker_.size() + 1) + of_camera;
      const double times = camera.modality == Modality::Frames ? options_.frames_noise : 1.0;
      Eigen::Vector2d noise = times * options_.pixel_noise * normal2();
      if (options_.pixel_walk > 0.0) noise += drifted(id, t);
      const Eigen::Vector2d point = exact ? Eigen::Vector2d(p_C.hnormalized()) : camera.model.pixel_to_point(*pixel);
      out.features.push_back({id, point + noise / 200.0, 1.0 / 200.0});
    }
    return out;
  }

  /// The packet that ends at t, dt after the one before. Every camera has an image in it.
  EstimatorInput packet(double t, double dt, bool keyframe) {
    EstimatorInput input{timestamp_from_seconds(t), {}, {}, keyframe, true};
    for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
      input.observations.push_back(observe(t, camera));
    }
    const int n = static_cast<int>(std::lround(dt * 200.0));
    std::vector<ImuSample> samples;
    if (last_imu_) samples.push_back(*last_imu_);
    for (int i = last_imu_ ? 1 : 0; i <= n; ++i) samples.push_back(imu(t - dt + i * dt / n));
    last_imu_ = samples.back();
    input.motion = Preintegration(samples, {0, 0, 0}, {0, 0, 0}, noise());
    return input;
  }

 private:
  /// Zero during the rest, then smoothly up to the running time.
  double motion_time(double t) const {
    const double s = options_.tempo * (t - options_.rest_s);
    if (options_.rest_s == 0.0) return s;
    return s <= 0 ? 0.0 : s < 1.0 ? s * s * s * (1.0 - 0.5 * s) : s - 0.5;
  }

  /// From 0 at t = 0 to 1 a second later. Without turn_only_s the motion is at full speed all the time.
  double smooth_step(double t) const {
    if (options_.turn_only_s == 0.0) return 1.0;
    const double x = std::clamp(t, 0.0, 1.0);
    return x * x * x * (10.0 + x * (6.0 * x - 15.0));
  }

  /// Drift of a track from its point [px].
  const Eigen::Vector2d& drifted(FeatureId id, double t) {
    Drift& drift = drift_[id];
    const double step = options_.pixel_walk * std::sqrt(std::max(t - drift.t, 0.0));
    drift.t = t;
    drift.px += step * normal2();
    return drift.px;
  }

  Eigen::Vector3d position(double s) const {
    return options_.speed * Eigen::Vector3d(0.8 * std::sin(0.9 * s),
                                            0.6 * std::sin(1.4 * s + 0.3) - 0.6 * std::sin(0.3),
                                            0.3 * std::sin(1.1 * s));
  }

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  double normal() {
    return std::sqrt(-2.0 * std::log(uniform(1e-12, 1.0))) * std::cos(2.0 * std::numbers::pi * uniform(0, 1));
  }
  // One random number a statement: compilers evaluate arguments in different orders.
  Eigen::Vector3d in_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    const double z = uniform(low.z(), high.z()), y = uniform(low.y(), high.y()), x = uniform(low.x(), high.x());
    return {x, y, z};
  }
  Eigen::Vector2d normal2() {
    const double y = normal(), x = normal();
    return {x, y};
  }
  Eigen::Vector3d normal3() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }

  TestWorldOptions options_;
  std::mt19937_64 random_;
  Rig rig_;
  ImuNoise noise_;
  struct Drift {
    double t = 0.0;
    Eigen::Vector2d px = Eigen::Vector2d::Zero();
  };

  std::vector<Eigen::Vector3d> points_W_, walker_;
  std::map<FeatureId, Drift> drift_;
  std::optional<ImuSample> last_imu_;
};

/// A keyframe at the true pose and velocity.
inline WindowState true_state(const TestWorld& world, double t, const Eigen::Vector3d& bias_gyro = {0, 0, 0},
                              const Eigen::Vector3d& bias_accel = {0, 0, 0}) {
  return window_state({timestamp_from_seconds(t), world.T_W_B(t), world.v_W(t), bias_gyro, bias_accel},
                      Eigen::Vector3d::Zero(), {}, true);
}

/// The yaw and shift that take an estimate, in a frame of its own, to the truth at one instant.
inline SE3 alignment_at(const SE3& truth, const SE3& estimate) {
  const Eigen::Matrix3d R = truth.R() * estimate.R().transpose();
  const Eigen::Quaterniond yaw = so3::exp({0, 0, std::atan2(R(1, 0), R(0, 0))});
  return {yaw, truth.translation() - yaw * estimate.translation()};
}

/// T_W_B of a state becomes T_W_B * (Exp(turn), shift).
inline void displace(Window& window, StateId id, const Eigen::Vector3d& turn, const Eigen::Vector3d& shift) {
  Vector6d step;
  step << window.states().at(id).T_O_B().R() * shift, turn;
  window.move({BlockKind::Pose, id}, {step.data(), 6});
}

/// All inverse depths times the factor.
inline void stretch_depths(Window& window, double factor) {
  for (const auto& [id, feature] : window.features()) {
    const double step = (factor - 1.0) * feature.inverse_depth;
    if (feature.anchor) window.move({BlockKind::InverseDepth, id}, {&step, 1});
  }
}

enum class Gauge { Held, Free };

/// Four states, their IMU factors, a gauge and initial priors: a problem that is nearly linear close to its solution.
inline Window inertial_window(TestWorld& world, Gauge gauge = Gauge::Held) {
  Window window(world.rig());
  for (int i = 0; i < 4; ++i) {
    const double t = 0.1 * i;
    std::vector<ImuSample> samples;
    for (int k = 0; k <= 20 && i > 0; ++k) samples.push_back(world.imu(t - 0.1 + 0.005 * k));
    WindowState state = true_state(world, t);
    if (i > 0) state.imu = Preintegration(samples, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), world.noise());
    window.add_state(std::move(state));
  }
  if (gauge == Gauge::Held) {
    const auto& [first, at] = *window.states().begin();
    window.add_soft_prior(gauge_prior({BlockKind::Pose, first}, at.pose, 1e-3, 1e-3));
  }
  for (const auto& [id, state] : window.states()) {
    MotionBlock mean = state.motion;
    mean[0] += 0.01;
    window.add_soft_prior(motion_prior({BlockKind::Motion, id}, mean, {0.1, 0.02, 0.1}));
  }
  return window;
}

inline constexpr double kTrackedPeriod_s = 0.2;

/// Keyframes at the true poses, velocities and biases, with IMU and observations; the gauge is fixed.
inline Window tracked_window(TestWorld& world, const TestWorldOptions& options, int states = 6,
                             const TrackNoise& noise = {0.0, 0.0}) {
  Window window(world.rig(), noise);
  world.packet(1.0 - kTrackedPeriod_s, kTrackedPeriod_s, true);
  for (int i = 0; i < states; ++i) {
    const double t = 1.0 + kTrackedPeriod_s * i;
    const EstimatorInput input = world.packet(t, kTrackedPeriod_s, true);
    WindowState state = true_state(world, t, options.bias_gyro, options.bias_accel);
    if (i > 0) state.imu = input.motion.reintegrated(options.bias_gyro, options.bias_accel);
    window.add_state(std::move(state), input.observations);
  }
  const auto& [first, state] = *window.states().begin();
  window.add_soft_prior(gauge_prior({BlockKind::Pose, first}, state.pose, 1e-4, 1e-4));
  return window;
}

/// A world and its tracked window.
struct Tracked {
  explicit Tracked(const TestWorldOptions& of_world = {}, int states = 6, const TrackNoise& noise = {0.0, 0.0})
      : options(of_world), world(options), window(tracked_window(world, options, states, noise)) {}
  TestWorldOptions options;
  TestWorld world;
  Window window;
};

}  // namespace edged
