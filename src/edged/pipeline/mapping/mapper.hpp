// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Connects the odometry to the map: appearance of its keyframes, map matches, relocalization, and keyframes that leave
// the window for the map.
#pragma once

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/core/odom_state.hpp"
#include "edged/estimator/solver/sliding.hpp"
#include "edged/estimator/window/start_record.hpp"
#include "edged/final_trajectory.hpp"
#include "edged/keyframe_record.hpp"
#include "edged/map/keyframe_map.hpp"
#include "edged/map/map_filter.hpp"
#include "edged/map/odom_to_map.hpp"
#include "edged/map/saved_map.hpp"
#include "edged/map/trajectory/trajectory_smoother.hpp"
#include "edged/pipeline/mapping/loop_closer.hpp"
#include "edged/pipeline/mapping/map_search.hpp"
#include "edged/pipeline/vision/tracked_image.hpp"
#include "edged/step.hpp"

namespace edged {

/// What is known of the body's motion: none at rest, a rotation alone where it turns in place.
enum class Motion { Any, Turning, None };

class Mapper {
 public:
  /// lost_after_s: StatusConfig's. For this time the last estimate may have been without landmarks.
  Mapper(const MapConfig& config, double lost_after_s);

  /// The estimator has started in a new O. T_new_old: from the old O to the new one; now: the body in the new one;
  /// tilt_sigma: of its tilt [rad].
  void restart(const SE3& T_new_old, const OdomState& now, double tilt_sigma = 0.0);
  /// O continues, but the motion until now is not known well: its pose in M is uncertain, as after a start. gap_s: for
  /// so long there was no measurement.
  void reset_uncertainty(const OdomState& now, double gap_s = 0.0);
  /// A new epoch of stamps begins: the map is discarded, unless it never changes, and the body continues from its pose.
  void begin_epoch();
  /// The odometry has reached `now`, which is that well known; nothing: as well as before.
  void predict(const OdomState& now, Motion motion = Motion::Any, const std::optional<OdomUncertainty>& known = {});
  /// Matches the map in the images of one instant, one per camera, at least one; after a new start, until relocalized,
  /// by place recognition: true when it has just been relocalized. place_sigma: of the body, by a loss or a gap [m].
  bool localize(Timestamp t, std::span<const PosedImage> images, double place_sigma = 0.0);
  /// The packet has become a keyframe, with these images.
  void keyframe(Timestamp t, std::span<const PosedImage> images);
  /// A keyframe has left the window: kept if it is worth it.
  /// last_chance: at a gap or a loss, where keyframes soon after the start are better than no map.
  void add_keyframe(const MarginalizedKeyframe& record, bool last_chance = false);

  /// Adds a published pose of the odometry to the trajectory.
  void add_pose(const OdomState& now) { record_.add({now.t, now.T_O_B}); }

  const OdomToMap& odom_to_map() const { return odom_to_map_; }
  /// The map matches in the images of an instant.
  std::vector<MapMatch> map_matches(Timestamp t) const {
    return last_search_ == t ? matches_ : std::vector<MapMatch>();
  }
  /// The loop that the images of an instant have closed.
  std::optional<LoopClosure> loop_closure(Timestamp t) const {
    return closed_loop_ && closed_loop_->t == t ? std::optional(closed_loop_->closure) : std::nullopt;
  }
  /// A start of the estimator has ended: all its measurements.
  void end_start(StartRecord start);
  /// The trajectory in M, with those of earlier epochs. present: the start that has not ended.
  FinalTrajectory final_trajectory(StartRecord present = {}, const OptimizationProgress& progress = {}) const;

