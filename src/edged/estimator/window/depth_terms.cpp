// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/depth_terms.hpp"

#include <algorithm>
#include <cmath>

#include "edged/estimator/factors/depth_factor.hpp"
#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

struct Middle {
  std::vector<FeatureId> landmarks;  ///< around the median
  double mean_ln = 0.0;              ///< mean of their ln 1/z
  std::size_t in_region = 0;
};

SE3 T_B_E(const Window& window, const RegionDepth& depth) {
  return window.cameras()[window.camera_index(depth.camera)].T_B_C();
}

/// The landmarks that the state observes in the region, those of medium depth; nothing if they are too few.
std::optional<Middle> middle_landmarks(const Window& window, StateId state, const RegionDepth& region) {
  const SE3 T_E_O = (window.states().at(state).T_O_B() * T_B_E(window, region)).inverse();
  std::vector<std::pair<double, FeatureId>> seen;  // ln 1/z
  for (const auto& [id, feature] : window.features()) {
    if (!feature.anchor || !feature.seen_at(state) || feature.inverse_depth <= 0.0) continue;
    const Eigen::Vector3d p_E = T_E_O * window.position(feature);
    if (p_E.z() * feature.inverse_depth < kDepthTuning.min_depth_share) continue;
    const Eigen::Array2d point = p_E.hnormalized();
    if ((point >= region.low.array()).all() && (point <= region.high.array()).all()) {
      seen.emplace_back(-std::log(p_E.z()), id);
    }
  }
  if (seen.size() < static_cast<std::size_t>(kDepthTuning.min_landmarks)) return std::nullopt;
  std::sort(seen.begin(), seen.end());
  const std::size_t n = std::min((seen.size() + 1) / 2, kDepthTuning.max_landmarks), begin = (seen.size() - n) / 2;
  Middle middle;
  middle.in_region = seen.size();
  for (std::size_t i = begin; i < begin + n; ++i) {
    middle.landmarks.push_back(seen[i].second);
    middle.mean_ln += seen[i].first / static_cast<double>(n);
  }
  return middle;
}

/// Standard deviation of the residual in logarithms, without s: the time-varying error of the source, and the sampling
/// error of so many landmarks of the region (docs/math.md, D4).
double sigma_ln(const RegionDepth& depth, std::size_t landmarks) {
  const double sampling = 1.25 * depth.spread_ln / std::sqrt(static_cast<double>(landmarks));
  return std::max(kDepthTuning.min_sigma_ln, std::hypot(kDepthTuning.noise_share * depth.sigma_ln, sampling));
}

std::shared_ptr<const Factor> depth_factor(const Window& window, StateId state, const Middle& middle) {
  const RegionDepth& depth = *window.states().at(state).depth;
  const BlockKey scale = *window.parameter(BlockKind::LogScale);
  std::vector<DepthLandmark> landmarks;
  for (const FeatureId id : middle.landmarks) {
    const Feature& feature = window.features().at(id);
    const ObservationKey& anchor = *feature.anchor;
    landmarks.push_back({id, window.cameras()[anchor.camera].T_B_C(),
                         window.point(anchor, feature.observations.at(anchor)), anchor.state});
  }
  double weight = 1.0 / sigma_ln(depth, middle.in_region);
  // The paper's residual is in 1/m; its error is relative to s rho, at the present solution.
  if (window.depth_config().form == DepthResidual::Paper) weight *= depth.depth_m / std::exp(*window.block(scale));
  const DepthMeasurement measured{window.depth_config().form, state, T_B_E(window, depth), depth.depth_m, weight};
  return std::make_shared<DepthFactor>(measured, scale, std::move(landmarks));
}

}  // namespace

void DepthFactorConfig::visit(ConfigFields& fields) {
  fields.add("enabled", enabled,
             {.effect = "Add factors between the median landmark depth and the network's depth, with an estimated "
                        "scale s (paper Eq. 5)."});
  fields.choice("form", form, {{"log", DepthResidual::Log}, {"paper", DepthResidual::Paper}},
                {.effect = "Residual: difference of logarithms, or of inverse depths as in the paper."});
  fields.add("scale_sigma", scale_sigma, {"", 0.001, 10, "Prior uncertainty of ln s."});
}

bool depth_due(const Window& window) {
  if (!window.depth_config().enabled) return false;
  const Timestamp before = window.newest().t - duration_from_seconds(kDepthTuning.min_interval_s);
  return std::ranges::none_of(window.states(),
                              [&](const auto& state) { return state.second.depth && state.second.t > before; });
}

void add_depth_factors(const Window& window, std::vector<std::shared_ptr<const Factor>>& out) {
  for (const auto& [id, state] : window.states()) {
    if (!state.depth) continue;
    const auto middle = middle_landmarks(window, id, *state.depth);
    if (middle) out.push_back(depth_factor(window, id, *middle));
  }
}

std::optional<double> depth_error_sigmas(const Window& window, StateId state, const RegionDepth& depth,
                                         const LogScale& scale) {
  const std::optional<Middle> middle = middle_landmarks(window, state, depth);
  if (!middle) return std::nullopt;
  const double error = middle->mean_ln - scale.value + std::log(depth.depth_m);
  return std::abs(error) / std::hypot(sigma_ln(depth, middle->in_region), scale.sigma);
}

double worst_depth_error(const Window& window, const LogScale& scale) {
  double worst = 0.0;
  for (const auto& [id, state] : window.states()) {
    if (state.depth) worst = std::max(worst, depth_error_sigmas(window, id, *state.depth, scale).value_or(0.0));
  }
  return worst;
}

}  // namespace edged
