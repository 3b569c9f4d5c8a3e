// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/estimator.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "edged/estimator/solver/covariance.hpp"
#include "edged/estimator/solver/sliding.hpp"
#include "edged/estimator/solver/solver.hpp"
#include "edged/estimator/window/cost.hpp"

namespace edged {
namespace {

constexpr double kMaxSpeed = 60.0, kMaxGyroBias = 0.5, kMaxAccelBias = 3.0;  // [m/s], [rad/s], [m/s^2]
constexpr double kDoubtGain = 0.25;                                          // a packet
constexpr double kSameVelocity = 0.25,
                 kSameVelocity_mps = 0.03;  // of two initializations that agree: relative, and [m/s] absolute
constexpr Duration kUncontradicted =
    std::chrono::milliseconds(1000);  // after this time an initialization needs no second one
// An initialization whose support is below this share of that of another motion follows a dynamic object.
constexpr double kContradicted = 0.65;
constexpr double kBetterStart = 0.8;  // an initialization replaces another if its scale is more certain by this factor
constexpr double kStartSigmaInflation = 1.5;  // of the information since the initialization
// [m/s]: a body that is faster by the estimate is not at rest, unless the IMU alone detects a standstill.
constexpr double kMaxStandstillSpeed = 0.15;
// [m/s]: of a body at rest by its image alone, near the estimate.
constexpr double kImageVelocitySigma = 0.05;
// [rad/s], where the IMU alone detects a standstill: a body at rest turns no faster, so the gyro measures its bias.
constexpr double kRestGyroBiasSigma = 5e-4;
// Times an observation's sigma, where the gyro is saturated: images blur, features are tracked without its prediction,
// and errors common to an image, which the gyro otherwise outweighs, rotate the estimate.
constexpr double kUnseenTurnNoise = 6.0;

/// Biases beyond those of such sensors, a speed beyond the intended use, or values that are not finite.
bool plausible(const OdomState& state) {
  return state.T_O_B.translation().allFinite() && state.v_O.norm() < kMaxSpeed &&
         state.bias_gyro.norm() < kMaxGyroBias && state.bias_accel.norm() < kMaxAccelBias;
}

/// Whether two estimates at one instant, each in its own frame, agree on the motion: on the velocity in B.
bool agrees(const OdomState& a, const OdomState& b) {
  const Eigen::Vector3d v_a = a.T_O_B.rotation().conjugate() * a.v_O, v_b = b.T_O_B.rotation().conjugate() * b.v_O;
  return (v_a - v_b).norm() < kSameVelocity * std::max(v_a.norm(), v_b.norm()) + kSameVelocity_mps;
}

bool sees_frames(const Window& window) {
  return std::ranges::any_of(window.cameras(),
                             [](const WindowCamera& camera) { return camera.given.modality == Modality::Frames; });
}

/// Of a camera's observations as they are weighted now, on the unit plane; nothing without any.
std::optional<double> sigma_of(const Window& window, std::size_t camera) {
  for (const auto& [id, feature] : window.features()) {
    const auto seen = feature.last_seen.find(camera);
    if (seen == feature.last_seen.end()) continue;
    const auto observation = feature.observations.find({seen->second, camera});
    if (observation != feature.observations.end()) return observation->second.sigma;
  }
  return std::nullopt;
}

/// Of the most accurate frame camera.
std::optional<double> sigma_of_frames(const Window& window) {
  std::optional<double> least;
  for (std::size_t camera = 0; camera < window.cameras().size(); ++camera) {
    if (window.cameras()[camera].given.modality != Modality::Frames) continue;
    const std::optional<double> sigma = sigma_of(window, camera);
    if (sigma && (!least || *sigma < *least)) least = sigma;
  }
  return least;
}

/// Share of event_noise_inflation: all of it down to half of the sigma of frames, none of it from a fifth on.
double share_beside_frames(double events_over_frames) {
  constexpr double kAll = 1.0 / 2.0, kNone = 1.0 / 5.0;
  return std::clamp(std::log(events_over_frames / kNone) / std::log(kAll / kNone), 0.0, 1.0);
}

/// The observations, with the noise that they have while the gyro is saturated.
std::vector<CameraObservations> of_unseen_turn(std::vector<CameraObservations> observations) {
  for (CameraObservations& view : observations) {
    for (FeatureObservation& feature : view.features) feature.sigma *= kUnseenTurnNoise;
  }
  return observations;
}

/// Of covariances.
double inflation(const Window& window, const EstimatorConfig& config) {
  const double sigmas = config.sigma_inflation * (sees_frames(window) ? 1.0 : kEventsAloneInflation);
  return sigmas * sigmas;
}

}  // namespace

Estimator::Estimator(const Rig& rig, const ImuNoise& noise, const EstimatorConfig& config,
                     std::vector<IntrinsicsCorrection> intrinsics, const std::optional<BiasPrior>& biases)
    : noise_(noise),
      config_(config),
      window_(rig, config.cauchy_scale, config.depth_factor),
      standstill_(config.standstill),
      external_(config.height, config.velocity),
      initializer_(rig, noise, config, biases),
      known_intrinsics_(std::move(intrinsics)),
      depth_scale_{0.0, config.depth_factor.scale_sigma} {}

EstimatorResult Estimator::add(const EstimatorInput& input) {
  EstimatorResult result;
  standstill_.add(input.motion.samples(), input.observations, input.events_quiet, gyro_bias());
  result.standstill = standstill_.still() || rests_by_image();
  if (start(input, result) || !initialized_) return result;
  append(input);
  result.velocity_observed = external_.velocity_observed(input.t);
  result.outliers = reject_unexpected(window_, config_.landmarks);
  triangulate_features(window_, config_.landmarks);
  const bool new_depth = take_depth(input);
  window_.relinearise_intrinsics();
  predict_observations(window_);
  optimize(result, config_.iterations);
  if (new_depth) depth_scale_ = estimate_scale(window_);
  adapt_noise(result.imu_strain);
  result.marginalized_keyframes = slide();
  update_scale(input);
  result.provisional = provisional();
  return result;
}

/// Initializes, or replaces a provisional initialization. True if it did.
bool Estimator::start(const EstimatorInput& input, EstimatorResult& result) {
  if (initialized_ && !provisional()) return false;
  const double wanted = !initialized_ ? config_.provisional_scale_sigma : (agreed_ ? kBetterStart : 1.0) * scale_sigma_;
  const std::optional<OdomState> now =
      initialized_ ? std::optional(propagate(newest(), since_newest(input))) : std::nullopt;
  StartResult found = initializer_.add(input, now ? nullptr : &standstill_, std::max(wanted, config_.init_scale_sigma),
                                       now ? &*now : nullptr);
  if (found.explained < kContradicted) agreed_by_itself_ = input.t + kUncontradicted;
  result.waiting_for = std::move(found.waiting_for);
  if (!found.start) return false;
  const bool at_rest = found.start->scale_sigma == 0.0;
  agreed_ = at_rest || found.start->by_baselines || (now && agrees(*now, found.start->window.newest().nav()));
  agreed_by_itself_ = input.t + kUncontradicted;
  window_ = std::move(found.start->window);
  for (std::size_t camera = 0; camera < known_intrinsics_.size(); ++camera)
    window_.set_intrinsics(camera, known_intrinsics_[camera]);
  scale_sigma_ = found.start->scale_sigma;
  result.outliers.assign(found.start->outliers.begin(), found.start->outliers.end());
  result.started = at_rest ? "at rest"
                           : fmt::format("in motion: scale known to {:.1f} %, speed {:.2f} m/s", 100.0 * scale_sigma_,
                                         newest().v_O.norm());
  initialized_ = result.new_frame = true;
  if (!provisional()) window_.free_calibration(config_.calibration);
  result.provisional = provisional();
  slide();
  return true;
}

/// The measurements since a provisional initialization may have determined the scale.
void Estimator::update_scale(const EstimatorInput& input) {
  if (!provisional() || !input.keyframe) return;
  scale_sigma_ = std::min(scale_sigma_, kStartSigmaInflation * scale_sigma(window_));
  agreed_ = agreed_ || input.t >= agreed_by_itself_;
  if (!provisional()) window_.free_calibration(config_.calibration);
}

/// No feature has shown parallax, at rest or because the scene is far, and the image is static: the IMU measures
/// vibrations.
bool Estimator::rests_by_image() const {
  return initialized_ && standstill_.image_static() && !sees_landmarks_ && newest().v_O.norm() < kMaxStandstillSpeed;
}

Preintegration Estimator::since_newest(const EstimatorInput& input) const {
  const OdomState from = newest();
  const bool same = input.motion.bias_gyro() == from.bias_gyro && input.motion.bias_accel() == from.bias_accel;
  return same ? input.motion : input.motion.reintegrated(from.bias_gyro, from.bias_accel);
}

Eigen::Vector3d Estimator::gyro_bias() const { return initialized_ ? newest().bias_gyro : Eigen::Vector3d::Zero(); }

std::optional<Matrix15d> Estimator::covariance() const {
  if (!initialized_) return std::nullopt;
  std::optional<Matrix15d> P = edged::covariance(window_, window_.newest_id());
  if (P) *P *= inflation(window_, config_);
  return P;
}

std::optional<CalibrationCovariance> Estimator::calibration_covariance(std::size_t camera) const {
  if (!initialized_) return std::nullopt;
  const auto P = edged::covariance(window_, {{BlockKind::Calibration, camera}});
  return P ? std::optional<CalibrationCovariance>(*P * inflation(window_, config_)) : std::nullopt;
}

std::optional<double> Estimator::depth(FeatureId id, const std::string& camera) const {
  const auto found = window_.features().find(id);
  if (found == window_.features().end() || !found->second.anchor) return std::nullopt;
  const ObservationKey view{window_.newest_id(), window_.camera_index(camera)};
  const double z = (window_.T_O_C(view).inverse() * window_.position(found->second)).z();
  return z > config_.landmarks.min_depth_m ? std::optional(z) : std::nullopt;
}

std::optional<LogScale> Estimator::depth_scale() const {
  return config_.depth_factor.enabled ? std::optional(depth_scale_) : std::nullopt;
}

void Estimator::append(const EstimatorInput& input) {
  const OdomState before = newest();
  Preintegration imu = since_newest(input);
  OdomState nav = propagate(before, imu);
  nav.t = input.t;
  WindowState state = window_state(nav, input.motion.samples().back().gyro_B, std::move(imu), input.keyframe);
  const bool rested = standstill_.still_by_imu() || (standstill_.still() && before.v_O.norm() < kMaxStandstillSpeed);
  state.rested = rested;
  const StateId id = input.motion.gyro_clipped()
                         ? window_.add_state(std::move(state), of_unseen_turn(input.observations))
                         : window_.add_state(std::move(state), input.observations);
  external_.add(window_, std::prev(window_.states().find(id))->first, window_.newest().imu, input.external);
  OdomState rest;
  if (!rested && rests_by_image())
    window_.add_soft_prior(
        motion_prior({BlockKind::Motion, id}, motion_block(rest), {kImageVelocitySigma, kFree, kFree}));
  if (!rested) return;
  rest.bias_gyro = standstill_.mean_gyro_B();
  const double bias_sigma = standstill_.still_by_imu() ? kRestGyroBiasSigma : kFree;
  window_.add_soft_prior(
      motion_prior({BlockKind::Motion, id}, motion_block(rest), {config_.zero_velocity_sigma, bias_sigma, kFree}));
}

/// Adds the depth of the input, if one is due and it passes the gate. True if it is in the window.
bool Estimator::take_depth(const EstimatorInput& input) {
  if (!input.keyframe || !input.depth || !depth_due(window_)) return false;
  const auto error = depth_error_sigmas(window_, window_.newest_id(), *input.depth, depth_scale_);
  if (!error || *error > config_.depth_factor.gate) return false;
  window_.set_depth(*input.depth);
  return true;
}

void Estimator::optimize(EstimatorResult& result, int iterations) {
  const bool usable = solve(window_, iterations).usable;
  result.plausible = usable && plausible(newest());
  const std::vector<FeatureId> outliers = remove_outliers(window_, config_.landmarks);
  result.outliers.insert(result.outliers.end(), outliers.begin(), outliers.end());
  result.imu_strain = imu_strain(window_);
  const StateId newest_id = window_.newest_id();
  result.landmarks.clear();
  result.landmarks_seen = 0;
  for (const auto& [id, feature] : window_.features()) {
    if (!feature.anchor) continue;
    result.landmarks.push_back({id, window_.position(feature)});
    if (std::ranges::any_of(feature.last_seen, [&](const auto& seen) { return seen.second == newest_id; })) {
      ++result.landmarks_seen;
    }
  }
  sees_landmarks_ = result.landmarks_seen > 0;
}

/// Adapts the noise of each camera to its residuals. A large IMU strain means that the cameras agree on a wrong motion:
/// that of a dynamic object, or errors in common. On event frames the innovations of the observations show less of the
/// drift than on frames: the drift continues with the appearance of an edge under the motion. Beside frames, which do
/// not drift like that, events get a lower weight, unless these are far less accurate: in the dark.
void Estimator::adapt_noise(double imu_strain) {
  const double doubt = std::pow(std::max(1.0, imu_strain / config_.max_imu_strain), kDoubtGain);
  const std::optional<double> frames = sigma_of_frames(window_);
  for (std::size_t camera = 0; camera < window_.cameras().size(); ++camera) {
    const std::optional<double> spread = median_residual(window_, camera);
    if (!spread) continue;
    double wanted = std::max(*spread, 1e-3) * config_.noise_inflation;
    if (frames && window_.cameras()[camera].given.modality == Modality::Events) {
      const double alone = wanted * sigma_of(window_, camera).value_or(*frames);
      wanted *= std::pow(config_.event_noise_inflation, share_beside_frames(alone / *frames));
    }
    const double scale = window_.cameras()[camera].noise_scale * std::pow(wanted, config_.noise_gain) * doubt;
    window_.set_noise_scale(camera, std::clamp(scale, config_.min_noise_scale, config_.max_noise_scale));
  }
}

std::vector<KeyframeRecord> Estimator::slide() {
  std::vector<KeyframeRecord> marginalized_keyframes;
  // The oldest of the newest states: kept as a keyframe, or dropped with its IMU interval joined to the next.
  if (window_.states().size() > static_cast<std::size_t>(config_.recent_states)) {
    const auto aged = std::prev(window_.states().end(), config_.recent_states + 1);
    if (!aged->second.keyframe) drop_or_promote(window_, aged->first, config_.max_interval_s);
  }
  while (static_cast<int>(window_.states().size()) > config_.recent_states + config_.keyframes) {
    marginalized_keyframes.push_back(drop_oldest_keyframe(window_, config_.landmarks));
  }
  window_.forget_ended_tracks();
  return marginalized_keyframes;
}

}  // namespace edged
