// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "edged/core/check.hpp"

namespace edged {
namespace {

bool is_calibration(BlockKey key) { return key.kind == BlockKind::Calibration || key.kind == BlockKind::ImuIntrinsics; }

/// A block near what it is now, by one sigma for each of its numbers. One that is held gets a sigma too small to move
/// by.
LinearPrior near_present(BlockKey key, std::span<const double> present, const Eigen::VectorXd& sigmas) {
  constexpr double kHeld = 1e-9;
  LinearPrior prior;
  prior.blocks = {key};
  prior.x0 = {{present.begin(), present.end()}};
  prior.J = sigmas.cwiseMax(kHeld).cwiseInverse().asDiagonal();
  prior.r = Eigen::VectorXd::Zero(sigmas.size());
  return prior;
}

}  // namespace

NavState WindowState::nav() const {
  NavState nav;
  nav.t = t;
  nav.T_W_B = T_W_B();
  nav.v_W = Eigen::Map<const Eigen::Vector3d>(motion.data());
  nav.bias_gyro = Eigen::Map<const Eigen::Vector3d>(motion.data() + 3);
  nav.bias_accel = Eigen::Map<const Eigen::Vector3d>(motion.data() + 6);
  return nav;
}

BodyRate WindowState::rate() const {
  const NavState state = nav();
  return {gyro_B - state.bias_gyro, state.v_W};
}

void CalibrationConfig::visit(ConfigFields& fields) {
  fields.add("rotation_sigma_deg", rotation_sigma_deg,
             {"deg", 0, 10, "how far each camera's rotation against the IMU may be off; 0 holds it as given"});
  fields.add("time_offset_sigma_ms", time_offset_sigma_ms,
             {"ms", 0, 50, "how far each camera's time offset may be off; 0 holds it as given"});
  fields.add(
      "imu_sigma", imu_sigma,
      {"1", 0, 0.1, "how far scale and axes of gyro and accelerometer may be off, as a share; 0 holds them as given"});
}

void TrackNoise::visit(ConfigFields& fields) {
  fields.add(
      "correlation", correlation,
      {"1", 0, 0.999, "of the errors of two observations of a track right after one another; 0: all independent"});
  fields.add("event_correlation", event_correlation,
             {"1", 0, 0.999,
              "the same on event frames; higher: more accurate where all stands still, and what moves "
              "slowly is believed"});
  fields.add("time_s", time_s, {"s", 0.01, 1000, "after this time the correlation has fallen to 1/e of that"});
}

MotionBlock motion_block(const NavState& state) {
  MotionBlock block;
  Eigen::Map<Eigen::Matrix<double, 9, 1>>(block.data()) << state.v_W, state.bias_gyro, state.bias_accel;
  return block;
}

WindowState window_state(const NavState& nav, const Eigen::Vector3d& gyro_B, Preintegration imu, bool keyframe) {
  WindowState state;
  state.t = nav.t;
  state.pose = to_block(nav.T_W_B);
  state.motion = motion_block(nav);
  state.gyro_B = gyro_B;
  state.imu = std::move(imu);
  state.keyframe = keyframe;
  return state;
}

Window::Window(const Rig& rig, double cauchy_scale, const DepthFactorConfig& depth)
    : cameras(rig.cameras),
      calibration(rig.cameras.size(), CalibrationBlock{}),
      noise_scale(rig.cameras.size(), 1.0),
      depth_config(depth),
      last_image_(rig.cameras.size(), 0),
      visual_loss_(std::make_unique<ceres::CauchyLoss>(cauchy_scale)),
      depth_loss_(std::make_unique<ceres::CauchyLoss>(depth.cauchy_scale)) {
  for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
    calibration[camera][3] = to_seconds(cameras[camera].time_offset);
  }
  free_calibration({0.0, 0.0, 0.0});
  if (!depth.enabled) return;
  ln_scale[0] = 0.0;
  soft_priors.push_back(
      near_present({BlockKind::LogScale, 0}, {&ln_scale[0], 1}, Eigen::VectorXd::Constant(1, depth.scale_sigma)));
}

std::size_t Window::camera_index(const std::string& name) const {
  const auto camera = std::find_if(cameras.begin(), cameras.end(), [&](const auto& c) { return c.name == name; });
  EDGED_CHECK(camera != cameras.end(), "no camera '{}' in the rig", name);
  return static_cast<std::size_t>(camera - cameras.begin());
}

StateId Window::add_state(WindowState state) {
  states.emplace(next_state_, std::move(state));
  return next_state_++;
}

void Window::add_observations(StateId id, const std::vector<CameraObservations>& observations) {
  for (const CameraObservations& view : observations) {
    const std::size_t index = camera_index(view.camera);
    last_image_[index] = id;
    for (const FeatureObservation& observation : view.features) {
      Feature& feature = features[observation.id];
      feature.camera = index;
      feature.last_seen = id;
      FeatureObservation& kept = feature.seen.insert_or_assign(id, observation).first->second;
      kept.sigma *= noise_scale[index];
    }
  }
}

