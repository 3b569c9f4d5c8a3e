// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window.hpp"

#include <algorithm>
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
    : depth_config_(depth),
      visual_loss_(std::make_unique<ceres::CauchyLoss>(cauchy_scale)),
      depth_loss_(std::make_unique<ceres::CauchyLoss>(depth.cauchy_scale)) {
  for (const RigCamera& given : rig.cameras) {
    cameras_.push_back({given, {0.0, 0.0, 0.0, to_seconds(given.time_offset)}});
  }
  free_calibration({0.0, 0.0, 0.0});
  if (!depth.enabled) return;
  ln_scale_[0] = 0.0;
  add_soft_prior(
      near_present({BlockKind::LogScale, 0}, {&ln_scale_[0], 1}, Eigen::VectorXd::Constant(1, depth.scale_sigma)));
}

std::size_t Window::camera_index(const std::string& name) const {
  const auto camera =
      std::find_if(cameras_.begin(), cameras_.end(), [&](const auto& c) { return c.given.name == name; });
  EDGED_CHECK(camera != cameras_.end(), "no camera '{}' in the rig", name);
  return static_cast<std::size_t>(camera - cameras_.begin());
}

RigCamera Window::calibrated(std::size_t camera) const {
  RigCamera found = cameras_[camera].given;
  const CalibrationBlock& off = cameras_[camera].calibration;
  found.T_B_C = camera_pose(found.T_B_C, {}, SE3(), off.data());
  found.time_offset = duration_from_seconds(off[3]);
  return found;
}

SE3 Window::T_W_C(StateId state, std::size_t camera) const {
  const WindowState& at = states_.at(state);
  const WindowCamera& by = cameras_[camera];
  return camera_pose(at.T_W_B(), at.rate(), by.given.T_B_C, by.calibration.data());
}

Eigen::Vector3d Window::position(const Feature& feature) const {
  const Eigen::Vector2d& point = feature.seen.at(*feature.anchor).point;
  return T_W_C(*feature.anchor, feature.camera) * (Eigen::Vector3d(point.x(), point.y(), 1.0) / feature.inverse_depth);
}

WindowState& Window::state(StateId id) {
  const auto found = states_.find(id);
  EDGED_CHECK(found != states_.end(), "no state {} in the window", id);
  return found->second;
}

Feature& Window::feature(FeatureId id) {
  const auto found = features_.find(id);
  EDGED_CHECK(found != features_.end(), "no feature {} in the window", id);
  return found->second;
}

StateId Window::add_state(WindowState state, const std::vector<CameraObservations>& observations) {
  EDGED_CHECK(states_.empty() || state.t > newest().t, "a state at {} ns after one at {} ns", to_ns(state.t),
              to_ns(newest().t));
  states_.emplace(next_state_, std::move(state));
  for (const CameraObservations& view : observations) observe(view);
  return next_state_++;
}

/// What a camera sees at the newest state.
void Window::observe(const CameraObservations& view) {
  const std::size_t index = camera_index(view.camera);
  WindowCamera& camera = cameras_[index];
  camera.last_image = newest_id();
  for (const FeatureObservation& observation : view.features) {
    const auto [entry, unknown] = features_.try_emplace(observation.id);
    Feature& feature = entry->second;
    if (unknown) feature.camera = index;
    EDGED_CHECK(feature.camera == index, "camera '{}' sees feature {} of '{}'", view.camera, observation.id,
                cameras_[feature.camera].given.name);
    feature.last_seen = newest_id();
    FeatureObservation& kept = feature.seen.insert_or_assign(newest_id(), observation).first->second;
    kept.sigma *= camera.noise_scale;
  }
}

void Window::set_depth(const RegionDepth& depth) {
  camera_index(depth.camera);  // the rig must have it
  state(newest_id()).depth = depth;
}

void Window::drop_state(StateId id, Preintegration joined) {
  const WindowState& leaving = state(id);
  EDGED_CHECK(!leaving.keyframe && id != oldest_id() && id != newest_id(), "state {} cannot be dropped", id);
  std::next(states_.find(id))->second.imu = std::move(joined);
  for (auto& [feature_id, feature] : features_) feature.seen.erase(id);
  states_.erase(id);
  drop_orphaned_priors();
}

void Window::keep_point(StateId id, std::size_t camera, const KeyframePoint& point) {
  EDGED_CHECK(state(id).keyframe && camera < cameras_.size(), "state {}, camera {}", id, camera);
  state(id).kept[camera].push_back(point);
}

void Window::drop_oldest(LinearPrior prior, StateId new_anchor, const std::map<FeatureId, double>& inherited) {
  EDGED_CHECK(states_.size() > 1, "the only state cannot leave");
  const StateId oldest = oldest_id();
  for (const auto& [id, inverse_depth] : inherited) {
    make_landmark(id, new_anchor, inverse_depth);
    std::erase_if(feature(id).seen, [&](const auto& observation) { return observation.first < new_anchor; });
  }
  std::erase_if(features_, [&](const auto& entry) { return entry.second.anchor == oldest; });
  for (auto& [id, feature] : features_) feature.seen.erase(oldest);
  states_.erase(oldest);
  if (!ln_scale_.empty()) ln_scale_.erase(ln_scale_.begin(), std::prev(ln_scale_.end()));
  check(prior);
  EDGED_CHECK(prior.information.cols() == prior.J.cols(), "a prior of {} columns whose J^T J has {}", prior.J.cols(),
              prior.information.cols());
  prior_ = std::move(prior);
  drop_orphaned_priors();
}

