// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/estimator.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <numbers>

#include "edged/core/check.hpp"
#include "edged/estimator/sliding.hpp"
#include "edged/estimator/solver.hpp"

namespace edged {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kGaugeSigma_m = 1e-4, kGaugeSigma_rad = 1e-4;
constexpr double kFree = std::numeric_limits<double>::infinity();
constexpr int kStartIterations = 25;
constexpr int kMinStartLandmarks = 15;
constexpr double kMaxSpeed = 60.0, kMaxGyroBias = 0.5, kMaxAccelBias = 3.0;  // [m/s], [rad/s], [m/s^2]
constexpr double kRestStretch = 10.0;  // times the longest IMU interval
constexpr double kMaxGravityError = 1.0;      // [m/s^2] of the mean acceleration at rest
constexpr double kMaxFreeGravityError = 0.3;   // of a start in motion, when gravity's length is left free
constexpr double kMaxStandstillSpeed = 0.15;   // [m/s]: what the estimate says is moving is not at rest
constexpr double kMaxPendingImu_s = 10.0;      // without an image before the start
constexpr double kMaxStartRms = 2.0;  // [sigma] of the start-up window's sights: more is a wrong start

MotionBlock motion_block(const NavState& state) {
  MotionBlock block;
  Eigen::Map<Eigen::Matrix<double, 9, 1>>(block.data()) << state.v_W, state.bias_gyro, state.bias_accel;
  return block;
}

void append_imu(std::vector<ImuSample>& to, const std::vector<ImuSample>& more) {
  // The first sample of a packet repeats the last one of the packet before.
  to.insert(to.end(), more.begin() + (to.empty() || more.empty() ? 0 : 1), more.end());
}

WindowState to_window_state(const NavState& nav, Preintegration imu, bool keyframe) {
  WindowState state;
  state.t = nav.t;
  state.pose = to_block(nav.T_W_B);
  state.motion = motion_block(nav);
  state.imu = std::move(imu);
  state.keyframe = keyframe;
  return state;
}

/// Biases no sensor of this kind has, a speed no body it is made for reaches, or numbers that are none.
bool plausible(const NavState& state) {
  return state.T_W_B.translation().allFinite() && state.v_W.norm() < kMaxSpeed &&
         state.bias_gyro.norm() < kMaxGyroBias && state.bias_accel.norm() < kMaxAccelBias;
}

/// Whether it is time for another depth factor, of the newest state.
bool depth_due(const Window& window) {
  if (!window.depth_config.enabled) return false;
  const Timestamp before = window.newest().t - duration_from_seconds(window.depth_config.min_interval_s);
  return std::none_of(window.states.begin(), window.states.end(),
                      [&](const auto& state) { return state.second.depth && state.second.t > before; });
}

/// Root mean square of the landmarks' residuals in sigmas.
double visual_rms(Window& window) {
  double sum = 0.0;
  int n = 0;
  for (const auto& [id, feature] : window.features) {
    if (!feature.anchor) continue;
    const Eigen::Vector3d p_W = window.position(feature);
    for (const auto& [state, seen] : feature.seen) {
      if (state == *feature.anchor) continue;
      const Eigen::Vector3d p_C = window.T_W_C(state, feature.camera).inverse() * p_W;
      sum += std::min((p_C.hnormalized() - seen.point).squaredNorm() / (seen.sigma * seen.sigma), 25.0);
      ++n;
    }
  }
  return n == 0 ? kFree : std::sqrt(sum / (2.0 * n));
}

}  // namespace

