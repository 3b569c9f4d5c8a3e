// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/estimator.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "edged/core/angles.hpp"
#include "edged/core/statistics.hpp"
#include "edged/estimator/solver/covariance.hpp"
#include "edged/estimator/solver/solver.hpp"
#include "edged/estimator/tuning.hpp"
#include "edged/estimator/window/cost.hpp"

namespace edged {
namespace {

/// Biases beyond those of such sensors, a speed beyond the intended use, or values that are not finite.
bool plausible(const OdomState& state) {
  return state.T_O_B.translation().allFinite() && state.v_O.norm() < kEstimatorTuning.max_speed &&
         state.bias_gyro.norm() < kEstimatorTuning.max_gyro_bias &&
         state.bias_accel.norm() < kEstimatorTuning.max_accel_bias;
}

/// Whether two estimates at one instant, each in its own frame, agree on the motion: on the velocity in B.
bool agrees(const OdomState& a, const OdomState& b) {
  const Eigen::Vector3d v_a = a.T_O_B.rotation().conjugate() * a.v_O, v_b = b.T_O_B.rotation().conjugate() * b.v_O;
  return (v_a - v_b).norm() <
         kEstimatorTuning.same_velocity * std::max(v_a.norm(), v_b.norm()) + kEstimatorTuning.same_velocity_mps;
}

bool sees_frames(const Window& window) {
  return std::ranges::any_of(window.cameras(),
                             [](const WindowCamera& camera) { return camera.given.modality == Modality::Frames; });
}

/// Sigma of a camera's observations as they are weighted now, on the unit plane; nothing without any.
std::optional<double> sigma_of(const Window& window, std::size_t camera) {
  for (const auto& [id, feature] : window.features()) {
    const auto seen = feature.last_seen.find(camera);
    if (seen == feature.last_seen.end()) continue;
    const auto observation = feature.observations.find({seen->second, camera});
    if (observation != feature.observations.end()) return observation->second.sigma;
  }
  return std::nullopt;
}

/// The sigma of the most accurate frame camera.
std::optional<double> sigma_of_frames(const Window& window) {
  std::optional<double> least;
  for (std::size_t camera = 0; camera < window.cameras().size(); ++camera) {
    if (window.cameras()[camera].given.modality != Modality::Frames) continue;
    const std::optional<double> sigma = sigma_of(window, camera);
    if (sigma && (!least || *sigma < *least)) least = sigma;
  }
  return least;
}

/// The share of event_noise_inflation that applies.
double share_beside_frames(double events_over_frames) {
  const double all = kEstimatorTuning.full_event_inflation, none = kEstimatorTuning.no_event_inflation;
  return std::clamp(std::log(events_over_frames / none) / std::log(all / none), 0.0, 1.0);
}

/// The observations with the noise that they have while the gyro is saturated.
std::vector<CameraObservations> inflate_during_gyro_saturation(std::vector<CameraObservations> observations) {
  for (CameraObservations& view : observations) {
    for (FeatureObservation& feature : view.features) feature.sigma *= kEstimatorTuning.gyro_saturation_noise;
  }
  return observations;
}

/// Factor on covariances.
double inflation(const Window& window, const EstimatorConfig& config) {
  const double sigmas = config.sigma_inflation * (sees_frames(window) ? 1.0 : kEstimatorTuning.events_alone_inflation);
  return sigmas * sigmas;
}

}  // namespace

Estimator::Estimator(const Rig& rig, const ImuNoise& noise, const EstimatorConfig& config,
                     std::vector<IntrinsicsCorrection> intrinsics, const std::optional<BiasPrior>& biases)
    : config_(config),
      window_(rig, {0.0, 0.0}, config.depth_factor),
      standstill_(config.standstill, noise),
      external_(config.height, config.velocity),
      initializer_(rig, noise, config, biases),
      known_intrinsics_(std::move(intrinsics)),
      depth_scale_{0.0, config.depth_factor.scale_sigma} {}

EstimatorResult Estimator::add(const EstimatorInput& input) {
  EstimatorResult result;
  standstill_.set_noise(input.motion.noise());
  standstill_.add(input.motion.samples(), input.observations, input.events_quiet, gyro_bias(),
                  [&] { return known_motion(input); });
  result.noise_at_rest = standstill_.noise_at_rest();
  if (input.motion.gap_s() > 0.0) supported_at_ = input.t;  // a turn in place is found by the gyro
  const std::optional<FlowVelocity> turning = turning_in_place(input);
  result.turning = turning.has_value();
  result.standstill = standstill_.still() || stationary_by_vision() || result.turning;
  if (start(input, result) || !initialized_) return result;
  append(input, turning);
  result.velocity_observed = external_.velocity_observed(input.t);
  result.outliers = reject_unexpected(window_);
  triangulate_features(window_, config_.landmarks);
  const bool new_depth = add_depth(input);
  window_.relinearise_intrinsics();
  predict_observations(window_);
  optimize(result);
  if (new_depth) depth_scale_ = estimate_scale(window_);
  adapt_noise(result.imu_strain);
  result.marginalized_keyframes = slide();
  update_scale(input);
  result.provisional = provisional();
  return result;
}

/// Initializes, or replaces a provisional initialization. Returns whether it did.
bool Estimator::start(const EstimatorInput& input, EstimatorResult& result) {
  if (initialized_ && !provisional()) return false;
  std::optional<OdomState> running;
  if (initialized_) running = propagate(newest(), since_newest(input));
  const double replacing = confirmed_ ? kEstimatorTuning.better_scale * scale_sigma_ : scale_sigma_;
  const double wanted = initialized_ ? replacing : config_.provisional_scale_sigma;
  InitializationResult found =
      initializer_.add(input, standstill_, std::max(wanted, config_.init_scale_sigma), running ? &*running : nullptr);
  if (found.inlier_share < kEstimatorTuning.min_inlier_share)
    confirmed_at_ = input.t + kEstimatorTuning.confirmation_time;
  result.waiting_for = std::move(found.waiting_for);
  if (!found.start) return false;
  const bool at_rest = found.start->scale_sigma == 0.0;
  confirmed_ =
      at_rest || found.start->by_baselines || (running && agrees(*running, found.start->window.newest().nav()));
  confirmed_at_ = input.t + kEstimatorTuning.confirmation_time;
  adopt(std::move(*found.start), result);
  result.started = at_rest ? "at rest"
                           : fmt::format("in motion: scale known to {:.1f} %, speed {:.2f} m/s", 100.0 * scale_sigma_,
                                         newest().v_O.norm());
  return true;
}

/// Goes on in the window of an initialization.
void Estimator::adopt(StartWindow start, EstimatorResult& result) {
  window_ = std::move(start.window);
  record_ = {};
  supported_at_ = newest().t;
  for (std::size_t camera = 0; camera < known_intrinsics_.size(); ++camera)
    window_.set_intrinsics(camera, known_intrinsics_[camera]);
  scale_sigma_ = start.scale_sigma;
  result.outliers.assign(start.outliers.begin(), start.outliers.end());
  initialized_ = result.new_frame = true;
  if (!provisional()) window_.free_calibration(config_.calibration);
  result.provisional = provisional();
  slide();
}

/// The measurements since a provisional initialization may have determined the scale.
void Estimator::update_scale(const EstimatorInput& input) {
  if (!provisional() || !input.keyframe) return;
  scale_sigma_ = std::min(scale_sigma_, kEstimatorTuning.start_sigma_inflation * scale_sigma(window_));
  confirmed_ = confirmed_ || input.t >= confirmed_at_;
  if (!provisional()) window_.free_calibration(config_.calibration);
}

/// No feature has shown parallax, at rest or because the scene is far, and the image is static: the IMU measures
/// vibrations.
bool Estimator::stationary_by_vision() const {
  return initialized_ && standstill_.image_static() && !landmarks_in_view_ &&
         newest().v_O.norm() < kEstimatorTuning.max_standstill_speed;
}

/// Velocity of a body that has turned without much translation for a while, from features that were followed without a
/// parallax that would tell their depth, if the estimate does not contradict. Nothing otherwise.
std::optional<FlowVelocity> Estimator::turning_in_place(const EstimatorInput& input) const {
  if (!initialized_ || !rotation_measured(window_) || input.t - supported_at_ < kEstimatorTuning.turning_after)
    return std::nullopt;
  std::optional<FlowVelocity> flow = flow_velocity(window_, depth_m_);
  const std::optional<KnownMotion> known = flow ? known_motion(input) : std::nullopt;
  if (!known) return std::nullopt;
  // The gyroscope's bias turns all rays alike.
  flow->sigma = std::max(kEstimatorTuning.turning_sigma, std::hypot(flow->sigma, depth_m_ * known->rate_sigma));
  const double sigma = std::hypot(known->speed_sigma, flow->sigma);
  const double most =
      std::max(kEstimatorTuning.max_standstill_speed, flow->v_O.norm() + kEstimatorTuning.consistent_sigma * sigma);
  return known->speed < most ? flow : std::nullopt;
}

/// The motion predicted to the input by the IMU; its uncertainty is that of the newest state and of the IMU since.
std::optional<KnownMotion> Estimator::known_motion(const EstimatorInput& input) const {
  if (!initialized_) return std::nullopt;
  const std::optional<Matrix15d> P = covariance();
  if (!P) return std::nullopt;
  const Preintegration imu = since_newest(input);
  KnownMotion known;
  known.speed = propagate(newest(), imu).v_O.norm();
  known.speed_sigma =
      std::sqrt(P->diagonal().segment<3>(6).maxCoeff() + imu.covariance().diagonal().segment<3>(3).maxCoeff());
  known.rate_sigma = std::sqrt(P->diagonal().segment<3>(9).maxCoeff() + square(kEstimatorTuning.gyro_bias_drift) +
                               square(input.motion.noise().gyro_noise) / config_.standstill.window_s);
  std::vector<double> depths;
  for (const CameraObservations& view : input.observations)
    for (const FeatureObservation& feature : view.features)
      if (const auto z = depth(feature.id, view.camera)) depths.push_back(*z);
  if (!depths.empty()) known.depth_m = median(std::move(depths));
  return known;
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

StartRecord Estimator::record() const {
  StartRecord all;
  if (!initialized_ || !keeps_record_) return all;
  all = record_;
  all.close(window_);
  return all;
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

void Estimator::append(const EstimatorInput& input, const std::optional<FlowVelocity>& turning) {
  const OdomState before = newest();
  Preintegration imu = since_newest(input);
  OdomState nav = propagate(before, imu);
  nav.t = input.t;
  WindowState state = window_state(nav, input.motion.samples().back().gyro_B, std::move(imu), input.keyframe);
  const bool stationary =
      standstill_.still() && (standstill_.still_by_imu() || before.v_O.norm() < kEstimatorTuning.max_standstill_speed);
  state.stationary = stationary;
  const StateId id = window_.add_state(std::move(state), input.motion.gyro_clipped()
                                                             ? inflate_during_gyro_saturation(input.observations)
                                                             : input.observations);
  external_.add(window_, std::prev(window_.states().find(id))->first, window_.newest().imu, input.external);
  OdomState rest;
  const auto hold_velocity = [&](double sigma, double bias_sigma) {
    window_.add_soft_prior(motion_prior({BlockKind::Motion, id}, motion_block(rest), {sigma, bias_sigma, kFree}));
  };
  if (!stationary && stationary_by_vision()) hold_velocity(kEstimatorTuning.vision_rest_sigma, kFree);
  // The error of the mean velocity lasts: all packets of a second are as good as one.
  if (!stationary && turning) {
    rest.v_O = turning->v_O;
    hold_velocity(turning->sigma / std::sqrt(std::min(1.0, input.motion.dt())), kFree);
  }
  if (!stationary) return;
  rest.bias_gyro = standstill_.mean_gyro_B();
  // The means of successive packets overlap: each packet adds no more than its own samples tell.
  const double bias_sigma = standstill_.still_by_imu() ? std::hypot(kEstimatorTuning.rest_gyro_bias_sigma,
                                                                    standstill_.mean_gyro_sigma(input.motion.dt()))
                                                       : kFree;
  hold_velocity(kInitializationTuning.zero_velocity_sigma, bias_sigma);
}

/// Adds the depth of the input, if one is due and it passes the gate. Returns whether it did.
bool Estimator::add_depth(const EstimatorInput& input) {
  if (!input.keyframe || !input.depth || !depth_due(window_)) return false;
  const auto error = depth_error_sigmas(window_, window_.newest_id(), *input.depth, depth_scale_);
  if (!error || *error > kDepthTuning.gate_sigma) return false;
  window_.set_depth(*input.depth);
  return true;
}

/// While the IMU shakes, residuals that are too large mean that its slow noise is larger than its fast one shows. Then
/// that holds for the whole window. Returns whether the solution is usable.
bool Estimator::solve_window() {
  bool usable = solve(window_, config_.iterations).usable;
  if (standstill_.mean_accel_sigma(1.0) > 0.0) {
    for (int i = 0; i < kEstimatorTuning.noise_rounds && usable && raise_imu_noise(); ++i)
      usable = solve(window_, config_.iterations).usable;
  } else if (window_.imu_noise_scale() != 1.0) {
    window_.set_imu_noise_scale(1.0);
  }
  return usable;
}

/// Adapts the IMU's noise to its residuals: at once to larger ones, slowly to smaller ones. Returns whether it rose.
bool Estimator::raise_imu_noise() {
  const double over = imu_strain(window_) / kEstimatorTuning.shaking_strain, before = window_.imu_noise_scale();
  const double scale = before * (over > 1.0 ? over : std::pow(over, kEstimatorTuning.noise_gain));
  window_.set_imu_noise_scale(std::clamp(scale, 1.0, kEstimatorTuning.max_imu_noise_scale));
  return window_.imu_noise_scale() > before;
}

void Estimator::optimize(EstimatorResult& result) {
  const bool usable = solve_window();
  result.plausible = usable && plausible(newest());
  const std::vector<FeatureId> outliers = remove_outliers(window_, config_.landmarks);
  result.outliers.insert(result.outliers.end(), outliers.begin(), outliers.end());
  result.imu_strain = imu_strain(window_);
  const StateId newest_id = window_.newest_id();
  result.landmarks.clear();
  result.landmarks_seen = 0;
  std::vector<double> depths_m;
  for (const auto& [id, feature] : window_.features()) {
    if (!feature.anchor) continue;
    result.landmarks.push_back({id, window_.position(feature)});
    if (feature.inverse_depth > 0.0) depths_m.push_back(1.0 / feature.inverse_depth);
    if (std::ranges::any_of(feature.last_seen, [&](const auto& seen) { return seen.second == newest_id; })) {
      ++result.landmarks_seen;
    }
  }
  if (depths_m.size() >= kStandstillTuning.min_features) depth_m_ = median(std::move(depths_m));
  landmarks_in_view_ = result.landmarks_seen > 0;
  if (result.landmarks_seen >= kEstimatorTuning.min_supporting || standstill_.still()) supported_at_ = newest().t;
}

/// Adapts the noise of each camera to its residuals. A large IMU strain means that the cameras agree on a wrong motion:
/// that of a dynamic object, or errors in common. On event frames the innovations of the observations show less of the
/// drift than on frames: the drift continues with the appearance of an edge under the motion. Beside frames, which do
/// not drift like that, events get a lower weight, unless these are far less accurate: in the dark.
void Estimator::adapt_noise(double imu_strain) {
  const double strain_inflation =
      std::pow(std::max(1.0, imu_strain / kEstimatorTuning.max_imu_strain), kEstimatorTuning.strain_gain);
  const std::optional<double> frames = sigma_of_frames(window_);
  for (std::size_t camera = 0; camera < window_.cameras().size(); ++camera) {
    const std::optional<double> spread = median_residual(window_, camera);
    if (!spread) continue;
    double wanted = std::max(*spread, 1e-3) * config_.noise_inflation;
    if (frames && window_.cameras()[camera].given.modality == Modality::Events) {
      const double alone = wanted * sigma_of(window_, camera).value_or(*frames);
      wanted *= std::pow(config_.event_noise_inflation, share_beside_frames(alone / *frames));
    }
    const double scale =
        window_.cameras()[camera].noise_scale * std::pow(wanted, kEstimatorTuning.noise_gain) * strain_inflation;
    window_.set_noise_scale(camera,
                            std::clamp(scale, kEstimatorTuning.min_noise_scale, kEstimatorTuning.max_noise_scale));
  }
}

std::vector<MarginalizedKeyframe> Estimator::slide() {
  std::vector<MarginalizedKeyframe> marginalized_keyframes;
  // The oldest of the newest states: kept as a keyframe, or dropped with its IMU interval joined to the next.
  if (window_.states().size() > static_cast<std::size_t>(config_.recent_states)) {
    const auto aged = std::prev(window_.states().end(), config_.recent_states + 1);
    if (!aged->second.keyframe) drop_or_promote(window_, aged->first, config_.max_interval_s);
  }
  while (static_cast<int>(window_.states().size()) > config_.recent_states + config_.keyframes) {
    marginalized_keyframes.push_back(
        drop_oldest_keyframe(window_, config_.landmarks, keeps_record_ ? &record_ : nullptr));
  }
  window_.remove_ended_tracks();
  return marginalized_keyframes;
}

}  // namespace edged
