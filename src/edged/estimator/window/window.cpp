// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/window.hpp"

#include <algorithm>
#include <span>

#include "edged/core/check.hpp"
#include "edged/estimator/factors/imu_factor.hpp"
#include "edged/estimator/factors/standstill_factor.hpp"
#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

/// Removes the observations from one state on, up to another.
void remove_observations(Feature& feature, StateId first, StateId end) {
  feature.observations.erase(feature.observations.lower_bound({first, 0}), feature.observations.lower_bound({end, 0}));
}

bool is_of(const Factor& factor, StateId state) {
  return std::ranges::any_of(factor.blocks(), [&](const BlockKey& key) {
    return key.id == state && (key.kind == BlockKind::Pose || key.kind == BlockKind::Motion);
  });
}

}  // namespace

bool Feature::seen_at(StateId state) const {
  const auto first = observations.lower_bound({state, 0});
  return first != observations.end() && first->first.state == state;
}

OdomState WindowState::nav() const {
  OdomState nav;
  nav.t = t;
  nav.T_O_B = T_O_B();
  nav.v_O = Eigen::Map<const Eigen::Vector3d>(motion.data());
  nav.bias_gyro = Eigen::Map<const Eigen::Vector3d>(motion.data() + 3);
  nav.bias_accel = Eigen::Map<const Eigen::Vector3d>(motion.data() + 6);
  return nav;
}

BodyRate WindowState::rate() const {
  const OdomState state = nav();
  return {gyro_B - state.bias_gyro, state.v_O};
}

MotionBlock motion_block(const OdomState& state) {
  MotionBlock block;
  Eigen::Map<Eigen::Matrix<double, 9, 1>>(block.data()) << state.v_O, state.bias_gyro, state.bias_accel;
  return block;
}

WindowState window_state(const OdomState& nav, const Eigen::Vector3d& gyro_B, Preintegration imu, bool keyframe) {
  WindowState state;
  state.t = nav.t;
  state.pose = to_block(nav.T_O_B);
  state.motion = motion_block(nav);
  state.gyro_B = gyro_B;
  state.imu = std::move(imu);
  state.keyframe = keyframe;
  return state;
}

Window::Window(const Rig& rig, const TrackNoise& noise, const DepthFactorConfig& depth)
    : prior_(std::make_shared<LinearPriorFactor>(LinearPrior{})), track_noise_(noise), depth_config_(depth) {
  for (const RigCamera& given : rig.cameras) {
    WindowCamera& camera = cameras_.emplace_back(WindowCamera{given});
    camera.linearised_model = given.model;
    camera.calibration[kTimeAt] = to_seconds(given.time_offset);
  }
  free_calibration(CalibrationConfig::fixed());
  if (depth.enabled) add_parameter(BlockKind::LogScale, 0.0, {depth.scale_sigma, kDepthTuning.scale_walk});
}

std::size_t Window::camera_index(const std::string& name) const {
  const auto camera =
      std::find_if(cameras_.begin(), cameras_.end(), [&](const auto& c) { return c.given.name == name; });
  EDGED_CHECK(camera != cameras_.end(), "no camera '{}' in the rig", name);
  return static_cast<std::size_t>(camera - cameras_.begin());
}

SE3 Window::T_O_C(const ObservationKey& image) const {
  const WindowState& at = states_.at(image.state);
  const WindowCamera& by = cameras_[image.camera];
  return camera_pose(at.T_O_B(), at.rate(), by.given.T_B_C, by.calibration.data());
}

bool Window::alive(const Feature& feature, std::size_t camera) const {
  const auto seen = feature.last_seen.find(camera);
  return seen != feature.last_seen.end() && seen->second == cameras_[camera].last_image;
}

bool Window::alive(const Feature& feature) const {
  return std::ranges::any_of(feature.last_seen,
                             [&](const auto& seen) { return seen.second == cameras_[seen.first].last_image; });
}

Eigen::Vector3d Window::position(const Feature& feature) const {
  const Eigen::Vector2d point = this->point(*feature.anchor, feature.observations.at(*feature.anchor));
  return T_O_C(*feature.anchor) * (Eigen::Vector3d(point.x(), point.y(), 1.0) / feature.inverse_depth);
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
  const bool first = states_.empty();
  const StateId before = first ? next_state_ : newest_id();
  const WindowState& added = states_.emplace(next_state_, std::move(state)).first->second;
  if (!first) {
    auto imu = std::make_shared<ImuFactor>(before, next_state_, added.imu);
    imu->set_noise_scale(imu_noise_scale_);
    add(std::move(imu));
  }
  if (!first && added.stationary) add(std::make_shared<StandstillFactor>(before, next_state_));
  for (const CameraObservations& view : observations) observe(view);
  return next_state_++;
}

