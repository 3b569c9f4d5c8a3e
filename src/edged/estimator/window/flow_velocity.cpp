// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/flow_velocity.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "edged/camera/two_view.hpp"
#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

/// Where the camera sees the feature from, and its ray.
struct Sighting {
  Eigen::Vector3d direction_O, lever_O;  ///< lever: from the body to the camera [m]
  Timestamp t;
};

Sighting sighting(const Window& window, const ObservationKey& view, const WindowObservation& seen) {
  const WindowState& state = window.states().at(view.state);
  const SE3 T_O_C = window.T_O_C(view);
  return {ray_of({T_O_C, window.point(view, seen)}).direction_A, T_O_C.translation() - state.T_O_B().translation(),
          state.t};
}

}  // namespace

std::optional<FlowVelocity> flow_velocity(const Window& window, double depth_m) {
  // Least squares: a ray d to a point at the depth z turns by -(I - d d^T) (v dt + lever_2 - lever_1) / z.
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double squares = 0.0;
  std::size_t tracks = 0;
  for (const auto& [id, feature] : window.features()) {
    if (feature.anchor || feature.observations.size() < 2) continue;
    const auto& [first, first_seen] = *feature.observations.begin();
    const auto& [last, last_seen] = *feature.observations.rbegin();
    if (last.state != window.newest_id() || last.camera != first.camera) continue;
    const Sighting before = sighting(window, first, first_seen), now = sighting(window, last, last_seen);
    const double dt = to_seconds(now.t - before.t);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - now.direction_O * now.direction_O.transpose();
    const Eigen::Vector3d travel =
        -across * (depth_m * (now.direction_O - before.direction_O) + now.lever_O - before.lever_O);
    H += dt * dt * across;
    b += dt * travel;
    squares += travel.squaredNorm();
    ++tracks;
  }
  if (tracks < kStandstillTuning.min_features) return std::nullopt;
  const Eigen::LDLT<Eigen::Matrix3d> ldlt(H);
  const Eigen::Vector3d v_O = ldlt.solve(b);
  const double variance = std::max(0.0, squares - b.dot(v_O)) / (2.0 * static_cast<double>(tracks) - 3.0);
  const double by_scatter = std::sqrt(variance * ldlt.solve(Eigen::Matrix3d::Identity()).trace());
  if (!v_O.allFinite() || !std::isfinite(by_scatter)) return std::nullopt;
  return FlowVelocity{v_O, std::hypot(by_scatter, kEstimatorTuning.flow_depth_sigma * v_O.norm())};
}

}  // namespace edged
