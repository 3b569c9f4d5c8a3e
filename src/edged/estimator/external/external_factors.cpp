// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/external/external_factors.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "edged/estimator/factors/height_factor.hpp"
#include "edged/estimator/factors/velocity_factor.hpp"
#include "edged/estimator/solver/covariance.hpp"
#include "edged/estimator/solver/sliding.hpp"

namespace edged {
namespace {

constexpr double kGate = 4.0;         // [sigma], with the uncertainty of the window included
constexpr double kStartGate = 10.0;   // [sigma], before an initialization is solved
constexpr double kBiasSigma_m = 1e3;  // of the level of a height sensor before its first sample
constexpr Duration kNewLevel =
    std::chrono::milliseconds(1000);  // after this time of rejected heights the level is assumed to have changed
constexpr Duration kObserved = std::chrono::milliseconds(500);  // time for which a velocity sample bounds the drift

// Their places in ExternalSample.
constexpr std::size_t kHeight = 0, kVelocity = 1;

Preintegration until(const Preintegration& imu, Timestamp t) {
  return {slice_imu(imu.samples(), imu.begin(), t), imu.bias_gyro(), imu.bias_accel(), imu.noise()};
}

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Residual of a factor in the window, and its derivatives by its blocks.
struct Evaluated {
  Eigen::VectorXd r;
  std::vector<RowMajorMatrix> J;
};

std::optional<Evaluated> evaluated(const Window& window, const Factor& factor) {
  Evaluated result{Eigen::VectorXd(factor.num_residuals()), {}};
  std::vector<const double*> values;
  std::vector<double*> data;
  for (const BlockKey& key : factor.blocks()) {
    values.push_back(window.block(key));
    result.J.emplace_back(factor.num_residuals(), block_size(key.kind));
  }
  for (RowMajorMatrix& J : result.J) data.push_back(J.data());
  return factor.Evaluate(values.data(), result.r.data(), data.data()) ? std::optional(std::move(result)) : std::nullopt;
}

}  // namespace

/// How far a measurement is from what the window expects. Its covariance is only asked where the measurement's own
/// sigma does not explain the difference.
bool ExternalFactors::believable(const Window& window, const Factor& factor) const {
  const std::optional<Evaluated> found = evaluated(window, factor);
  if (!found) return false;
  const Eigen::VectorXd& r = found->r;
  if (starting_) return r.norm() <= kStartGate;
  if (r.norm() <= kGate) return true;
  const auto P = covariance(window, {factor.blocks().begin(), factor.blocks().end()});
  if (!P) return true;
  Eigen::MatrixXd J(r.size(), P->cols());  // blocks stand in the order of their keys
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < found->J.size(); ++i) {
    const int size = tangent_size(factor.blocks()[i].kind);
    J.middleCols(column, size) = found->J[i].leftCols(size);
    column += size;
  }
  const Eigen::MatrixXd S = Eigen::MatrixXd::Identity(r.size(), r.size()) + J * *P * J.transpose();
  return r.dot(S.ldlt().solve(r)) <= kGate * kGate;
}

void ExternalFactors::add_to_start(Window& window, StateId from, const Preintegration& imu,
                                   std::span<const ExternalSample> samples) {
  starting_ = true;
  add(window, from, imu, samples);
  starting_ = false;
}

void ExternalFactors::add(Window& window, StateId from, const Preintegration& imu,
                          std::span<const ExternalSample> samples) {
  for (const ExternalSample& any : samples) {
    std::visit(
        [&](const auto& sample) {
          if (sample.t >= imu.begin() && sample.t <= imu.end()) add_sample(window, from, imu, sample);
        },
        any);
  }
}

void ExternalFactors::add_sample(Window& window, StateId from, const Preintegration& imu, const HeightSample& sample) {
  if (!height_.enabled) return;
  const Preintegration way = until(imu, sample.t);
  const double sigma = sample.sigma_m > 0.0 ? sample.sigma_m : height_.sigma_m;
  const auto factor = [&](BlockKey bias) {
    return std::make_shared<HeightFactor>(from, bias, way, sample.height_m, sigma);
  };
  std::optional<BlockKey> bias = window.walking(BlockKind::HeightBias);
  if (bias && believable(window, *factor(*bias))) {
    height_refused_since_.reset();
    window.add(factor(*bias));
    ++counters_.used[kHeight];
    return;
  }
  if (bias && !height_refused_since_) height_refused_since_ = sample.t;
  if (bias && sample.t - *height_refused_since_ < kNewLevel) {
    ++counters_.rejected[kHeight];
    return;
  }
  // The first sample, or the first accepted one after a step of the level.
  if (bias) forget_walk(window, BlockKind::HeightBias);
  height_refused_since_.reset();
  const WindowState& state = window.states().at(from);
  const double level = HeightFactor(from, {BlockKind::HeightBias, 0}, way, sample.height_m, sigma)
                           .bias_at(state.pose.data(), state.motion.data());
  window.begin_walk(BlockKind::HeightBias, level, {kBiasSigma_m, height_.bias_walk});
  window.add(factor(*window.walking(BlockKind::HeightBias)));
  ++counters_.used[kHeight];
}

void ExternalFactors::add_sample(Window& window, StateId from, const Preintegration& imu,
                                 const VelocitySample& sample) {
  if (!velocity_.enabled || sample.sigma.array().isInf().all()) return;
  VelocitySample known = sample;
  for (double& sigma : known.sigma) sigma = sigma > 0.0 ? sigma : velocity_.sigma_mps;
  if (!window.walking(BlockKind::VelocityScale))
    window.begin_walk(BlockKind::VelocityScale, 0.0, {velocity_.scale_sigma, velocity_.scale_walk});
  auto factor = std::make_shared<VelocityFactor>(from, *window.walking(BlockKind::VelocityScale), until(imu, sample.t),
                                                 velocity_.T_B_S(), known);
  if (!believable(window, *factor)) {
    ++counters_.rejected[kVelocity];
    return;
  }
  window.add(std::move(factor));
  ++counters_.used[kVelocity];
  velocity_at_ = sample.t;
}

bool ExternalFactors::velocity_observed(Timestamp t) const { return velocity_at_ && t - *velocity_at_ <= kObserved; }

}  // namespace edged