  /// Loads a map of an earlier run, in place of the present one. Until relocalization M is a frame of this run's own.
  void load(const SavedMap& map);
  bool started() const { return !record_.empty(); }
  /// The map without its cameras. Nothing while awaiting relocalization in a loaded map, unless that never changes:
  /// keyframes of this run are in another frame than that.
  std::optional<SavedMap> save() const;
  bool awaiting_relocalization() const { return loaded_map_until_.has_value(); }
  /// With localize_only: the body has been relocalized in the loaded map, and no loss has followed.
  bool localized() const { return !relocalizing_ && !loaded_map_until_ && !map_.keyframes().empty(); }
  /// Time since the last map match or rest [s].
  double unmatched_s() const { return to_seconds(predicted_ - last_match_); }

 private:
  /// Creation times of keyframes whose pose relative to the body is known: not those of a map before relocalization in
  /// it.
  TimeInterval localized_period() const { return {.since = loaded_map_until_.value_or(Timestamp::min())}; }
  void begin_start(const OdomState& now, double tilt_sigma, double gap_s = 0.0);
  bool update(MapFilter& filter, const SE3& T_M_O, const MapSearch& search, Timestamp t,
              std::span<const PosedImage> images);
  bool same_view(double focal_px) const;
  std::optional<SE3> recognized_T_M_O(const PosedImage& posed, TimeInterval created) const;
  bool relocalize(Timestamp t, std::span<const PosedImage> images, bool matches_older);
  bool relocalize_by_appearance(Timestamp t, std::span<const PosedImage> images);
  bool confirmed(const SE3& T_M_O, Timestamp t, std::span<const PosedImage> images, TimeInterval created);
  bool plausible(const SE3& T_M_O, const SE3& T_O_B) const;
  bool close_loop(Timestamp t, std::span<const PosedImage> images);
  std::optional<TrajectorySmoother::Closed> closed() const;
  double covered_share(std::span<const PosedImage> images) const;
  bool is_young(Timestamp t) const { return to_seconds(t - started_) < config_.keyframes.min_known_s; }
  bool insert(MapKeyframe& keyframe, const SE3& T_O_B);
  void remove_keyframe(std::size_t keyframe);

  MapConfig config_;
  double lost_after_s_;
  KeyframeMap map_;
  MapFilter filter_;
  std::optional<SavedMap> fixed_;  ///< with localize_only: the covariance as loaded; the filter's may have other terms
  TrajectorySmoother record_;
  std::vector<StartRecord> starts_;  ///< that have ended
  OdomToMap odom_to_map_;
  std::deque<MapKeyframe> in_window_;  ///< appearance of keyframes whose poses and depths the window still refines
  std::vector<std::pair<MapKeyframe, SE3>> young_;  ///< with T_O_B, of a start before which there was no map
  std::vector<MapMatch> matches_;                   ///< in the newest images that were matched
  SE3 T_M_B_matched_;                               ///< then
  std::optional<Timestamp> last_search_;
  Timestamp predicted_;                   ///< newest pose of the odometry
  Drift drift_ = kMapTuning.final_drift;  ///< until the odometry knows its own
  Timestamp last_match_;                  ///< or rest
  Timestamp started_;                     ///< the estimator's newest start
  SE3 T_M_O_dead_reckoning_;              ///< at the newest start, by dead reckoning
  double dead_reckoning_s_ = 0.0;         ///< duration of dead reckoning, since the last match of older keyframes
  double gap_s_ = 0.0;                    ///< the part of it without any sensor
  bool relocalizing_ = false;             ///< since the newest start nothing older has been matched
  /// While set, keyframes before that are of a loaded map, in which the body is not relocalized yet.
  std::optional<Timestamp> loaded_map_until_;
  double path_m_ = 0.0;  ///< length of the odometry's path in motion
  Eigen::Vector3d p_O_B_ = Eigen::Vector3d::Zero();
  LoopCloser loops_;
  struct ClosedLoop {
    Timestamp t;
    LoopClosure closure;
  };
  std::optional<ClosedLoop> closed_loop_;       ///< the last one
  std::vector<SE3> relocalization_candidates_;  ///< T_M_O by place recognition in the last images, to be confirmed
  FinalTrajectory previous_trajectory_;         ///< that of earlier epochs
};

}  // namespace edged
