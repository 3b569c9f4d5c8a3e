// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The odometry's joint with the map: what its keyframes looked like, where it is by what was seen before, and what the
// map keeps of a keyframe that leaves the window.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "edged/core/odom_state.hpp"
#include "edged/final_trajectory.hpp"
#include "edged/keyframe_record.hpp"
#include "edged/map/keyframe_map.hpp"
#include "edged/map/map_filter.hpp"
#include "edged/map/odom_to_map.hpp"
#include "edged/map/saved_map.hpp"
#include "edged/map/trajectory_smoother.hpp"
#include "edged/pipeline/tracked_image.hpp"

namespace edged {

class Mapper {
 public:
  /// lost_after_s: StatusConfig's. The last estimate may have been without landmarks for so long.
  Mapper(const MapConfig& config, double lost_after_s);

  /// The estimator has started in a new O. T_new_old: from the old O to the new one; now: the body in the new one.
  void restart(const SE3& T_new_old, const OdomState& now);
  /// O goes on, but how the body turned until now nobody knows: where it is in M is a guess, as after a start.
  void doubt(const OdomState& now);
  /// What follows is of a new time: the map of the time before is let go, the body goes on from where it is.
  void begin_time();
  /// The odometry has come to `now`.
  void predict(const OdomState& now);
  /// Looks for the map in the image, and after a new start, until relocalized, everywhere: true when it has
  /// been just now. T_O_C: of the image's camera and instant.
  bool localize(Timestamp t, const TrackedImage& image, const SE3& T_O_C);
  /// The packet has become a keyframe, which looks like this.
  void keyframe(Timestamp t, const TrackedImage& image, const SE3& T_O_C);
  /// A keyframe has left the window: kept where the map gains by it.
  void take(const KeyframeRecord& record);

  /// That pose of the odometry has been given out.
  void note(const OdomState& now) { record_.add({now.t, now.T_O_B}); }

  /// How long the pose has gone on dead reckoning alone, at the newest start [s]. It bounds where relocalization may
  /// find the body.
  double dead_reckoning_s() const { return dead_reckoning_s_; }

  const OdomToMap& odom_to_map() const { return odom_to_map_; }
  /// What was found in the image of that instant.
  std::vector<MapMatch> map_matches(Timestamp t) const { return looked_at_ == t ? found_ : std::vector<MapMatch>(); }
  /// In M.
  FinalTrajectory final_trajectory() const;

  /// Takes up a map that was made before, in place of what there is. Where this run is in it is not known until a place
  /// of it has been recognised: so long M is a frame of this run's own.
  void load(const SavedMap& map);
  bool started() const { return !record_.empty(); }
  /// All but the cameras. Nothing while awaiting relocalization in a loaded map: what this run has seen lies
  /// in another frame than that.
  std::optional<SavedMap> save() const;
  bool awaiting_relocalization() const { return unlocated_before_.has_value(); }

 private:
  /// Points that should be in view, and what was found of them.
  struct Search {
    std::vector<Candidate> candidates;
    SE3 T_B_C;
    std::vector<MapObservation> observations() const;
  };
  /// When keyframes were made whose place against the body is known: not those of a map that has not been found yet.
  Period known() const { return {.since = unlocated_before_.value_or(Timestamp::min())}; }
  void begin_start(const OdomState& now);
  Search search(const MapFilter& filter, const SE3& T_M_O, const TrackedImage& image, const SE3& T_O_C, Period made);
  bool update(MapFilter& filter, const SE3& T_M_O, const Search& search, Timestamp t);
  std::optional<SE3> recognised(const TrackedImage& image, const SE3& T_O_C, Period made) const;
  bool recognise(Timestamp t, const TrackedImage& image, const SE3& T_O_C);
  bool plausible(const SE3& T_M_O, const SE3& T_O_B) const;
  double covered_share(const TrackedImage& image) const;
  void remove_keyframe(std::size_t keyframe);

  MapConfig config_;
  double lost_after_s_;
  KeyframeMap map_;
  MapFilter filter_;
  TrajectorySmoother record_;
  OdomToMap odom_to_map_;
  std::deque<MapKeyframe> in_window_;  ///< what keyframes look like whose poses and depths the window still refines
  std::vector<MapMatch> found_;        ///< in the newest image that was looked at
  std::optional<Timestamp> looked_at_;
  Timestamp predicted_;            ///< newest word of the odometry
  Timestamp started_;              ///< the estimator's newest start
  SE3 T_M_O_guess_;                ///< there, by dead reckoning
  double dead_reckoning_s_ = 0.0;  ///< how long it had gone on that alone, since what is older was last found
  bool searching_ = false;         ///< since then nothing older has been matched
  /// While set, keyframes before that are of a map that was taken up, and where the body is in it is not known.
  std::optional<Timestamp> unlocated_before_;
  std::optional<SE3> recognised_;  ///< T_M_O by the last image's looks, waiting for another that agrees
};

}  // namespace edged
