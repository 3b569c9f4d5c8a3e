// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The odometry's joint with the map: what its keyframes looked like, where it is by what was seen before, and what the
// map keeps of a keyframe that leaves the window. The odometry's frame is O here, W of the estimator; the map's is M.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "edged/final_trajectory.hpp"
#include "edged/keyframe_record.hpp"
#include "edged/map/keyframe_map.hpp"
#include "edged/map/map_filter.hpp"
#include "edged/map/saved_map.hpp"
#include "edged/map/trajectory_smoother.hpp"
#include "edged/pipeline/channel.hpp"

namespace edged {

class Mapper {
 public:
  explicit Mapper(const MapConfig& config);

  /// The estimator has started anew: T_M_O is where dead reckoning puts it.
  void restart(const SE3& T_M_O, const NavState& now);
  /// The odometry has come to `now`.
  void predict(const NavState& now);
  /// Looks for the map in the image, and after a new start, until it has been found again, everywhere: true when it has
  /// been just now. T_O_B: of the image's instant.
  bool localize(Timestamp t, const ChannelView& view, const SE3& T_O_B);
  /// The packet has become a keyframe, which looks like this.
  void keyframe(Timestamp t, const ChannelView& view, const SE3& T_O_B);
  /// A keyframe has left the window: kept where the map gains by it.
  void take(const KeyframeRecord& record);

  /// That pose of the odometry has been given out.
  void note(const NavState& now) { record_.add({now.t, now.T_W_B}); }

  const SE3& T_M_O() const { return filter_.T_M_O(); }
  /// What was found in the image of that instant.
  std::vector<MapMatch> map_matches(Timestamp t) const { return looked_at_ == t ? found_ : std::vector<MapMatch>(); }
  /// In M.
  FinalTrajectory final_trajectory() const;

  /// Takes up a map that was made before, in place of what there is. Where this run is in it is not known until a place
  /// of it has been recognised: so long M is a frame of this run's own.
  void load(const SavedMap& map);
  bool started() const { return !record_.empty(); }
  /// All but the cameras. Nothing while a map that was taken up has not been found again: what this run has seen lies
  /// in another frame than that.
  std::optional<SavedMap> save() const;
  bool awaiting_relocalization() const { return unlocated_before_.has_value(); }

 private:
  /// How a keyframe of the window looked.
  struct Look {
    struct Feature {
      Patch patch;
      std::optional<Descriptor> descriptor;
      Eigen::Vector2d pixel;
    };
    Timestamp t;
    std::string camera;
    std::map<FeatureId, Feature> features;
  };
  /// Points that should be in view, and what was found of them.
  struct Search {
    std::vector<Candidate> candidates;
    std::vector<bool> found;  ///< one a candidate
    std::vector<MapObservation> observations;
    std::vector<Eigen::Vector2d> pixels;  ///< one a observation
    SE3 T_B_C;
  };
  /// When keyframes were made whose place against the body is known: not those of a map that has not been found yet.
  Period known() const { return {.since = unlocated_before_.value_or(Timestamp::min())}; }
  Search search(const MapFilter& filter, const ChannelView& view, const SE3& T_O_C, Period made);
  bool update(MapFilter& filter, const Search& search, Timestamp t);
  bool recognise(Timestamp t, const ChannelView& view, const SE3& T_O_C);
  bool plausible(const SE3& T_M_O, const SE3& T_O_B) const;
  double covered_share(const FeatureTracker& tracker) const;
  void remove_keyframe(std::size_t keyframe);

  MapConfig config_;
  KeyframeMap map_;
  MapFilter filter_;
  TrajectorySmoother record_;
  std::deque<Look> looks_;
  std::vector<MapMatch> found_;  ///< in the newest image that was looked at
  std::optional<Timestamp> looked_at_;
  Timestamp predicted_;     ///< newest word of the odometry
  Timestamp started_;       ///< the estimator's newest start
  SE3 T_M_O_guess_;         ///< there, by dead reckoning
  double blind_s_ = 0.0;    ///< how long it had gone on that alone, since what is older was last found
  bool searching_ = false;  ///< since then nothing older has been found again
  /// While set, keyframes before that are of a map that was taken up, and where the body is in it is not known.
  std::optional<Timestamp> unlocated_before_;
  std::optional<SE3> recognised_;  ///< T_M_O by the last image's looks, waiting for another that agrees
};

}  // namespace edged