void EstimatorConfig::visit(ConfigFields& fields) {
  fields.add("recent_states", recent_states, {"", 1, 20, "newest states in the window, keyframes or not"});
  fields.add("keyframes", keyframes, {"", 2, 30, "older keyframes in the window; more are slower and more accurate"});
  fields.add("max_interval_s", max_interval_s, {"s", 0.2, 10, "after this time a state becomes a keyframe in any case"});
  fields.add("iterations", iterations, {"", 1, 50, "solver iterations a packet"});
  fields.add("cauchy_scale", cauchy_scale, {"sigma", 0.1, 100, "visual residuals beyond this are weighted down"});
  fields.add("gyro_bias_sigma", gyro_bias_sigma, {"rad/s", 1e-5, 1, "how far the gyro bias may lie from the guess of a start in motion"});
  fields.add("rest_gyro_bias_sigma", rest_gyro_bias_sigma,
             {"rad/s", 1e-5, 1, "how far the gyro bias may lie from the mean rate measured at rest"});
  fields.add("accel_bias_sigma", accel_bias_sigma, {"m/s^2", 1e-4, 5, "how far the accelerometer bias may lie from zero"});
  fields.add("zero_velocity_sigma", zero_velocity_sigma, {"m/s", 1e-4, 1, "how still a standstill is"});
  fields.add("init_spacing_s", init_spacing_s, {"s", 0.01, 1, "time between the views of a start in motion"});
  fields.add("init_min_views", init_min_views, {"", 5, 30, "views a start in motion needs at least"});
  fields.add("init_max_views", init_max_views, {"", 5, 60, "views a start in motion looks back on at most"});
  fields.add("init_parallax_deg", init_parallax_deg, {"deg", 0.1, 30, "parallax a start in motion waits for"});
  fields.add("noise_gain", noise_gain, {"", 0, 1, "speed of adapting each camera's noise to its residuals; 0: fixed"});
  fields.add("noise_inflation", noise_inflation,
             {"", 0.5, 20, "assumed noise over the spread of the residuals, because errors last from image to image"});
  fields.add("min_noise_scale", min_noise_scale, {"", 0.01, 1, "least adapted noise over the configured one"});
  fields.add("max_noise_scale", max_noise_scale, {"", 1, 100, "largest adapted noise over the configured one"});
  fields.group("landmarks", landmarks);
  fields.group("standstill", standstill);
}

Estimator::Estimator(const Rig& rig, const ImuNoise& noise, const EstimatorConfig& config)
    : noise_(noise), rig_(rig), config_(config), window_(rig, config.cauchy_scale, config.depth_factor),
      standstill_(config.standstill), depth_scale_{0.0, config.depth_factor.scale_sigma} {}

EstimatorResult Estimator::add(const EstimatorInput& input) {
  EstimatorResult result;
  standstill_.add(input.imu, input.observations, input.events_quiet);
  result.standstill = standstill_.still();
  if (!initialized_) {
    result.waiting_for = try_to_start(input);
    return result;
  }
  append(input);
  triangulate_features(window_, config_.landmarks);
  const bool new_depth = take_depth();
  optimize(result, config_.iterations);
  if (new_depth) depth_scale_ = estimate_scale(window_);
  adapt_noise();
  slide();
  return result;
}

Eigen::Vector3d Estimator::gyro_bias() const {
  return initialized_ ? newest().bias_gyro : Eigen::Vector3d::Zero();
}

std::optional<double> Estimator::depth(FeatureId id) const {
  const auto found = window_.features.find(id);
  if (found == window_.features.end() || !found->second.anchor) return std::nullopt;
  const StateId newest = window_.states.rbegin()->first;
  const double z = (window_.T_W_C(newest, found->second.camera).inverse() * window_.position(found->second)).z();
  return z > config_.landmarks.min_depth_m ? std::optional(z) : std::nullopt;
}

std::optional<LogScale> Estimator::depth_scale() const {
  return config_.depth_factor.enabled ? std::optional(depth_scale_) : std::nullopt;
}

