// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window.hpp"

#include <algorithm>
#include <iterator>

#include "edged/core/check.hpp"
#include "edged/estimator/depth_terms.hpp"
#include "edged/estimator/factors/imu_factor.hpp"
#include "edged/estimator/factors/reprojection_factor.hpp"

namespace edged {

NavState WindowState::nav() const {
  NavState nav;
  nav.t = t;
  nav.T_W_B = T_W_B();
  nav.v_W = Eigen::Map<const Eigen::Vector3d>(motion.data());
  nav.bias_gyro = Eigen::Map<const Eigen::Vector3d>(motion.data() + 3);
  nav.bias_accel = Eigen::Map<const Eigen::Vector3d>(motion.data() + 6);
  return nav;
}

MotionBlock motion_block(const NavState& state) {
  MotionBlock block;
  Eigen::Map<Eigen::Matrix<double, 9, 1>>(block.data()) << state.v_W, state.bias_gyro, state.bias_accel;
  return block;
}

WindowState window_state(const NavState& nav, Preintegration imu, bool keyframe) {
  WindowState state;
  state.t = nav.t;
  state.pose = to_block(nav.T_W_B);
  state.motion = motion_block(nav);
  state.imu = std::move(imu);
  state.keyframe = keyframe;
  return state;
}

Window::Window(const Rig& rig, double cauchy_scale, const DepthFactorConfig& depth)
    : cameras(rig.cameras),
      noise_scale(rig.cameras.size(), 1.0),
      depth_config(depth),
      last_image_(rig.cameras.size(), 0),
      visual_loss_(std::make_unique<ceres::CauchyLoss>(cauchy_scale)),
      depth_loss_(std::make_unique<ceres::CauchyLoss>(depth.cauchy_scale)) {
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
  const auto found = states.find(key.id);
  if (found == states.end()) return nullptr;
  return key.kind == BlockKind::Pose ? found->second.pose.data() : found->second.motion.data();
}

const double* Window::linearisation_point(BlockKey key) {
  const auto in_prior = std::find(prior.blocks.begin(), prior.blocks.end(), key);
  if (in_prior == prior.blocks.end()) return block(key);
  return prior.x0[static_cast<std::size_t>(in_prior - prior.blocks.begin())].data();
}

void Window::drop_orphaned_priors() {
  std::erase_if(soft_priors, [&](const LinearPrior& soft) {
    return std::any_of(soft.blocks.begin(), soft.blocks.end(), [&](BlockKey key) { return block(key) == nullptr; });
  });
}

std::vector<Factor> Window::factors() {
  std::vector<Factor> out;
  if (!prior.empty()) out.push_back({std::make_unique<LinearPriorFactor>(prior), nullptr, prior.blocks});
  for (const LinearPrior& soft : soft_priors) {
    out.push_back({std::make_unique<LinearPriorFactor>(soft), nullptr, soft.blocks});
  }
  for (auto it = states.begin(); it != states.end(); ++it) {
    if (it == states.begin()) continue;
    const StateId a = std::prev(it)->first, b = it->first;
    out.push_back({std::make_unique<ImuFactor>(it->second.imu),
                   nullptr,
                   {{BlockKind::Pose, a}, {BlockKind::Motion, a}, {BlockKind::Pose, b}, {BlockKind::Motion, b}}});
  }
  add_visual_factors(out);
  add_depth_factors(*this, out);
  return out;
}

void Window::add_visual_factors(std::vector<Factor>& out) {
  for (auto& [id, feature] : features) {
    if (!feature.anchor) continue;
    const FeatureObservation& anchor = feature.seen.at(*feature.anchor);
    for (const auto& [state, observation] : feature.seen) {
      if (state == *feature.anchor) continue;
      out.push_back({std::make_unique<ReprojectionFactor>(cameras[feature.camera].T_B_C, anchor.point,
                                                          observation.point, observation.sigma),
                     visual_loss_.get(),
                     {{BlockKind::Pose, *feature.anchor}, {BlockKind::Pose, state}, {BlockKind::InverseDepth, id}}});
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