void Window::make_landmark(FeatureId id, StateId anchor, double inverse_depth) {
  Feature& track = feature(id);
  EDGED_CHECK(track.seen.contains(anchor) && state(anchor).keyframe, "state {} is no keyframe that sees feature {}",
              anchor, id);
  track.anchor = anchor;
  track.inverse_depth = inverse_depth;
}

void Window::forget_observation(FeatureId id, StateId state) {
  EDGED_CHECK(feature(id).anchor != state, "landmark {} is anchored in state {}", id, state);
  feature(id).seen.erase(state);
}

void Window::forget_ended_tracks() {
  std::erase_if(features_, [&](const auto& entry) { return !entry.second.anchor && !alive(entry.second); });
}

void Window::rescale_noise(std::size_t camera, double factor) {
  cameras_.at(camera).noise_scale *= factor;
  for (auto& [id, feature] : features_) {
    if (feature.camera != camera) continue;
    for (auto& [state, observation] : feature.seen) observation.sigma *= factor;
  }
}

void Window::free_calibration(const CalibrationConfig& config) {
  std::erase_if(soft_priors_, [](const LinearPrior& soft) { return is_calibration(soft.blocks.front()); });
  const double rotation = config.rotation_sigma_deg * std::numbers::pi / 180.0;
  const Eigen::Vector4d of_camera(rotation, rotation, rotation, config.time_offset_sigma_ms * 1e-3);
  for (std::size_t camera = 0; camera < cameras_.size(); ++camera) {
    add_soft_prior(near_present({BlockKind::Calibration, camera}, cameras_[camera].calibration, of_camera));
  }
  add_soft_prior(near_present(kImuIntrinsicsKey, imu_intrinsics_, Eigen::VectorXd::Constant(18, config.imu_sigma)));
}

void Window::add_soft_prior(LinearPrior prior) {
  check(prior);
  soft_priors_.push_back(std::move(prior));
}

void Window::check(const LinearPrior& prior) const {
  Eigen::Index columns = 0;
  for (const BlockKey& key : prior.blocks) {
    // Not of inverse depths either: landmarks come and go without asking for priors.
    EDGED_CHECK(block(key) != nullptr && key.kind != BlockKind::InverseDepth,
                "a prior of block {} of kind {}, which does not stay in the window", key.id,
                static_cast<int>(key.kind));
    columns += tangent_size(key.kind);
  }
  EDGED_CHECK(prior.J.cols() == columns && prior.x0.size() == prior.blocks.size(),
              "a prior of {} blocks with {} columns, {} of them in J", prior.blocks.size(), columns, prior.J.cols());
}

void Window::drop_orphaned_priors() {
  std::erase_if(soft_priors_, [&](const LinearPrior& soft) {
    return std::any_of(soft.blocks.begin(), soft.blocks.end(), [&](BlockKey key) { return block(key) == nullptr; });
  });
}

std::optional<BlockKey> Window::scale_block() const {
  if (ln_scale_.empty()) return std::nullopt;
  return BlockKey{BlockKind::LogScale, ln_scale_.rbegin()->first};
}

BlockKey Window::begin_scale() {
  EDGED_CHECK(!ln_scale_.empty(), "a window without depth factors has no scale of theirs");
  const auto [piece, ln_s] = *ln_scale_.rbegin();
  ln_scale_.emplace(piece + 1, ln_s);
  return {BlockKind::LogScale, piece + 1};
}

const double* Window::block(BlockKey key) const {
  if (key.kind == BlockKind::InverseDepth) {
    const auto found = features_.find(key.id);
    return found == features_.end() || !found->second.anchor ? nullptr : &found->second.inverse_depth;
  }
  if (key.kind == BlockKind::LogScale) {
    const auto found = ln_scale_.find(key.id);
    return found == ln_scale_.end() ? nullptr : &found->second;
  }
  if (key.kind == BlockKind::Calibration) {
    return key.id < cameras_.size() ? cameras_[key.id].calibration.data() : nullptr;
  }
  if (key.kind == BlockKind::ImuIntrinsics) return imu_intrinsics_.data();
  const auto found = states_.find(key.id);
  if (found == states_.end()) return nullptr;
  return key.kind == BlockKind::Pose ? found->second.pose.data() : found->second.motion.data();
}

const double* Window::linearisation_point(BlockKey key) const {
  if (is_calibration(key)) return block(key);
  const auto in_prior = std::find(prior_.blocks.begin(), prior_.blocks.end(), key);
  if (in_prior == prior_.blocks.end()) return block(key);
  return prior_.x0[static_cast<std::size_t>(in_prior - prior_.blocks.begin())].data();
}

void Window::move(BlockKey key, std::span<const double> step) {
  const double* values = block(key);
  const auto size = static_cast<std::size_t>(tangent_size(key.kind));
  EDGED_CHECK(values != nullptr, "block {} of kind {} is not in the window", key.id, static_cast<int>(key.kind));
  EDGED_CHECK(step.size() == size, "a step of {} numbers in a tangent space of {}", step.size(), size);
  plus(key.kind, const_cast<double*>(values), step.data());  // our own: block() looks as others do
}

template <typename Self, typename Visit>
void Window::for_each_block(Self& self, const Visit& visit) {
  for (auto& [id, state] : self.states_) visit(std::span(state.pose)), visit(std::span(state.motion));
  for (auto& [id, feature] : self.features_) {
    if (feature.anchor) visit(std::span(&feature.inverse_depth, 1));
  }
  for (auto& [piece, ln_s] : self.ln_scale_) visit(std::span(&ln_s, 1));
  for (auto& camera : self.cameras_) visit(std::span(camera.calibration));
  visit(std::span(self.imu_intrinsics_));
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

}  // namespace edged
