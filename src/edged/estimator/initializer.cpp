// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/initializer.hpp"

#include <spdlog/spdlog.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <numbers>

#include "edged/estimator/covariance.hpp"
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
constexpr double kMaxTiltSigma_deg = 2.0;     // the accelerometer bias by itself makes it 0.9
constexpr double kMaxBiasSigmas = 4.0;        // of the accelerometer bias

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

/// Standard deviation of the logarithm of the scale: of the longest baseline in the window over its length.
double scale_sigma(Window& window) {
  const Eigen::Vector3d origin = window.states.begin()->second.T_W_B().translation();
  const auto baseline = [&](const auto& entry) { return (entry.second.T_W_B().translation() - origin).norm(); };
  const auto farthest = std::max_element(window.states.begin(), window.states.end(), [&](const auto& a, const auto& b) {
    return baseline(a) < baseline(b);
  });
  const std::optional<Matrix15d> P = covariance(window, farthest->first);
  if (!P) return kFree;
  const Eigen::Vector3d way = farthest->second.T_W_B().translation() - origin;
  return std::sqrt(way.dot(P->topLeftCorner<3, 3>() * way)) / way.squaredNorm();
}

/// Standard deviation of the newest state's tilt, of the worst direction [rad].
double tilt_sigma(Window& window) {
  const std::optional<Matrix15d> P = covariance(window, window.states.rbegin()->first);
  if (!P) return kFree;
  const Eigen::Matrix<double, 2, 3> horizontal = window.newest().T_W_B().R().topRows<2>();
  const Eigen::Matrix2d tilt = horizontal * P->block<3, 3>(3, 3) * horizontal.transpose();
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(tilt).eigenvalues()[1]);
}

}  // namespace

StartResult Initializer::add(const EstimatorInput& input, const StandstillDetector& standstill) {
  const bool new_view = buffer_view(input);
  if (standstill.still()) {
    const double gravity = standstill.mean_accel_B().norm();
    if (std::abs(gravity - kGravity) > kMaxGravityError) {
      return {{}, fmt::format("an accelerometer in m/s^2: it reads {:.2f} of 9.81 at rest", gravity)};
    }
    return {start_at_rest(input, standstill), ""};
  }
  if (new_view) {
    StartResult start = start_in_motion();
    if (start.window) return start;
    motion_lacks_ = std::move(start.waiting_for);
  }
  return {{}, fmt::format("rest ({}) or {}", standstill.reason(), motion_lacks_)};
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
  if (buffer_.size() > static_cast<std::size_t>(config_.init_max_views)) make_room();
  return true;
}

