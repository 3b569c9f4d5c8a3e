// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/initialization/initializer.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>

#include "edged/core/angles.hpp"
#include "edged/core/directions.hpp"
#include "edged/estimator/external/external_factors.hpp"
#include "edged/estimator/solver/covariance.hpp"
#include "edged/estimator/solver/solver.hpp"
#include "edged/estimator/tuning.hpp"
#include "edged/estimator/window/depth_terms.hpp"
#include "edged/estimator/window/landmarks.hpp"

namespace edged {
namespace {

void append_imu(std::vector<ImuSample>& to, const std::vector<ImuSample>& more) {
  // The first sample of a packet repeats the last one of the packet before.
  to.insert(to.end(), more.begin() + (to.empty() || more.empty() ? 0 : 1), more.end());
}

/// Root mean square of the landmarks' residuals in sigmas.
double visual_rms(const Window& window) {
  double sum = 0.0;
  int n = 0;
  for (const auto& [id, feature] : window.features()) {
    if (!feature.anchor) continue;
    const Eigen::Vector3d p_O = window.position(feature);
    for (const auto& [view, seen] : feature.observations) {
      if (view == *feature.anchor) continue;
      const Eigen::Vector3d p_C = window.T_O_C(view).inverse() * p_O;
      sum += std::min((p_C.hnormalized() - window.point(view, seen)).squaredNorm() / (seen.sigma * seen.sigma), 25.0);
      ++n;
    }
  }
  return n == 0 ? std::numeric_limits<double>::infinity() : std::sqrt(sum / (2.0 * n));
}

/// Whether cameras observe enough features together for a start.
bool shares_features(const std::vector<CameraObservations>& observations) {
  std::set<FeatureId> seen;
  std::ptrdiff_t shared = 0;
  for (const CameraObservations& view : observations) {
    for (const FeatureObservation& feature : view.features) shared += seen.insert(feature.id).second ? 0 : 1;
  }
  return shared >= kInitializationTuning.min_landmarks;
}

/// Total angle of the body's rotation over the samples, back and forth both counted [rad].
double turned_rad(const std::vector<ImuSample>& imu) {
  double angle = 0.0;
  for (std::size_t i = 1; i < imu.size(); ++i) angle += imu[i].gyro_B.norm() * to_seconds(imu[i].t - imu[i - 1].t);
  return angle;
}

std::string views_text(int views, int wanted) { return fmt::format("{} of {} views in motion", views, wanted); }

std::string scale_text(double sigma, double most) {
  constexpr double kMost = 9.99;  // also where it is not a number
  return fmt::format("motion that determines the scale: known to {:.0f} %, {:.0f} % required",
                     100.0 * (sigma < kMost ? sigma : kMost), 100.0 * most);
}

/// How well the newest state is known: standard deviations of its tilt [rad] and its velocity [m/s], of the worst
/// direction.
struct StartSigmas {
  double tilt = kFree, velocity = kFree;
};

StartSigmas sigmas_of_newest(const Window& window) {
  const std::optional<Matrix15d> P = covariance(window, window.newest_id());
  if (!P) return {};
  return {tilt_sigma(window.newest().T_O_B().R(), P->block<3, 3>(3, 3)),
          std::sqrt(P->diagonal().segment<3>(6).maxCoeff())};
}

}  // namespace

double scale_sigma(const Window& window) {
  const auto way_of = [](const auto& entry) { return entry.second.T_O_B().translation(); };
  const auto farthest =
      std::max_element(window.states().begin(), window.states().end(),
                       [&](const auto& a, const auto& b) { return way_of(a).norm() < way_of(b).norm(); });
  const std::optional<Matrix15d> P = covariance(window, farthest->first);
  const Eigen::Vector3d way = way_of(*farthest);
  if (!P || way.isZero()) return kFree;
  return std::sqrt(way.dot(P->topLeftCorner<3, 3>() * way)) / way.squaredNorm();
}

InitializationResult Initializer::add(const EstimatorInput& input, const StandstillDetector& rest,
                                      double most_scale_sigma, const OdomState* running) {
  noise_ = input.motion.noise();
  const bool new_view = buffer_view(input);
  if (!since_) since_ = input.motion.begin();
  const bool measured = input.t - *since_ >= kInitializationTuning.noise_measured;
  if (rest.still() && (measured || !rest.vibrates())) {
    const double gravity = rest.mean_accel_B().norm();
    const double by_vibration = kInitializationTuning.gravity_sigmas * rest.mean_accel_sigma(rest.mean_duration_s());
    if (std::abs(gravity - kGravity) > kInitializationTuning.max_gravity_error + by_vibration) {
      return {{}, fmt::format("an accelerometer in m/s^2: it measures {:.2f} of 9.81 at rest", gravity)};
    }
    return {StartWindow{start_at_rest(input, rest)}};
  }
  if (new_view) {
    InitializationResult result = start_in_motion(most_scale_sigma, running);
    if (result.start || running != nullptr) return result;
    missing_in_motion_ = std::move(result.waiting_for);
  }
  return {{}, fmt::format("rest ({}) or {}", rest.reason(), missing_in_motion_)};
}

/// Keeps the input as a view if the next one is due. Returns whether it did.
bool Initializer::buffer_view(const EstimatorInput& input) {
  append_imu(pending_imu_, input.motion.samples());
  pending_external_.insert(pending_external_.end(), input.external.begin(), input.external.end());
  if (to_seconds(input.t - pending_imu_.front().t) > kInitializationTuning.max_pending_imu_s) {
    buffer_.clear();
    pending_imu_ = input.motion.samples();
    pending_external_ = input.external;
  }
  const bool any_feature =
      std::ranges::any_of(input.observations, [](const CameraObservations& view) { return !view.features.empty(); });
  if (!any_feature || !view_due(input)) return false;
  buffer_.push_back({input.t, std::move(pending_imu_), input.observations, input.depth, std::move(pending_external_)});
  pending_imu_.clear();
  pending_external_.clear();
  if (buffer_.size() > static_cast<std::size_t>(kInitializationTuning.max_views)) make_room();
  return true;
}

/// In a fast rotation a feature crosses the view within a tenth of a second, so views must be close.
bool Initializer::view_due(const EstimatorInput& input) const {
  const double spacing_s =
      shares_features(input.observations) ? kInitializationTuning.stereo_spacing_s : kInitializationTuning.spacing_s;
  return buffer_.empty() || input.t - buffer_.back().t >= duration_from_seconds(spacing_s) ||
         turned_rad(pending_imu_) > kInitializationTuning.turn;
}

/// Slow motion needs time to determine the scale, fast motion needs close views. When the buffer is full, the view
/// closest to its neighbours relative to its age is removed, so that older views are farther apart.
void Initializer::make_room() {
  const Timestamp newest = buffer_.back().t;
  if (to_seconds(newest - buffer_.front().t) > kInitializationTuning.max_span_s) {
    buffer_.erase(buffer_.begin());
    return;
  }
  const auto crowding = [&](std::size_t i) {
    return to_seconds(newest - buffer_[i].t) / to_seconds(buffer_[i + 1].t - buffer_[i - 1].t);
  };
  std::size_t leaves = 1;
  for (std::size_t i = 2; i + 1 < buffer_.size(); ++i) {
    if (crowding(i) > crowding(leaves)) leaves = i;
  }
  std::vector<ImuSample>& imu = buffer_[leaves].imu;
  append_imu(imu, buffer_[leaves + 1].imu);
  buffer_[leaves + 1].imu = std::move(imu);
  std::vector<ExternalSample>& external = buffer_[leaves].external;
  external.insert(external.end(), buffer_[leaves + 1].external.begin(), buffer_[leaves + 1].external.end());
  buffer_[leaves + 1].external = std::move(external);
  buffer_.erase(buffer_.begin() + static_cast<std::ptrdiff_t>(leaves));
}

Window Initializer::start_at_rest(const EstimatorInput& input, const StandstillDetector& standstill) const {
  OdomState state;
  state.t = input.t;
  state.T_O_B = SE3(Eigen::Quaterniond::FromTwoVectors(standstill.mean_accel_B(), Eigen::Vector3d::UnitZ()),
                    Eigen::Vector3d::Zero());
  const BiasPrior prior = biases();
  state.bias_gyro = standstill.mean_gyro_B();
  state.bias_accel = prior.accel;
  Window window(rig_, config_.track_noise, config_.depth_factor);
  const StateId id =
      window.add_state(window_state(state, input.motion.samples().back().gyro_B, {}, true), input.observations);
  const WindowState& first = window.newest();
  const BlockKey pose{BlockKind::Pose, id}, motion{BlockKind::Motion, id};
  window.add_soft_prior(gauge_prior(pose, to_block(state.T_O_B), kInitializationTuning.gauge_sigma_m,
                                    kInitializationTuning.gauge_sigma_rad));
  window.add_soft_prior(rest_prior(
      pose, first.pose, motion, first.motion, standstill.mean_accel_B(),
      std::hypot(kInitializationTuning.rest_accel_sigma, standstill.mean_accel_sigma(standstill.mean_duration_s()))));
  window.add_soft_prior(motion_prior(
      motion, motion_block(state),
      {kInitializationTuning.zero_velocity_sigma,
       std::hypot(kInitializationTuning.rest_gyro_bias_sigma, standstill.mean_gyro_sigma(standstill.mean_duration_s())),
       prior.accel_sigma}));
  solve(window, kInitializationTuning.refine_iterations);  // the accelerometer's bias along gravity
  return window;
}

BiasPrior Initializer::biases() const {
  return known_biases_.value_or(BiasPrior{.gyro_sigma = kInitializationTuning.gyro_bias_sigma,
                                          .accel_sigma = kInitializationTuning.accel_bias_sigma});
}

InitializationResult Initializer::start_in_motion(double most_scale_sigma, const OdomState* running) {
  const int wanted = shares_features(buffer_.back().observations) ? kInitializationTuning.stereo_min_views
                                                                  : kInitializationTuning.min_views;
  if (views() < wanted) return {{}, views_text(views(), wanted)};
  const Timestamp now = buffer_.back().t;
  if (now < next_solve_) return {{}, missing_in_motion_};
  InitializationResult result = start_by(External::Unused, most_scale_sigma, running);
  const bool measured = std::ranges::any_of(buffer_, [](const InitFrame& view) { return !view.external.empty(); });
  if (result.start || !measured) return result;
  InitializationResult by_all = start_by(External::Used, most_scale_sigma, running);
  return by_all.start ? std::move(by_all) : std::move(result);
}

InitializationResult Initializer::start_by(External external, double most_scale_sigma, const OdomState* running) {
  const bool velocities = external == External::Used && config_.velocity.enabled;
  const StartPriors priors{biases(), known_biases_.has_value(), velocities ? &config_.velocity : nullptr};
  const std::optional<Alignment> alignment = align(buffer_, rig_, noise_, priors, running);
  if (!alignment) return {{}, "features tracked over three views"};
  InitializationResult result = start_from(*alignment, external, most_scale_sigma);
  result.inlier_share = alignment->inlier_share;
  return result;
}

InitializationResult Initializer::start_from(const Alignment& alignment, External external, double most_scale_sigma) {
  if (std::abs(alignment.gravity_error) > kInitializationTuning.max_free_gravity_error) {
    const double seen = kGravity * (1.0 + alignment.gravity_error);
    return {{}, fmt::format("motion that fits gravity: estimated {:.2f} of 9.81 m/s^2", seen)};
  }
  const bool by_baselines = knows_scale(alignment);
  if (!by_baselines && views() < kInitializationTuning.min_views)
    return {{}, views_text(views(), kInitializationTuning.min_views)};
  if (!by_baselines && !(alignment.scale_sigma <= kInitializationTuning.alignment_slack * most_scale_sigma)) {
    return {{}, scale_text(alignment.scale_sigma, most_scale_sigma)};
  }
  const bool at_each_view = by_baselines && views() <= kInitializationTuning.min_views;
  next_solve_ = buffer_.back().t + (at_each_view ? Duration(0) : kInitializationTuning.solve_every);
  Window window = aligned_window(alignment, external);
  solve_start(window);
  const double sigma = by_baselines ? alignment.baseline_sigma : scale_sigma(window);
  if (!(sigma <= most_scale_sigma)) return {{}, scale_text(sigma, most_scale_sigma)};
  std::string reason =
      by_baselines
          ? rejection_reason(window, kInitializationTuning.max_tilt_sigma_deg, kInitializationTuning.max_speed_sigma)
          : rejection_reason(
                window, kInitializationTuning.max_tilt_sigma_deg * most_scale_sigma / config_.init_scale_sigma, kFree);
  if (!reason.empty()) return {{}, std::move(reason)};
  return {StartWindow{std::move(window), by_baselines, sigma, alignment.outliers}};
}

void Initializer::solve_start(Window& window) const {
  for (int round = 0; round < 3; ++round) {
    triangulate_features(window, config_.landmarks, Tracks::All);
    solve(window, round == 0 ? kInitializationTuning.iterations : kInitializationTuning.refine_iterations);
    if (round == 1) estimate_noise(window);
    remove_outliers(window, config_.landmarks);
  }
}

/// The noise of observations is estimated from their residuals in the solved window.
void Initializer::estimate_noise(Window& window) const {
  for (std::size_t camera = 0; camera < window.cameras().size(); ++camera) {
    const std::optional<double> spread = median_residual(window, camera, Newness::Any);
    if (!spread) continue;
    window.rescale_noise(camera, std::clamp(*spread * kInitializationTuning.noise_inflation,
                                            kInitializationTuning.min_noise, kEstimatorTuning.max_noise_scale));
  }
}

/// The reason to reject a solved window; empty to accept it.
std::string Initializer::rejection_reason(const Window& window, double most_tilt_deg, double most_speed_sigma) const {
  const auto landmarks =
      std::ranges::count_if(window.features(), [](const auto& entry) { return entry.second.anchor.has_value(); });
  if (landmarks < kInitializationTuning.min_landmarks)
    return fmt::format("{} of {} landmarks in motion", landmarks, kInitializationTuning.min_landmarks);
  const double rms = visual_rms(window);
  if (!(rms <= kInitializationTuning.max_rms_sigma)) {
    return fmt::format("motion that fits the IMU: features {:.1f} of {:.1f} sigma off", rms,
                       kInitializationTuning.max_rms_sigma);
  }
  const StartSigmas known = sigmas_of_newest(window);
  const double tilt_deg = known.tilt / kDegree;
  if (!(tilt_deg <= most_tilt_deg)) {
    return fmt::format("motion that determines gravity: known to {:.1f} deg, {:.1f} required", tilt_deg, most_tilt_deg);
  }
  const OdomState state = window.newest().nav();
  const BiasPrior prior = biases();
  const double most_bias = kInitializationTuning.max_bias_sigmas * prior.accel_sigma,
               bias = (state.bias_accel - prior.accel).norm();
  if (bias > most_bias) {
    return fmt::format("a plausible accelerometer bias: {:.2f} of {:.2f} m/s^2", bias, most_bias);
  }
  if (worst_depth_error(window, {0.0, config_.depth_factor.scale_sigma}) > kDepthTuning.gate_sigma) {
    return "motion whose scale the depth source agrees with";
  }
  if (known.velocity <= most_speed_sigma) return "";
  return fmt::format("views that determine the velocity: known to {:.2f} m/s, {:.2f} required", known.velocity,
                     most_speed_sigma);
}

/// The views of the buffer as keyframes at the poses of the alignment.
Window Initializer::aligned_window(const Alignment& alignment, External external) const {
  Window window(rig_, config_.track_noise, config_.depth_factor);
  for (std::size_t i = 0; i < buffer_.size(); ++i) {
    const OdomState& nav = alignment.states[i];
    Preintegration imu =
        i == 0 ? Preintegration{} : Preintegration(buffer_[i].imu, nav.bias_gyro, nav.bias_accel, noise_);
    window.add_state(window_state(nav, buffer_[i].imu.back().gyro_B, std::move(imu), true), buffer_[i].observations);
    if (buffer_[i].depth && depth_due(window)) window.set_depth(*buffer_[i].depth);
  }
  for (const FeatureId id : alignment.outliers) window.remove_feature(id);
  const auto& [first, state] = *window.states().begin();
  window.add_soft_prior(gauge_prior({BlockKind::Pose, first}, state.pose, kInitializationTuning.gauge_sigma_m,
                                    kInitializationTuning.gauge_sigma_rad));
  BiasPrior prior = biases();
  if (!known_biases_) {
    if (knows_scale(alignment)) {
      prior.gyro_sigma = kInitializationTuning.pair_gyro_bias_sigma;
    } else {
      prior.gyro = state.nav().bias_gyro;
    }
  }
  OdomState before = state.nav();
  before.bias_gyro = prior.gyro, before.bias_accel = prior.accel;
  window.add_soft_prior(
      motion_prior({BlockKind::Motion, first}, motion_block(before), {kFree, prior.gyro_sigma, prior.accel_sigma}));
  if (external == External::Unused) return window;
  ExternalFactors factors(config_.height, config_.velocity);
  auto at = window.states().begin();
  for (std::size_t i = 1; i < buffer_.size(); ++i) {
    const StateId from = (at++)->first;
    factors.add_to_start(window, from, at->second.imu, buffer_[i].external);
  }
  return window;
}

}  // namespace edged
