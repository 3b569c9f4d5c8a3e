// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Keyframes with their map points, and which of these should be in view now. The poses of the keyframes are kept by
// MapFilter and passed with each query.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "edged/final_trajectory.hpp"
#include "edged/frontend/patches/patch.hpp"
#include "edged/map/map_errors.hpp"
#include "edged/map/places/place.hpp"
#include "edged/map/places/place_index.hpp"
#include "edged/options/map.hpp"
#include "edged/rig.hpp"
#include "edged/se3.hpp"
#include "edged/time.hpp"

namespace edged {

/// A point in its keyframe's camera: it moves with its keyframe.
struct MapPoint {
  FeatureId id = 0;                                 ///< feature id of its own run; 0 in a loaded map
  Eigen::Vector2d point = Eigen::Vector2d::Zero();  ///< on the unit plane
  double inverse_depth = 0.0;                       ///< 1 / z [1/m]
  double sigma = 0.0;                               ///< sigma of inverse_depth
  Patch patch;
  std::optional<Descriptor> descriptor;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< centre of the patch in its image
  int searched = 0, matched = 0;                    ///< number of matches, in images whose matches agreed
};

/// The image of one camera.
struct MapView {
  std::string camera;  ///< its points are matched in images of this one: in others they have another appearance
  SE3 T_B_C;
  std::vector<MapPoint> points;
  double scene_depth = 0.0;  ///< median of its points [m]; computed by KeyframeMap
};

struct MapKeyframe {
  Timestamp t, matched_at;     ///< time of creation, and of the last match of its points
  std::vector<MapView> views;  ///< at most one per camera
  std::size_t number = 0;      ///< in TrajectorySmoother
  int times_matched = 0;       ///< number of instants with matches of its points
  double path_m = 0.0;         ///< length of the odometry's path at its creation; 0 in a loaded map
};

/// The view of the map for its users.
MappedKeyframe mapped(const MapKeyframe& keyframe, const SE3& T_M_K);

/// From `since` on, and before `before`.
struct TimeInterval {
  Timestamp since = Timestamp::min(), before = Timestamp::max();
  bool contains(Timestamp t) const { return since <= t && t < before; }
};

/// A query of the map.
struct MapQuery {
  std::string_view camera;                       ///< views of this camera only
  TimeInterval created;                          ///< keyframes of this time only
  std::span<const SE3> T_M_K;                    ///< pose of the body at each keyframe of the map, in their order
  std::function<bool(std::size_t)> wanted = {};  ///< these keyframes only, by index; empty: all
};

/// A point that should be in view, and its match where there is one.
struct Candidate {
  MapObservation observation;  ///< its keyframe as an index into KeyframeMap::keyframes; the observation and its noise:
                               ///< when matched
  MapPoint* point;
  Eigen::Vector2d pixel;  ///< predicted position
  Eigen::Matrix2d A;      ///< pixels of the image by pixels of its patch
  bool matched = false;
};

/// What the features of an image find in the map by their descriptors.
struct Recognition {
  std::size_t similar = 0;          ///< features with a similar map point
  std::size_t agreeing = 0;         ///< similar ones that agree with one pose of the camera
  std::optional<SE3> T_M_C;         ///< that pose; nothing where too few agree
  std::set<std::size_t> keyframes;  ///< whose points agree with T_M_C, by index
};

class KeyframeMap {
 public:
  explicit KeyframeMap(const KeyframeMapConfig& config) : config_(config) {}

  /// Whether a keyframe is worth keeping if the map already covers that share of its view.
  bool needs_keyframe(double covered) const { return covered <= config_.max_covered; }
  /// Whether the keyframe is worth keeping. Removes points and views that are not.
  bool prune_points(MapKeyframe& keyframe) const;
  void add(MapKeyframe keyframe);
  /// The keyframe to remove next, if there are too many: of those of that time, except the newest, the one not matched
  /// for longest. Nothing while there is room.
  std::optional<std::size_t> redundant_keyframe(TimeInterval created = {}) const;
  void remove(std::size_t keyframe);

  /// What should be in view of the camera at T_M_C, spread over the image, the most reliable first: at most `most`.
  std::vector<Candidate> visible(const MapQuery& query, const SE3& T_M_C, const CameraModel& camera, int most);

  /// Records that the point was searched for in the image of t.
  void record_search(const Candidate& candidate, Timestamp t);

  /// Where the camera is that observes features with these descriptors at those points of the unit plane. R_O_C as in
  /// pose_by_gravity; focal: of the camera [px].
  Recognition recognize(const MapQuery& query, std::span<const std::optional<Descriptor>> descriptors,
                        std::span<const Eigen::Vector2d> points, const Eigen::Quaterniond& R_O_C, double focal) const;

  const std::vector<MapKeyframe>& keyframes() const { return keyframes_; }

 private:
  /// A view of a keyframe, by its indices.
  struct ViewIndex {
    std::size_t keyframe = 0, view = 0;
  };
  struct DescriptorMatch {
    int bits;  ///< that differ
    ViewIndex of;
    const MapPoint* point;  ///< null: no similar one
  };
  std::vector<DescriptorMatch> match_descriptors(const MapQuery& query,
                                                 std::span<const std::optional<Descriptor>> descriptors) const;
  std::vector<ViewIndex> queried_views(const MapQuery& query) const;
  std::vector<ViewIndex> candidate_views(const MapQuery& query,
                                         std::span<const std::optional<Descriptor>> descriptors) const;
  std::vector<ViewIndex> nearby_views(const MapQuery& query, const SE3& T_M_C) const;
  void keep_best(std::vector<MapPoint>& points) const;

  KeyframeMapConfig config_;
  std::vector<MapKeyframe> keyframes_;
  std::map<std::string, PlaceIndex, std::less<>> places_;  ///< by camera
};

}  // namespace edged