/// Takes the observations of a camera at the newest state.
void Window::observe(const CameraObservations& view) {
  const std::size_t index = camera_index(view.camera);
  WindowCamera& camera = cameras_[index];
  camera.last_image = newest_id();
  for (const FeatureObservation& observation : view.features) {
    Feature& feature = features_[observation.id];
    feature.last_seen[index] = newest_id();
    const ObservationKey image{newest_id(), index};
    WindowObservation& kept =
        feature.observations.insert_or_assign(image, WindowObservation{observation, {}, false}).first->second;
    kept.sigma *= camera.noise_scale;
    linearise(camera, kept);
  }
}

void Window::set_depth(const RegionDepth& depth) {
  camera_index(depth.camera);  // the rig must have it
  state(newest_id()).depth = depth;
}

void Window::add(std::shared_ptr<Factor> factor) {
  check(*factor);
  const auto same = [&](const auto& other) { return other->blocks() == factor->blocks() && other->merge(*factor); };
  if (std::ranges::none_of(factors_, same)) factors_.push_back(std::move(factor));
}

void Window::drop_state(StateId id, Preintegration joined) {
  const auto leaving = states_.find(id);
  EDGED_CHECK(leaving != states_.end() && !leaving->second.keyframe && id != oldest_id() && id != newest_id(),
              "state {} cannot be dropped", id);
  const auto before = std::prev(leaving), after = std::next(leaving);
  after->second.imu = std::move(joined);
  const DroppedState dropped{before->first, id, after->first, after->second.imu, leaving->second.imu};
  std::vector<std::shared_ptr<Factor>> kept = std::move(factors_);
  factors_.clear();
  for (std::shared_ptr<Factor>& factor : kept) {
    if (is_of(*factor, id)) factor = factor->without(dropped);
    if (factor != nullptr) add(std::move(factor));
  }
  for (auto& [feature_id, feature] : features_) remove_observations(feature, id, id + 1);
  states_.erase(leaving);
  remove_orphaned_factors();
}

void Window::add_marginalized_point(const ObservationKey& image, const KeyframePoint& point) {
  EDGED_CHECK(state(image.state).keyframe && image.camera < cameras_.size(), "state {}, camera {}", image.state,
              image.camera);
  state(image.state).marginalized_points[image.camera].push_back(point);
}

void Window::drop_oldest(LinearPrior prior, const std::map<FeatureId, NewAnchor>& inherited) {
  EDGED_CHECK(states_.size() > 1, "the only state cannot leave");
  const StateId oldest = oldest_id();
  for (const auto& [id, anchor] : inherited) {
    make_landmark(id, anchor);
    remove_observations(feature(id), 0, anchor.key.state);
  }
  std::erase_if(features_, [&](const auto& entry) {
    const std::optional<ObservationKey>& anchor = entry.second.anchor;
    return anchor && anchor->state == oldest;
  });
  for (auto& [id, feature] : features_) remove_observations(feature, oldest, oldest + 1);
  states_.erase(oldest);
  for (auto& [kind, parameter] : parameters_) {
    for (const auto& [block, value] : parameter.blocks()) {
      for (const auto& factor : factors_) factor->replace({kind, block}, parameter.present());
    }
    parameter.drop_old();
  }
  set_prior(std::move(prior));
  remove_orphaned_factors();
}

void Window::set_prior(LinearPrior prior) {
  EDGED_CHECK(prior.information.cols() == prior.J.cols(), "a prior of {} columns whose J^T J has {}", prior.J.cols(),
              prior.information.cols());
  prior_ = std::make_shared<LinearPriorFactor>(std::move(prior));
  check(*prior_);
}

void Window::make_landmark(FeatureId id, const NewAnchor& anchor) {
  Feature& track = feature(id);
  EDGED_CHECK(track.observations.contains(anchor.key) && state(anchor.key.state).keyframe,
              "state {} is no keyframe whose camera {} sees feature {}", anchor.key.state, anchor.key.camera, id);
  track.anchor = anchor.key;
  for (auto& [image, observation] : track.observations) observation.predicted = false;
  track.inverse_depth = anchor.inverse_depth;
}

void Window::remove_observation(FeatureId id, const ObservationKey& image) {
  EDGED_CHECK(feature(id).anchor != image, "landmark {} is anchored in state {}", id, image.state);
  feature(id).observations.erase(image);
}

void Window::remove_ended_tracks() {
  std::erase_if(features_, [&](const auto& entry) { return !entry.second.anchor && !alive(entry.second); });
}

