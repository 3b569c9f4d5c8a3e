// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/map_merge.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "edged/map/tuning.hpp"

namespace edged {
namespace {

double focal_of(const SavedMap& map, const std::string& camera) {
  const auto found = std::ranges::find(map.cameras, camera, &SavedMap::Camera::name);
  return found == map.cameras.end() ? 0.0 : found->focal;
}

/// The pose of the body at a recognized keyframe of `other`, in both frames.
struct Hypothesis {
  SE3 T_A_K, T_B_K;
  SE3 T_A_B() const { return T_A_K * T_B_K.inverse(); }
};

/// What the descriptors of one view of a keyframe of B find in A.
Recognition recognized(const KeyframeMap& places, const SavedMap& map, const MapView& view, const SE3& T_B_K) {
  std::vector<std::optional<Descriptor>> descriptors;
  std::vector<Eigen::Vector2d> points;
  for (const MapPoint& point : view.points) {
    descriptors.push_back(point.descriptor);
    points.push_back(point.point);
  }
  return places.recognize({view.camera, {}, map.T_M_K}, descriptors, points, (T_B_K * view.T_B_C).rotation(),
                          focal_of(map, view.camera));
}

struct Search {
  std::size_t keyframes = 0;  ///< with a view of a camera of both
  Recognition nearest;        ///< the most that agree
  std::vector<Hypothesis> hypotheses;
};

Search search(const SavedMap& map, const SavedMap& other) {
  KeyframeMap places{KeyframeMapConfig()};
  for (const MapKeyframe& keyframe : map.keyframes) places.add(keyframe);
  Search search;
  for (std::size_t k = 0; k < other.keyframes.size(); ++k) {
    bool comparable = false;
    for (const MapView& view : other.keyframes[k].views) {
      if (focal_of(map, view.camera) <= 0.0) continue;
      comparable = true;
      const Recognition found = recognized(places, map, view, other.T_M_K[k]);
      if (found.agreeing > search.nearest.agreeing) search.nearest = found;
      if (!found.T_M_C) continue;
      search.hypotheses.push_back({*found.T_M_C * view.T_B_C.inverse(), other.T_M_K[k]});
      break;  // two views of a keyframe are not independent
    }
    search.keyframes += comparable ? 1 : 0;
  }
  return search;
}

/// Whether `hypothesis` agrees with T_A_B, too.
bool agrees(const SE3& T_A_B, const Hypothesis& hypothesis) {
  const SE3 off = hypothesis.T_A_K.inverse() * T_A_B * hypothesis.T_B_K;
  return off.translation().norm() < kMapTuning.loop_agreement_m &&
         so3::log(off.rotation()).norm() < kMapTuning.same_place_rad;
}

/// The keyframes of the other map with their covariance in A, of which the error of T_A_B is a part: position in A and
/// rotation about A's axes at the centre of the keyframes.
class AddedPoses {
 public:
  AddedPoses(const SavedMap& other, const SE3& T_A_B, const std::vector<SE3>& T_A_K)
      : other_(other), T_A_B_(T_A_B), T_A_K_(T_A_K) {
    for (const SE3& T : T_A_K) centre_ += T.translation() / static_cast<double>(T_A_K.size());
    std::vector<bool> inactive(T_A_K.size(), false);
    for (const ConditionalPose& pose : other.inactive) inactive[pose.keyframe] = true;
    for (std::uint32_t k = 0; k < T_A_K.size(); ++k) {
      row_.push_back(6 * std::ssize(active_));
      if (!inactive[k]) active_.push_back(k);
    }
  }

  Eigen::MatrixXd covariance() const { return in_A(active_, other_.covariance); }

  std::vector<ConditionalPose> inactive() const {
    InactiveKeyframes poses;
    for (const ConditionalPose& pose : other_.inactive) poses.add(pose);
    std::vector<ConditionalPose> all;
    for (const ConditionalPose& pose : other_.inactive) {
      std::vector<std::uint32_t> keyframes = {pose.keyframe};
      for (const ConditionalPose::Parent& parent : pose.parents) keyframes.push_back(parent.keyframe);
      const Eigen::MatrixXd joint = poses.joint(keyframes, [&](std::uint32_t a, std::uint32_t b) -> Matrix6d {
        return other_.covariance.block<6, 6>(row_[a], row_[b]);
      });
      all.push_back(conditional_pose(pose.keyframe, std::span(keyframes).subspan(1), in_A(keyframes, joint)));
    }
    return all;
  }