std::string Estimator::try_to_start(const EstimatorInput& input) {
  append_imu(pending_imu_, input.imu);
  if (to_seconds(input.t - pending_imu_.front().t) > kMaxPendingImu_s) {
    buffer_.clear();
    pending_imu_ = input.imu;
  }
  const bool any_corner = std::any_of(input.observations.begin(), input.observations.end(),
                                      [](const CameraObservations& view) { return !view.features.empty(); });
  const bool due = buffer_.empty() ? any_corner : any_corner && input.t - buffer_.back().t >= duration_from_seconds(config_.init_spacing_s);
  if (due) {
    buffer_.push_back({input.t, std::move(pending_imu_), input.observations, input.depth});
    pending_imu_.clear();
    if (buffer_.size() > static_cast<std::size_t>(config_.init_max_views)) buffer_.erase(buffer_.begin());
  }
  if (standstill_.still()) {
    const double gravity = standstill_.mean_accel_B().norm();
    if (std::abs(gravity - 9.81) > kMaxGravityError) {
      return fmt::format("an accelerometer in m/s^2: it reads {:.2f} of 9.81 at rest", gravity);
    }
    start_at_rest(input);
    return "";
  }
  const std::string not_rest = "rest (" + standstill_.reason() + ")";
  if (buffer_.size() < static_cast<std::size_t>(config_.init_min_views)) {
    return fmt::format("{} or {} of {} views in motion", not_rest, buffer_.size(), config_.init_min_views);
  }
  const double parallax = median_parallax(buffer_, rig_, noise_) / kDeg;
  if (parallax < config_.init_parallax_deg) {
    return fmt::format("{} or parallax {:.2f} of {:.2f} deg", not_rest, parallax, config_.init_parallax_deg);
  }
  if (!due) return "the next view";
  if (!start_in_motion()) return fmt::format("motion that fits the IMU (parallax {:.2f} deg)", parallax);
  return "";
}

void Estimator::start_at_rest(const EstimatorInput& input) {
  NavState state;
  state.t = input.t;
  state.T_W_B = SE3(Eigen::Quaterniond::FromTwoVectors(standstill_.mean_accel_B(), Eigen::Vector3d::UnitZ()),
                    Eigen::Vector3d::Zero());
  state.bias_gyro = standstill_.mean_gyro_B();
  const StateId id = window_.add_state(to_window_state(state, {}, true));
  window_.add_observations(id, input.observations);
  const BlockKey pose{BlockKind::Pose, id}, motion{BlockKind::Motion, id};
  window_.soft_priors.push_back(gauge_prior(pose, to_block(state.T_W_B), kGaugeSigma_m, kGaugeSigma_rad));
  // At rest the tilt is as well known as the accelerometer bias: gravity's direction is what was measured.
  LinearPrior tilt;
  tilt.blocks = {pose};
  tilt.x0 = {{window_.states.at(id).pose.begin(), window_.states.at(id).pose.end()}};
  tilt.J = Eigen::MatrixXd::Zero(2, 6);
  tilt.J.block<2, 3>(0, 3) = state.T_W_B.R().topRows<2>() / (config_.accel_bias_sigma / 9.81);
  tilt.r = Eigen::VectorXd::Zero(2);
  window_.soft_priors.push_back(tilt);
  window_.soft_priors.push_back(motion_prior(
      motion, motion_block(state), {config_.zero_velocity_sigma, config_.rest_gyro_bias_sigma, config_.accel_bias_sigma}));
  initialized_ = true;
  buffer_.clear();
  spdlog::info("started at rest at {:.3f} s", to_seconds(input.t));
}

bool Estimator::start_in_motion() {
  const std::optional<Alignment> alignment = align(buffer_, rig_, noise_);
  if (!alignment) return false;
  Window window(rig_, config_.cauchy_scale, config_.depth_factor);
  for (std::size_t i = 0; i < buffer_.size(); ++i) {
    const NavState& nav = alignment->states[i];
    Preintegration imu =
        i == 0 ? Preintegration{} : Preintegration(buffer_[i].imu, nav.bias_gyro, nav.bias_accel, noise_);
    const StateId id = window.add_state(to_window_state(nav, std::move(imu), true));
    window.add_observations(id, buffer_[i].observations);
    if (depth_due(window)) window.states.at(id).depth = buffer_[i].depth;
  }
  const auto& [first, state] = *window.states.begin();
  window.soft_priors.push_back(gauge_prior({BlockKind::Pose, first}, state.pose, kGaugeSigma_m, kGaugeSigma_rad));
  MotionBlock mean = state.motion;
  window.soft_priors.push_back(motion_prior({BlockKind::Motion, first}, mean,
                                            {kFree, config_.gyro_bias_sigma, config_.accel_bias_sigma}));
  std::swap(window_, window);
  EstimatorResult unused;
  for (int round = 0; round < 3; ++round) {
    triangulate_features(window_, config_.landmarks);
    optimize(unused, kStartIterations);
  }
  const double rms = visual_rms(window_);
  spdlog::info("start in motion: {} landmarks, rms {:.2f} sigma, gravity error {:.2f}, speed {:.2f} m/s", unused.landmarks,
               rms, alignment->gravity_error, window_.newest().nav().v_W.norm());
  const bool plausible = rms <= kMaxStartRms && std::abs(alignment->gravity_error) < kMaxFreeGravityError &&
                         unused.landmarks >= kMinStartLandmarks && window_.newest().nav().T_W_B.translation().allFinite() &&
                         worst_depth_error(window_, depth_scale_) <= config_.depth_factor.gate;
  if (!plausible) {
    std::swap(window_, window);
    return false;
  }
  initialized_ = true;
  buffer_.clear();
  slide();
  return true;
}