/// Slow motion needs time to tell the scale, fast motion close views. Of a full buffer that view goes that is closest to
/// its neighbours for its age, so that views stand the farther apart the older they are.
void Initializer::make_room() {
  const Timestamp newest = buffer_.back().t;
  if (to_seconds(newest - buffer_.front().t) > config_.init_max_span_s) {
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
  buffer_.erase(buffer_.begin() + static_cast<std::ptrdiff_t>(leaves));
}

Window Initializer::start_at_rest(const EstimatorInput& input, const StandstillDetector& standstill) const {
  NavState state;
  state.t = input.t;
  state.T_W_B = SE3(Eigen::Quaterniond::FromTwoVectors(standstill.mean_accel_B(), Eigen::Vector3d::UnitZ()),
                    Eigen::Vector3d::Zero());
  state.bias_gyro = standstill.mean_gyro_B();
  Window window(rig_, config_.cauchy_scale, config_.depth_factor);
  const StateId id = window.add_state(window_state(state, input.imu.back().gyro_B, {}, true));
  window.add_observations(id, input.observations);
  const BlockKey pose{BlockKind::Pose, id}, motion{BlockKind::Motion, id};
  window.soft_priors.push_back(gauge_prior(pose, to_block(state.T_W_B), kGaugeSigma_m, kGaugeSigma_rad));
  // At rest the tilt is as well known as the accelerometer bias: gravity's direction is what was measured.
  LinearPrior tilt;
  tilt.blocks = {pose};
  tilt.x0 = {{window.states.at(id).pose.begin(), window.states.at(id).pose.end()}};
  tilt.J = Eigen::MatrixXd::Zero(2, 6);
  tilt.J.block<2, 3>(0, 3) = state.T_W_B.R().topRows<2>() / (config_.accel_bias_sigma / kGravity);
  tilt.r = Eigen::VectorXd::Zero(2);
  window.soft_priors.push_back(tilt);
  window.soft_priors.push_back(motion_prior(
      motion, motion_block(state), {config_.zero_velocity_sigma, config_.rest_gyro_bias_sigma, config_.accel_bias_sigma}));
  spdlog::info("started at rest at {:.3f} s", to_seconds(input.t));
  return window;
}

StartResult Initializer::start_in_motion() const {
  if (buffer_.size() < static_cast<std::size_t>(config_.init_min_views)) {
    return {{}, fmt::format("{} of {} views in motion", buffer_.size(), config_.init_min_views)};
  }
  const double parallax = median_parallax(buffer_, rig_, noise_) / kDeg;
  if (parallax < config_.init_parallax_deg) {
    return {{}, fmt::format("parallax {:.2f} of {:.2f} deg", parallax, config_.init_parallax_deg)};
  }
  const std::optional<Alignment> alignment = align(buffer_, rig_, noise_, config_.accel_bias_sigma);
  if (!alignment) return {{}, "corners that last for four views"};
  if (std::abs(alignment->gravity_error) > kMaxFreeGravityError) {
    const double seen = kGravity * (1.0 + alignment->gravity_error);
    return {{}, fmt::format("motion that fits gravity: it says {:.2f} of 9.81 m/s^2", seen)};
  }
  if (!(alignment->scale_sigma <= config_.init_scale_sigma)) return {{}, scale_text(alignment->scale_sigma)};
  Window window = aligned_window(*alignment);
  for (int round = 0; round < 3; ++round) {
    triangulate_features(window, config_.landmarks);
    solve(window, kStartIterations);
    remove_outliers(window, config_.landmarks);
  }
  std::string doubt = doubt_about(window);
  if (!doubt.empty()) return {{}, std::move(doubt)};
  spdlog::info("started in motion at {:.3f} s: scale known to {:.1f} %, speed {:.2f} m/s", to_seconds(buffer_.back().t),
               100.0 * scale_sigma(window), window.newest().nav().v_W.norm());
  return {std::move(window), ""};
}

/// What speaks against a solved window, empty when nothing does.
std::string Initializer::doubt_about(Window& window) const {
  const auto landmarks = std::count_if(window.features.begin(), window.features.end(),
                                       [](const auto& entry) { return entry.second.anchor.has_value(); });
  if (landmarks < kMinStartLandmarks) return fmt::format("{} of {} landmarks in motion", landmarks, kMinStartLandmarks);
  const double rms = visual_rms(window);
  if (!(rms <= kMaxStartRms)) {
    return fmt::format("motion that fits the IMU: corners {:.1f} of {:.1f} sigma off", rms, kMaxStartRms);
  }
  const double sigma = scale_sigma(window);
  if (!(sigma <= config_.init_scale_sigma)) return scale_text(sigma);
  const double tilt_deg = tilt_sigma(window) / kDeg;
  if (!(tilt_deg <= kMaxTiltSigma_deg)) {
    return fmt::format("motion that tells gravity: known to {:.1f} deg, {:.1f} wanted", tilt_deg, kMaxTiltSigma_deg);
  }
  const NavState state = window.newest().nav();
  const double most_bias = kMaxBiasSigmas * config_.accel_bias_sigma;
  if (state.bias_accel.norm() > most_bias) {
    const double bias = state.bias_accel.norm();
    return fmt::format("an accelerometer bias one can believe: {:.2f} of {:.2f} m/s^2", bias, most_bias);
  }
  if (worst_depth_error(window, {0.0, config_.depth_factor.scale_sigma}) > config_.depth_factor.gate) {
    return "motion whose scale the depth source agrees with";
  }
  return "";
}

std::string Initializer::scale_text(double sigma) const {
  return fmt::format("motion that tells the scale: known to {:.0f} %, {:.0f} % wanted", 100.0 * std::min(sigma, 9.99),
                     100.0 * config_.init_scale_sigma);
}

/// The buffer's views as keyframes where the alignment puts them.
Window Initializer::aligned_window(const Alignment& alignment) const {
  Window window(rig_, config_.cauchy_scale, config_.depth_factor);
  for (std::size_t i = 0; i < buffer_.size(); ++i) {
    const NavState& nav = alignment.states[i];
    Preintegration imu =
        i == 0 ? Preintegration{} : Preintegration(buffer_[i].imu, nav.bias_gyro, nav.bias_accel, noise_);
    const StateId id = window.add_state(window_state(nav, buffer_[i].imu.back().gyro_B, std::move(imu), true));
    window.add_observations(id, buffer_[i].observations);
    if (depth_due(window)) window.states.at(id).depth = buffer_[i].depth;
  }
  const auto& [first, state] = *window.states.begin();
  window.soft_priors.push_back(gauge_prior({BlockKind::Pose, first}, state.pose, kGaugeSigma_m, kGaugeSigma_rad));
  NavState unbiased = state.nav();
  unbiased.bias_accel.setZero();
  window.soft_priors.push_back(motion_prior({BlockKind::Motion, first}, motion_block(unbiased),
                                            {kFree, config_.gyro_bias_sigma, config_.accel_bias_sigma}));
  return window;
}

}  // namespace edged
