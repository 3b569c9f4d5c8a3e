// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/initializer.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>
#include <numbers>

#include "edged/estimator/depth_terms.hpp"
#include "edged/estimator/solver.hpp"

namespace edged {
namespace {

constexpr double kDeg = std::numbers::pi / 180.0;
constexpr double kGaugeSigma_m = 1e-4, kGaugeSigma_rad = 1e-4;
constexpr int kStartIterations = 25;
constexpr std::ptrdiff_t kMinStartLandmarks = 15;
constexpr double kMaxGravityError = 1.0;      // [m/s^2] of the mean acceleration at rest
constexpr double kMaxFreeGravityError = 0.3;  // of a start in motion, when gravity's length is left free
constexpr double kMaxPendingImu_s = 10.0;     // without an image before the start
constexpr double kMaxStartRms = 2.0;          // [sigma] of the start-up window's sights: more is a wrong start

void append_imu(std::vector<ImuSample>& to, const std::vector<ImuSample>& more) {
  // The first sample of a packet repeats the last one of the packet before.
  to.insert(to.end(), more.begin() + (to.empty() || more.empty() ? 0 : 1), more.end());
}

/// Root mean square of the landmarks' residuals in sigmas.
double visual_rms(const Window& window) {
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
  return n == 0 ? std::numeric_limits<double>::infinity() : std::sqrt(sum / (2.0 * n));
}

}  // namespace

StartResult Initializer::add(const EstimatorInput& input, const StandstillDetector& standstill) {
  const bool new_view = buffer_view(input);
  if (standstill.still()) {
    const double gravity = standstill.mean_accel_B().norm();
    if (std::abs(gravity - 9.81) > kMaxGravityError) {
      return {{}, fmt::format("an accelerometer in m/s^2: it reads {:.2f} of 9.81 at rest", gravity)};
    }
    return {start_at_rest(input, standstill), ""};
  }
  const std::string not_rest = "rest (" + standstill.reason() + ")";
  if (buffer_.size() < static_cast<std::size_t>(config_.init_min_views)) {
    return {{}, fmt::format("{} or {} of {} views in motion", not_rest, buffer_.size(), config_.init_min_views)};
  }
  const double parallax = median_parallax(buffer_, rig_, noise_) / kDeg;
  if (parallax < config_.init_parallax_deg) {
    return {{}, fmt::format("{} or parallax {:.2f} of {:.2f} deg", not_rest, parallax, config_.init_parallax_deg)};
  }
  if (!new_view) return {{}, "the next view"};
  std::optional<Window> window = start_in_motion();
  if (!window) return {{}, fmt::format("motion that fits the IMU (parallax {:.2f} deg)", parallax)};
  return {std::move(window), ""};
}

/// Keeps the input as a view when it is time for the next. True when it was.
bool Initializer::buffer_view(const EstimatorInput& input) {
  append_imu(pending_imu_, input.imu);
  if (to_seconds(input.t - pending_imu_.front().t) > kMaxPendingImu_s) {
    buffer_.clear();
    pending_imu_ = input.imu;
  }
  const bool any_corner = std::any_of(input.observations.begin(), input.observations.end(),
                                      [](const CameraObservations& view) { return !view.features.empty(); });
  const Duration spacing = duration_from_seconds(config_.init_spacing_s);
  if (!any_corner || (!buffer_.empty() && input.t - buffer_.back().t < spacing)) return false;
  buffer_.push_back({input.t, std::move(pending_imu_), input.observations, input.depth});
  pending_imu_.clear();
  if (buffer_.size() > static_cast<std::size_t>(config_.init_max_views)) buffer_.erase(buffer_.begin());
  return true;
}

Window Initializer::start_at_rest(const EstimatorInput& input, const StandstillDetector& standstill) const {
  NavState state;
  state.t = input.t;
  state.T_W_B = SE3(Eigen::Quaterniond::FromTwoVectors(standstill.mean_accel_B(), Eigen::Vector3d::UnitZ()),
                    Eigen::Vector3d::Zero());
  state.bias_gyro = standstill.mean_gyro_B();
  Window window(rig_, config_.cauchy_scale, config_.depth_factor);
  const StateId id = window.add_state(window_state(state, {}, true));
  window.add_observations(id, input.observations);
  const BlockKey pose{BlockKind::Pose, id}, motion{BlockKind::Motion, id};
  window.soft_priors.push_back(gauge_prior(pose, to_block(state.T_W_B), kGaugeSigma_m, kGaugeSigma_rad));
  // At rest the tilt is as well known as the accelerometer bias: gravity's direction is what was measured.
  LinearPrior tilt;
  tilt.blocks = {pose};
  tilt.x0 = {{window.states.at(id).pose.begin(), window.states.at(id).pose.end()}};
  tilt.J = Eigen::MatrixXd::Zero(2, 6);
  tilt.J.block<2, 3>(0, 3) = state.T_W_B.R().topRows<2>() / (config_.accel_bias_sigma / 9.81);
  tilt.r = Eigen::VectorXd::Zero(2);
  window.soft_priors.push_back(tilt);
  window.soft_priors.push_back(motion_prior(
      motion, motion_block(state), {config_.zero_velocity_sigma, config_.rest_gyro_bias_sigma, config_.accel_bias_sigma}));
  spdlog::info("started at rest at {:.3f} s", to_seconds(input.t));
  return window;
}

std::optional<Window> Initializer::start_in_motion() const {
  const std::optional<Alignment> alignment = align(buffer_, rig_, noise_);
  if (!alignment) return std::nullopt;
  Window window = aligned_window(*alignment);
  for (int round = 0; round < 3; ++round) {
    triangulate_features(window, config_.landmarks);
    solve(window, kStartIterations);
    remove_outliers(window, config_.landmarks);
  }
  const auto landmarks = std::count_if(window.features.begin(), window.features.end(),
                                       [](const auto& entry) { return entry.second.anchor.has_value(); });
  const double rms = visual_rms(window);
  spdlog::info("start in motion: {} landmarks, rms {:.2f} sigma, gravity error {:.2f}, speed {:.2f} m/s", landmarks, rms,
               alignment->gravity_error, window.newest().nav().v_W.norm());
  const bool plausible = rms <= kMaxStartRms && std::abs(alignment->gravity_error) < kMaxFreeGravityError &&
                         landmarks >= kMinStartLandmarks && window.newest().nav().T_W_B.translation().allFinite() &&
                         worst_depth_error(window, {0.0, config_.depth_factor.scale_sigma}) <= config_.depth_factor.gate;
  if (!plausible) return std::nullopt;
  return window;
}

/// The buffer's views as keyframes where the alignment puts them.
Window Initializer::aligned_window(const Alignment& alignment) const {
  Window window(rig_, config_.cauchy_scale, config_.depth_factor);
  for (std::size_t i = 0; i < buffer_.size(); ++i) {
    const NavState& nav = alignment.states[i];
    Preintegration imu =
        i == 0 ? Preintegration{} : Preintegration(buffer_[i].imu, nav.bias_gyro, nav.bias_accel, noise_);
    const StateId id = window.add_state(window_state(nav, std::move(imu), true));
    window.add_observations(id, buffer_[i].observations);
    if (depth_due(window)) window.states.at(id).depth = buffer_[i].depth;
  }
  const auto& [first, state] = *window.states.begin();
  window.soft_priors.push_back(gauge_prior({BlockKind::Pose, first}, state.pose, kGaugeSigma_m, kGaugeSigma_rad));
  window.soft_priors.push_back(motion_prior({BlockKind::Motion, first}, state.motion,
                                            {kFree, config_.gyro_bias_sigma, config_.accel_bias_sigma}));
  return window;
}

}  // namespace edged
