// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What was seen before: keyframes with their points, and which of those should be in view now. Where the keyframes are
// is known elsewhere, and comes along with each question.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "edged/final_trajectory.hpp"
#include "edged/frontend/patch.hpp"
#include "edged/map/place.hpp"
#include "edged/options/map.hpp"
#include "edged/rig.hpp"
#include "edged/se3.hpp"
#include "edged/time.hpp"

namespace edged {

/// A point in its keyframe's camera: when keyframes are moved, their points move along.
struct MapPoint {
  Eigen::Vector2d point = Eigen::Vector2d::Zero();  ///< on the unit plane
  double inverse_depth = 0.0;                       ///< of z [1/m]
  double sigma = 0.0;                               ///< of inverse_depth
  Patch patch;
  std::optional<Descriptor> descriptor;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< of the patch's middle in its image
  int tried = 0, found = 0;                         ///< in images whose observations agreed
};

struct MapKeyframe {
  Timestamp t, found_at;  ///< when it was made, and when points of it were last found
  std::string camera;     ///< whose image it was: others show the same place otherwise
  SE3 T_B_C;
  std::vector<MapPoint> points;
  std::size_t number = 0;    ///< in TrajectorySmoother
  double scene_depth = 0.0;  ///< median of its points [m]; KeyframeMap works it out
  int times_found = 0;       ///< images in which points of it were found
};

/// As those who use the map see it.
MappedKeyframe mapped(const MapKeyframe& keyframe, const SE3& T_M_K);

/// From `since` on, and before `before`.
struct Period {
  Timestamp since = Timestamp::min(), before = Timestamp::max();
  bool contains(Timestamp t) const { return since <= t && t < before; }
};

/// What is asked of the map.
struct MapQuery {
  std::string_view camera;     ///< its keyframes alone
  Period made;                 ///< those made then alone
  std::span<const SE3> T_M_K;  ///< where the body was at each keyframe of the map, in their order
};

/// A point that should be in view.
struct Candidate {
  std::size_t keyframe;  ///< index into KeyframeMap::keyframes
  MapPoint* point;
  Eigen::Vector3d p_K, depth_sigma_K;  ///< as in MapObservation
  Eigen::Vector2d pixel;               ///< where it is expected
  Eigen::Matrix2d A;                   ///< pixels of the image by pixels of its patch
};

class KeyframeMap {
 public:
  explicit KeyframeMap(const KeyframeMapConfig& config) : config_(config) {}

  /// Whether a keyframe can be worth keeping, of whose view the map already shows that share.
  bool wants(double covered) const { return covered <= config_.max_covered; }
  /// Whether the map gains by the keyframe, which it wants. Points that are not worth keeping are taken out.
  bool gains_by(MapKeyframe& keyframe) const;
  void add(MapKeyframe keyframe);
  /// The keyframe to be removed next, as there are too many: of those made then, but for the newest, the one that was
  /// not found for longest. Nothing while there is room.
  std::optional<std::size_t> superfluous(Period made = {}) const;
  void remove(std::size_t keyframe);

  /// What should be in view of the camera at T_M_C, spread over the image, the most reliable first: at most `most`.
  std::vector<Candidate> visible(const MapQuery& query, const SE3& T_M_C, const CameraModel& camera, int most);

  /// The points of that keyframe and image were looked for, and found.
  void note(const Candidate& candidate, bool found, Timestamp t);

  /// Where the camera is that sees features with these descriptors at those points of the unit plane. R_O_C as in
  /// pose_by_gravity; focal: of the camera [px]. Nothing where no place of the map looks like that.
  std::optional<SE3> recognise(const MapQuery& query, std::span<const std::optional<Descriptor>> descriptors,
                               std::span<const Eigen::Vector2d> points, const Eigen::Quaterniond& R_O_C,
                               double focal) const;

  const std::vector<MapKeyframe>& keyframes() const { return keyframes_; }

 private:
  struct Alike {
    int bits;  ///< that differ
    std::size_t keyframe;
    const MapPoint* point;  ///< null: none is alike
  };
  std::vector<Alike> most_alike(const MapQuery& query, std::span<const std::optional<Descriptor>> descriptors) const;
  std::vector<std::size_t> near(const MapQuery& query, const SE3& T_M_C) const;

  KeyframeMapConfig config_;
  std::vector<MapKeyframe> keyframes_;
};

}  // namespace edged