void Estimator::append(const EstimatorInput& input) {
  const NavState before = newest();
  Preintegration imu(input.imu, before.bias_gyro, before.bias_accel, noise_);
  NavState state = propagate(before, imu);
  state.t = input.t;
  const StateId id = window_.add_state(to_window_state(state, std::move(imu), input.keyframe));
  window_.add_observations(id, input.observations);
  if (input.keyframe && depth_due(window_)) window_.states.at(id).depth = input.depth;
  if (standstill_.still() && before.v_W.norm() < kMaxStandstillSpeed) {
    window_.soft_priors.push_back(motion_prior({BlockKind::Motion, id}, MotionBlock{},
                                               {config_.zero_velocity_sigma, kFree, kFree}));
  }
}

/// The newest state's depth, if it has one that is believable. True when it has.
bool Estimator::take_depth() {
  std::optional<RegionDepth>& depth = window_.states.rbegin()->second.depth;
  if (!depth) return false;
  const auto error = depth_error_sigmas(window_, window_.states.rbegin()->first, depth_scale_);
  if (!error || *error > config_.depth_factor.gate) depth.reset();
  return depth.has_value();
}

void Estimator::optimize(EstimatorResult& result, int iterations) {
  const bool usable = solve(window_, iterations).usable;
  result.plausible = usable && plausible(newest());
  result.outliers = remove_outliers(window_, config_.landmarks);
  const StateId newest_id = window_.states.rbegin()->first;
  result.landmarks = result.landmarks_seen = 0;
  for (const auto& [id, feature] : window_.features) {
    if (!feature.anchor) continue;
    ++result.landmarks;
    if (feature.last_seen == newest_id) ++result.landmarks_seen;
  }
}

void Estimator::adapt_noise() {
  constexpr double kMedianOfNorm = 1.1774;  // of a two-dimensional unit normal
  for (std::size_t camera = 0; camera < window_.cameras.size(); ++camera) {
    const std::optional<double> median = median_residual(window_, camera);
    if (!median) continue;
    const double wanted = std::max(*median, 1e-3) / kMedianOfNorm * config_.noise_inflation;
    double& scale = window_.noise_scale[camera];
    scale = std::clamp(scale * std::pow(wanted, config_.noise_gain), config_.min_noise_scale, config_.max_noise_scale);
  }
}

void Estimator::slide() {
  // The state that is no longer recent: kept as a keyframe, or its IMU joined to its successor's.
  if (window_.states.size() > static_cast<std::size_t>(config_.recent_states)) {
    const auto aged = std::prev(window_.states.end(), config_.recent_states + 1);
    // At rest new keyframes would push those with a baseline out of the window.
    const double longest_s = config_.max_interval_s * (standstill_.still() ? kRestStretch : 1.0);
    if (!aged->second.keyframe) drop_or_promote(window_, aged->first, longest_s);
  }
  while (static_cast<int>(window_.states.size()) > config_.recent_states + config_.keyframes) {
    drop_oldest_keyframe(window_, config_.landmarks);
  }
  // Tracks that ended before they became landmarks.
  std::erase_if(window_.features, [&](const auto& entry) { return !entry.second.anchor && !window_.alive(entry.second); });
}

}  // namespace edged