SE3 Window::T_W_C(StateId state, std::size_t camera) const {
  const WindowState& at = states.at(state);
  return camera_pose(at.T_W_B(), at.rate(), cameras[camera].T_B_C, calibration[camera].data());
}

RigCamera Window::calibrated(std::size_t camera) const {
  RigCamera found = cameras[camera];
  const CalibrationBlock& off = calibration[camera];
  found.T_B_C = camera_pose(found.T_B_C, {}, SE3(), off.data());
  found.time_offset = duration_from_seconds(off[3]);
  return found;
}

void Window::free_calibration(const CalibrationConfig& config) {
  std::erase_if(soft_priors, [](const LinearPrior& soft) { return is_calibration(soft.blocks.front()); });
  const double rotation = config.rotation_sigma_deg * std::numbers::pi / 180.0;
  const Eigen::Vector4d of_camera(rotation, rotation, rotation, config.time_offset_sigma_ms * 1e-3);
  for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
    soft_priors.push_back(near_present({BlockKind::Calibration, camera}, calibration[camera], of_camera));
  }
  soft_priors.push_back(
      near_present(kImuIntrinsicsKey, imu_intrinsics, Eigen::VectorXd::Constant(18, config.imu_sigma)));
}

Eigen::Vector3d Window::position(const Feature& feature) const {
  const Eigen::Vector2d& point = feature.seen.at(*feature.anchor).point;
  return T_W_C(*feature.anchor, feature.camera) * (Eigen::Vector3d(point.x(), point.y(), 1.0) / feature.inverse_depth);
}

const double* Window::block(BlockKey key) const {
  if (key.kind == BlockKind::InverseDepth) {
    const auto found = features.find(key.id);
    return found == features.end() ? nullptr : &found->second.inverse_depth;
  }
  if (key.kind == BlockKind::LogScale) {
    const auto found = ln_scale.find(key.id);
    return found == ln_scale.end() ? nullptr : &found->second;
  }
  if (key.kind == BlockKind::Calibration) return calibration.at(key.id).data();
  if (key.kind == BlockKind::ImuIntrinsics) return imu_intrinsics.data();
  const auto found = states.find(key.id);
  if (found == states.end()) return nullptr;
  return key.kind == BlockKind::Pose ? found->second.pose.data() : found->second.motion.data();
}

const double* Window::linearisation_point(BlockKey key) const {
  if (is_calibration(key)) return block(key);
  const auto in_prior = std::find(prior.blocks.begin(), prior.blocks.end(), key);
  if (in_prior == prior.blocks.end()) return block(key);
  return prior.x0[static_cast<std::size_t>(in_prior - prior.blocks.begin())].data();
}

void Window::move(BlockKey key, std::span<const double> step) {
  const double* values = block(key);
  const auto size = static_cast<std::size_t>(tangent_size(key.kind));
  EDGED_CHECK(values != nullptr, "block {} of kind {} is not in the window", key.id, static_cast<int>(key.kind));
  EDGED_CHECK(step.size() == size, "a step of {} numbers in a tangent space of {}", step.size(), size);
  plus(key.kind, const_cast<double*>(values), step.data());
}

template <typename Self, typename Visit>
void Window::for_each_block(Self& self, const Visit& visit) {
  for (auto& [id, state] : self.states) visit(std::span(state.pose)), visit(std::span(state.motion));
  for (auto& [id, feature] : self.features) visit(std::span(&feature.inverse_depth, 1));
  for (auto& [piece, ln_s] : self.ln_scale) visit(std::span(&ln_s, 1));
  for (auto& of_camera : self.calibration) visit(std::span(of_camera));
  visit(std::span(self.imu_intrinsics));
}

std::vector<double> Window::estimates() const {
  std::vector<double> all;
  for_each_block(*this, [&](auto values) { all.insert(all.end(), values.begin(), values.end()); });
  return all;
}

void Window::restore(const std::vector<double>& estimates) {
  std::span<const double> left = estimates;
  for_each_block(*this, [&](auto values) {
    EDGED_CHECK(left.size() >= values.size(), "the window has more blocks than when its estimates were taken");
    std::copy_n(left.begin(), values.size(), values.begin());
    left = left.subspan(values.size());
  });
  EDGED_CHECK(left.empty(), "the window has fewer blocks than when its estimates were taken");
}

void Window::drop_orphaned_priors() {
  std::erase_if(soft_priors, [&](const LinearPrior& soft) {
    return std::any_of(soft.blocks.begin(), soft.blocks.end(), [&](BlockKey key) { return block(key) == nullptr; });
  });
}

}  // namespace edged
