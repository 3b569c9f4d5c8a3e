// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <span>

#include "edged/core/check.hpp"
#include "edged/estimator/depth_terms.hpp"
#include "edged/estimator/factors/imu_factor.hpp"
#include "edged/estimator/factors/standstill_factor.hpp"

namespace edged {
namespace {

constexpr BlockKey kImuKey{BlockKind::ImuIntrinsics, 0};

bool is_calibration(BlockKey key) { return key.kind == BlockKind::Calibration || key.kind == BlockKind::ImuIntrinsics; }

// What is called rest may be this far from it, whatever the time between the two states.
constexpr double kRestSigma_m = 2e-3, kRestSigma_rad = 1e-3;

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
  fields.add("correlation", correlation,
             {"1", 0, 0.999, "of the errors of two sights of a track right after one another; 0: all independent"});
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
  soft_priors.push_back(scale_prior({BlockKind::LogScale, 0}, depth.scale_sigma));
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
      FeatureObservation& sight = feature.seen.insert_or_assign(id, observation).first->second;
      sight.sigma *= noise_scale[index];
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
  soft_priors.push_back(near_present(kImuKey, imu_intrinsics, Eigen::VectorXd::Constant(18, config.imu_sigma)));
}

Eigen::Vector3d Window::position(const Feature& feature) const {
  const Eigen::Vector2d& point = feature.seen.at(*feature.anchor).point;
  return T_W_C(*feature.anchor, feature.camera) * (Eigen::Vector3d(point.x(), point.y(), 1.0) / feature.inverse_depth);
}

double* Window::block(BlockKey key) {
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

const double* Window::linearisation_point(BlockKey key) {
  if (is_calibration(key)) return block(key);
  const auto in_prior = std::find(prior.blocks.begin(), prior.blocks.end(), key);
  if (in_prior == prior.blocks.end()) return block(key);
  return prior.x0[static_cast<std::size_t>(in_prior - prior.blocks.begin())].data();
}

void Window::drop_orphaned_priors() {
  std::erase_if(soft_priors, [&](const LinearPrior& soft) {
    return std::any_of(soft.blocks.begin(), soft.blocks.end(), [&](BlockKey key) { return block(key) == nullptr; });
  });
}

std::vector<Factor> Window::factors(Sights sights) {
  std::vector<Factor> out;
  if (!prior.empty()) out.push_back({std::make_unique<LinearPriorFactor>(prior), nullptr, prior.blocks});
  for (const LinearPrior& soft : soft_priors) {
    out.push_back({std::make_unique<LinearPriorFactor>(soft), nullptr, soft.blocks});
  }
  add_motion_factors(out);
  add_visual_factors(out, sights);
  add_depth_factors(*this, out);
  return out;
}

void Window::add_motion_factors(std::vector<Factor>& out) {
  if (states.empty()) return;
  for (auto b = std::next(states.begin()); b != states.end(); ++b) {
    const BlockKey pose_a{BlockKind::Pose, std::prev(b)->first}, pose_b{BlockKind::Pose, b->first};
    const BlockKey motion_a{BlockKind::Motion, pose_a.id}, motion_b{BlockKind::Motion, pose_b.id};
    out.push_back({std::make_unique<ImuFactor>(b->second.imu), nullptr, {pose_a, motion_a, pose_b, motion_b, kImuKey}});
    if (!b->second.rested) continue;
    out.push_back({std::make_unique<StandstillFactor>(kRestSigma_m, kRestSigma_rad), nullptr, {pose_a, pose_b}});
  }
}

double Window::imu_strain() {
  if (states.size() < 2) return 0.0;
  double sum = 0.0;
  for (auto a = states.begin(), b = std::next(a); b != states.end(); ++a, ++b) {
    const double* blocks[] = {a->second.pose.data(), a->second.motion.data(), b->second.pose.data(),
                              b->second.motion.data(), imu_intrinsics.data()};
    Eigen::Matrix<double, 15, 1> r;
    ImuFactor(b->second.imu).Evaluate(blocks, r.data(), nullptr);
    sum += r.squaredNorm();
  }
  return std::sqrt(sum / (15.0 * static_cast<double>(states.size() - 1)));
}

std::vector<TrackStep> Window::steps(const Feature& feature, Sights sights) const {
  std::vector<TrackStep> steps;
  const auto anchor = feature.seen.find(*feature.anchor);
  const auto follow = [&](auto first, auto last) {
    StateId before = anchor->first;
    for (auto sight = first; sight != last; ++sight) {
      if (sights == Sights::OfKeyframes && !states.at(sight->first).keyframe) continue;
      const double dt = std::abs(to_seconds(states.at(sight->first).t - states.at(before).t));
      const double correlation = track_noise.correlation * std::exp(-dt / track_noise.time_s);
      const double own = std::sqrt(1.0 - correlation * correlation);
      steps.push_back({before, sight->first, correlation, sight->second.sigma * own});
      before = sight->first;
    }
  };
  follow(std::next(anchor), feature.seen.end());
  follow(std::make_reverse_iterator(anchor), feature.seen.rend());
  return steps;
}

void Window::add_visual_factors(std::vector<Factor>& out, Sights sights) {
  for (const auto& [id, feature] : features) {
    if (!feature.anchor) continue;
    const auto view = [&](StateId state) {
      return LandmarkView{feature.seen.at(state).point, states.at(state).rate()};
    };
    const auto pose = [](StateId state) { return BlockKey{BlockKind::Pose, state}; };
    const BlockKey calib{BlockKind::Calibration, feature.camera}, depth{BlockKind::InverseDepth, id};
    const SE3& T_B_C = cameras[feature.camera].T_B_C;
    const StateId anchor = *feature.anchor;
    const LandmarkView from = view(anchor);
    for (const TrackStep& step : steps(feature, sights)) {
      Factor factor{nullptr, visual_loss_.get(), {pose(anchor), pose(step.seen)}};
      // The anchor's sight is exact by the choice of the landmark: the first step has no error to start from.
      if (step.before == anchor || step.correlation == 0.0) {
        factor.cost = std::make_unique<ReprojectionFactor>(T_B_C, from, view(step.seen), step.sigma);
      } else {
        factor.cost = std::make_unique<TrackStepFactor>(T_B_C, from, view(step.seen), view(step.before),
                                                        step.correlation, step.sigma);
        factor.blocks.push_back(pose(step.before));
      }
      factor.blocks.insert(factor.blocks.end(), {calib, depth});
      out.push_back(std::move(factor));
    }
  }
}

std::set<BlockKey> coupled_depths(const std::vector<Factor>& factors) {
  std::set<BlockKey> coupled;
  for (const Factor& factor : factors) {
    const auto is_depth = [](const BlockKey& key) { return key.kind == BlockKind::InverseDepth; };
    if (std::count_if(factor.blocks.begin(), factor.blocks.end(), is_depth) < 2) continue;
    std::copy_if(factor.blocks.begin(), factor.blocks.end(), std::inserter(coupled, coupled.end()), is_depth);
  }
  return coupled;
}

}  // namespace edged
