// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/external/external_factors.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "edged/estimator/factors/height_factor.hpp"
#include "edged/estimator/factors/velocity_factor.hpp"
#include "edged/estimator/solver/covariance.hpp"
#include "edged/estimator/solver/sliding.hpp"
#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

// Indices of the sensors in ExternalSample.
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

/// Chi-square test of a measurement against what the window expects. Its covariance is only computed where the
/// measurement's own sigma does not explain the difference.
bool ExternalFactors::passes_gate(const Window& window, const Factor& factor) const {
  const std::optional<Evaluated> found = evaluated(window, factor);
  if (!found) return false;
  const Eigen::VectorXd& r = found->r;
  if (starting_) return r.norm() <= kExternalTuning.start_gate_sigma;
  if (r.norm() <= kExternalTuning.gate_sigma) return true;
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
  return r.dot(S.ldlt().solve(r)) <= kExternalTuning.gate_sigma * kExternalTuning.gate_sigma;
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
  const Preintegration motion = until(imu, sample.t);
  const double sigma = sample.sigma_m > 0.0 ? sample.sigma_m : height_.sigma_m;
  const auto factor = [&](BlockKey bias) {
    return std::make_shared<HeightFactor>(from, bias, motion, sample.height_m, sigma);
  };
  std::optional<BlockKey> bias = window.parameter(BlockKind::HeightBias);
  if (bias && passes_gate(window, *factor(*bias))) {
    height_refused_since_.reset();
    window.add(factor(*bias));
    ++counters_.used[kHeight];
    return;
  }
  if (bias && !height_refused_since_) height_refused_since_ = sample.t;
  if (bias && sample.t - *height_refused_since_ < kExternalTuning.new_level) {
    ++counters_.rejected[kHeight];
    return;
  }
  // The first sample, or the first accepted one after a step of the level.
  if (bias) marginalize_parameter(window, BlockKind::HeightBias);
  height_refused_since_.reset();
  const WindowState& state = window.states().at(from);
  const double level = HeightFactor(from, {BlockKind::HeightBias, 0}, motion, sample.height_m, sigma)
                           .bias_at(state.pose.data(), state.motion.data());
  window.add_parameter(BlockKind::HeightBias, level, {kExternalTuning.level_sigma_m, height_.bias_walk});
  window.add(factor(*window.parameter(BlockKind::HeightBias)));
  ++counters_.used[kHeight];
}

void ExternalFactors::add_sample(Window& window, StateId from, const Preintegration& imu,
                                 const VelocitySample& sample) {
  if (!velocity_.enabled || sample.sigma.array().isInf().all()) return;
  VelocitySample known = sample;
  for (double& sigma : known.sigma) sigma = sigma > 0.0 ? sigma : velocity_.sigma_mps;
  if (!window.parameter(BlockKind::VelocityScale))
    window.add_parameter(BlockKind::VelocityScale, 0.0, {velocity_.scale_sigma, kExternalTuning.velocity_scale_walk});
  auto factor = std::make_shared<VelocityFactor>(from, *window.parameter(BlockKind::VelocityScale),
                                                 until(imu, sample.t), velocity_.T_B_S(), known);
  if (!passes_gate(window, *factor)) {
    ++counters_.rejected[kVelocity];
    return;
  }
  window.add(std::move(factor));
  ++counters_.used[kVelocity];
  velocity_at_ = sample.t;
}

bool ExternalFactors::velocity_observed(Timestamp t) const {
  return velocity_at_ && t - *velocity_at_ <= kExternalTuning.velocity_lasts;
}

}  // namespace edged
