// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/map_merge.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace edged {
namespace {

constexpr double kSamePlace_m = 0.15, kSamePlace_rad = 0.05;  // of the poses of the other map by two keyframes
constexpr std::size_t kFewestKeyframes = 3;
constexpr double kLeastShare = 0.5;  // of the recognised keyframes
// Of the common result.
constexpr double kPositionSigma_m = 0.05, kRotationSigma_rad = 0.02;

double focal_of(const SavedMap& map, const std::string& camera) {
  const auto found = std::ranges::find(map.cameras, camera, &SavedMap::Camera::name);
  return found == map.cameras.end() ? 0.0 : found->focal;
}

/// Of each recognized keyframe of `other`: the pose of its body, in both frames.
struct Hypothesis {
  SE3 T_A_K, T_B_K;
  SE3 T_A_B() const { return T_A_K * T_B_K.inverse(); }
};

/// The pose of the body in A, by the descriptors of one view of a keyframe of B.
std::optional<SE3> recognised_body(const KeyframeMap& places, const SavedMap& map, const MapView& view,
                                   const SE3& T_B_K) {
  const double focal = focal_of(map, view.camera);
  if (focal <= 0.0) return std::nullopt;
  std::vector<std::optional<Descriptor>> descriptors;
  std::vector<Eigen::Vector2d> points;
  for (const MapPoint& point : view.points) {
    descriptors.push_back(point.descriptor);
    points.push_back(point.point);
  }
  const std::optional<SE3> T_A_C =
      places.recognise({view.camera, {}, map.T_M_K}, descriptors, points, (T_B_K * view.T_B_C).rotation(), focal);
  return T_A_C ? std::optional(*T_A_C * view.T_B_C.inverse()) : std::nullopt;
}

std::vector<Hypothesis> hypotheses_of(const SavedMap& map, const SavedMap& other) {
  KeyframeMapConfig config;
  KeyframeMap places(config);
  for (const MapKeyframe& keyframe : map.keyframes) places.add(keyframe);
  std::vector<Hypothesis> hypotheses;
  for (std::size_t k = 0; k < other.keyframes.size(); ++k) {
    for (const MapView& view : other.keyframes[k].views) {
      const std::optional<SE3> T_A_K = recognised_body(places, map, view, other.T_M_K[k]);
      if (!T_A_K) continue;
      hypotheses.push_back({*T_A_K, other.T_M_K[k]});
      break;  // two views of a keyframe are not independent
    }
  }
  return hypotheses;
}

/// Whether `hypothesis` agrees with T_A_B, too.
bool agrees(const SE3& T_A_B, const Hypothesis& hypothesis) {
  const SE3 off = hypothesis.T_A_K.inverse() * T_A_B * hypothesis.T_B_K;
  return off.translation().norm() < kSamePlace_m && so3::log(off.rotation()).norm() < kSamePlace_rad;
}

/// Jacobian of keyframe poses by the error of T_A_B: six rows each, by position in A and rotation about A's axes at
/// `centre`.
Eigen::MatrixXd by_common_error(const std::vector<SE3>& T_A_K, const Eigen::Vector3d& centre) {
  Eigen::MatrixXd J(6 * std::ssize(T_A_K), 6);
  for (std::size_t k = 0; k < T_A_K.size(); ++k) {
    auto rows = J.middleRows<6>(6 * static_cast<Eigen::Index>(k));
    rows << Eigen::Matrix3d::Identity(), -skew(T_A_K[k].translation() - centre), Eigen::Matrix3d::Zero(),
        T_A_K[k].R().transpose();
  }
  return J;
}

}  // namespace

std::optional<SE3> find_map_in(const SavedMap& map, const SavedMap& other) {
  const std::vector<Hypothesis> hypotheses = hypotheses_of(map, other);
  const auto supporters = [&](const Hypothesis& hypothesis) {
    return std::ranges::count_if(hypotheses, [&](const Hypothesis& c) { return agrees(hypothesis.T_A_B(), c); });
  };
  const auto best = std::ranges::max_element(hypotheses, {}, supporters);
  if (best == hypotheses.end()) return std::nullopt;
  const auto support = static_cast<std::size_t>(supporters(*best));
  if (support < kFewestKeyframes || static_cast<double>(support) < kLeastShare * static_cast<double>(hypotheses.size()))
    return std::nullopt;
  return best->T_A_B();
}

SavedMap merged(const SavedMap& map, const SavedMap& other, const SE3& T_A_B) {
  SavedMap both{map.cameras, other.keyframes, {}, {}};
  for (const SavedMap::Camera& camera : other.cameras) {
    if (focal_of(map, camera.name) == 0.0) both.cameras.push_back(camera);
  }
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const SE3& T_B_K : other.T_M_K) {
    both.T_M_K.push_back(T_A_B * T_B_K);
    centre += both.T_M_K.back().translation() / static_cast<double>(other.T_M_K.size());
  }
  // Both end at the same instant before any other run: those of `other` come before those of `map`.
  const Duration by = Timestamp() - map.keyframes.front().t;
  for (MapKeyframe& keyframe : both.keyframes) keyframe.t -= by, keyframe.found_at -= by;

  const Eigen::Index n = other.covariance.rows(), m = map.covariance.rows();
  Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index k = 0; k < n; k += 6) turn.block<3, 3>(k, k) = T_A_B.R();
  const Eigen::MatrixXd J = by_common_error(both.T_M_K, centre);
  Eigen::Matrix<double, 6, 1> sigmas;
  sigmas << Eigen::Vector3d::Constant(kPositionSigma_m), Eigen::Vector3d::Constant(kRotationSigma_rad);
  both.covariance = Eigen::MatrixXd::Zero(n + m, n + m);
  both.covariance.topLeftCorner(n, n) =
      turn * other.covariance * turn.transpose() + J * sigmas.cwiseAbs2().asDiagonal() * J.transpose();
  both.covariance.bottomRightCorner(m, m) = map.covariance;
  both.keyframes.insert(both.keyframes.end(), map.keyframes.begin(), map.keyframes.end());
  both.T_M_K.insert(both.T_M_K.end(), map.T_M_K.begin(), map.T_M_K.end());
  return both;
}

}  // namespace edged