void Window::rescale_noise(std::size_t camera, double factor) {
  cameras_.at(camera).noise_scale *= factor;
  for (auto& [id, feature] : features_) {
    for (auto& [image, observation] : feature.observations) {
      if (image.camera == camera) observation.sigma *= factor;
    }
  }
}

void Window::set_imu_noise_scale(double scale) {
  imu_noise_scale_ = scale;
  for (const auto& factor : factors_)
    if (auto* imu = dynamic_cast<ImuFactor*>(factor.get())) imu->set_noise_scale(scale);
}

void Window::add_soft_prior(LinearPrior prior) {
  auto soft = std::make_shared<LinearPriorFactor>(std::move(prior));
  check(*soft);
  soft_priors_.push_back(std::move(soft));
}

void Window::check(const Factor& factor) const {
  for (const BlockKey& key : factor.blocks()) {
    // Not of inverse depths either: landmarks are added and removed without regard to factors.
    EDGED_CHECK(block(key) != nullptr && key.kind != BlockKind::InverseDepth,
                "a factor of block {} of kind {}, which does not stay in the window", key.id,
                static_cast<int>(key.kind));
  }
}

void Window::remove_orphaned_factors() {
  const auto orphaned = [&](const auto& factor) {
    return std::ranges::any_of(factor->blocks(), [&](const BlockKey& key) { return block(key) == nullptr; });
  };
  std::erase_if(soft_priors_, orphaned);
  std::erase_if(factors_, orphaned);
}

void Window::add_parameter(BlockKind kind, double value, const RandomWalk& walk) {
  const auto [added, is_new] = parameters_.try_emplace(kind, kind, next_parameter_, value, walk.per_root_s);
  EDGED_CHECK(is_new, "a second parameter of kind {}", static_cast<int>(kind));
  add_soft_prior(prior_at(added->second.present(), {&value, 1}, Eigen::VectorXd::Constant(1, walk.sigma)));
}

std::optional<BlockKey> Window::parameter(BlockKind kind) const {
  const auto found = parameters_.find(kind);
  return found == parameters_.end() ? std::nullopt : std::optional(found->second.present());
}

std::vector<BlockKey> Window::parameters() const {
  std::vector<BlockKey> present;
  for (const auto& [kind, parameter] : parameters_) present.push_back(parameter.present());
  return present;
}

void Window::remove_parameter(BlockKind kind, LinearPrior prior) {
  next_parameter_ = std::max(next_parameter_, parameters_.at(kind).present().id + 1);
  parameters_.erase(kind);
  set_prior(std::move(prior));
  remove_orphaned_factors();
}

const double* Window::block(BlockKey key) const {
  if (key.kind == BlockKind::InverseDepth) {
    const auto found = features_.find(key.id);
    return found == features_.end() || !found->second.anchor ? nullptr : &found->second.inverse_depth;
  }
  if (const auto parameter = parameters_.find(key.kind); parameter != parameters_.end()) {
    const auto found = parameter->second.blocks().find(key.id);
    return found == parameter->second.blocks().end() ? nullptr : &found->second;
  }
  if (key.kind == BlockKind::Calibration) {
    return key.id < cameras_.size() ? cameras_[key.id].calibration.data() : nullptr;
  }
  if (key.kind == BlockKind::ImuIntrinsics) return imu_intrinsics_.data();
  const auto found = states_.find(key.id);
  if (found == states_.end() || (key.kind != BlockKind::Pose && key.kind != BlockKind::Motion)) return nullptr;
  return key.kind == BlockKind::Pose ? found->second.pose.data() : found->second.motion.data();
}

void Window::move(BlockKey key, std::span<const double> step) {
  const double* values = block(key);
  const auto size = static_cast<std::size_t>(tangent_size(key.kind));
  EDGED_CHECK(values != nullptr, "block {} of kind {} is not in the window", key.id, static_cast<int>(key.kind));
  EDGED_CHECK(step.size() == size, "a step of {} numbers in a tangent space of {}", step.size(), size);
  plus(key.kind, const_cast<double*>(values), step.data());  // not const: our own blocks
}

template <typename Self, typename Visit>
void Window::for_each_block(Self& self, const Visit& visit) {
  for (auto& [id, state] : self.states_) visit(std::span(state.pose)), visit(std::span(state.motion));
  for (auto& [id, feature] : self.features_) {
    if (feature.anchor) visit(std::span(&feature.inverse_depth, 1));
  }
  for (auto& [kind, parameter] : self.parameters_) {
    for (auto& [block, value] : parameter.blocks()) visit(std::span(&value, 1));
  }
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