 private:
  Eigen::MatrixXd in_A(std::span<const std::uint32_t> keyframes, const Eigen::MatrixXd& in_B) const {
    Eigen::MatrixXd turn = Eigen::MatrixXd::Identity(in_B.rows(), in_B.rows()), J(in_B.rows(), 6);
    for (Eigen::Index row = 0; row < in_B.rows(); row += 6) {
      const SE3& T_A_K = T_A_K_[keyframes[static_cast<std::size_t>(row / 6)]];
      turn.block<3, 3>(row, row) = T_A_B_.R();
      J.middleRows<6>(row) << Eigen::Matrix3d::Identity(), -skew(T_A_K.translation() - centre_),
          Eigen::Matrix3d::Zero(), T_A_K.R().transpose();
    }
    Vector6d sigmas;
    sigmas << Eigen::Vector3d::Constant(kMapTuning.confirmed_m), Eigen::Vector3d::Constant(kMapTuning.confirmed_rad);
    return turn * in_B * turn.transpose() + J * sigmas.cwiseAbs2().asDiagonal() * J.transpose();
  }

  const SavedMap& other_;
  SE3 T_A_B_;
  const std::vector<SE3>& T_A_K_;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  std::vector<std::uint32_t> active_;
  std::vector<Eigen::Index> row_;  ///< in the covariance, of the active ones
};

}  // namespace

MapAlignment find_map_in(const SavedMap& map, const SavedMap& other) {
  const auto [keyframes, nearest, hypotheses] = search(map, other);
  if (keyframes == 0) return {{}, "no camera has keyframes in both"};
  if (hypotheses.empty()) {
    return {{},
            fmt::format("none of its {} keyframes is recognized there: in the nearest {} features agree on a place, of "
                        "{} that are similar; {} and {:.0f} % are needed",
                        keyframes, nearest.agreeing, nearest.similar, kMapTuning.min_inliers,
                        100.0 * kMapTuning.min_inlier_share)};
  }
  std::size_t most = 0;
  SE3 T_A_B;
  for (const Hypothesis& hypothesis : hypotheses) {
    const SE3 this_T_A_B = hypothesis.T_A_B();
    const auto supporters = static_cast<std::size_t>(
        std::ranges::count_if(hypotheses, [&](const Hypothesis& each) { return agrees(this_T_A_B, each); }));
    if (supporters > most) most = supporters, T_A_B = this_T_A_B;
  }
  if (most >= kMapTuning.confirming &&
      static_cast<double>(most) >= kMapTuning.merge_share * static_cast<double>(hypotheses.size()))
    return {T_A_B, ""};
  return {{},
          fmt::format("{} of its {} keyframes are recognized there, {} of them at one place of the two maps to each "
                      "other; {} and {:.0f} % are needed",
                      hypotheses.size(), keyframes, most, kMapTuning.confirming, 100.0 * kMapTuning.merge_share)};
}

SavedMap merged(const SavedMap& map, const SavedMap& other, const SE3& T_A_B) {
  SavedMap both{map.cameras, other.keyframes, {}, {}};
  for (const SavedMap::Camera& camera : other.cameras) {
    if (focal_of(map, camera.name) == 0.0) both.cameras.push_back(camera);
  }
  for (const SE3& T_B_K : other.T_M_K) both.T_M_K.push_back(T_A_B * T_B_K);
  // Both end at the same instant before any other run: those of `other` come before those of `map`.
  const Duration by = Timestamp() - map.keyframes.front().t;
  for (MapKeyframe& keyframe : both.keyframes) keyframe.t -= by, keyframe.matched_at -= by;

  const AddedPoses added(other, T_A_B, both.T_M_K);
  both.inactive = added.inactive();
  const auto n = static_cast<std::uint32_t>(other.keyframes.size());
  for (ConditionalPose pose : map.inactive) {
    pose.keyframe += n;
    for (ConditionalPose::Parent& parent : pose.parents) parent.keyframe += n;
    both.inactive.push_back(std::move(pose));
  }
  const Eigen::Index rows = other.covariance.rows(), more = map.covariance.rows();
  both.covariance = Eigen::MatrixXd::Zero(rows + more, rows + more);
  both.covariance.topLeftCorner(rows, rows) = added.covariance();
  both.covariance.bottomRightCorner(more, more) = map.covariance;
  both.keyframes.insert(both.keyframes.end(), map.keyframes.begin(), map.keyframes.end());
  both.T_M_K.insert(both.T_M_K.end(), map.T_M_K.begin(), map.T_M_K.end());
  return both;
}

}  // namespace edged
