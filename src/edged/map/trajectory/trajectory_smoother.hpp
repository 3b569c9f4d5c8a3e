// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Records causal poses and map matches, solves a graph of them for the initial values of the final optimization, and
// composes the final trajectory. Nothing of it feeds back into odometry or map.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "edged/map/map_errors.hpp"
#include "edged/map/odom_to_map.hpp"
#include "edged/options/map.hpp"
#include "edged/se3.hpp"
#include "edged/state.hpp"

namespace edged {

/// Calls come in order of time, `load` or `restart` first. The T_M_O of each start is in OdomToMap, which gets the same
/// starts. Half a megabyte a minute; solve() takes six times that while it works.
class TrajectorySmoother {
 public:
  /// Nothing has started yet.
  bool empty() const { return sessions_.empty(); }

  /// The map has keyframes of another run, numbered from zero on. Their poses relative to one another are fixed; with
  /// `fixed` all of them are.
  void load(std::span<const SE3> T_M_K, bool fixed = false);
  /// The odometry starts in a new O, whose pose in M has these sigmas of position and yaw [m], [rad].
  void restart(const StampedPose& T_O_B, double position_sigma, double yaw_sigma);
  /// A published pose: one of the path.
  void add(const StampedPose& T_O_B);
  /// A marginalized keyframe: a refined pose at an instant that was added.
  void refine(const StampedPose& T_O_K);
  /// The map keeps that keyframe. Returns its number, which observations refer to.
  std::size_t add_keyframe(const StampedPose& T_O_K);
  /// Map matches in the images of an instant, after the correction of OdomToMap by them; T_B_C: one per image.
  void add_observations(const StampedPose& T_O_B, std::vector<SE3> T_B_C, std::span<const MapObservation> observations);

  /// T_M_O of each start at its instants with information, interpolated between; keyframes by number.
  struct Solution {
    std::vector<Trajectory> T_M_O;
    std::vector<SE3> keyframes;  ///< T_M_K
    /// T_M_O at that time, of the start to which it belongs.
    SE3 at(const TrajectorySmoother& record, Timestamp t) const;
  };
  /// Initial values where loops have been closed: the causal ones are before the correction.
  struct Closed {
    Timestamp last;                        ///< the last time: later causal poses are consistent
    std::map<std::size_t, SE3> keyframes;  ///< T_M_K by number
  };
  Solution solve(const OdomToMap& odom_to_map, const std::optional<Closed>& closed = std::nullopt) const;
  /// T_M_B of all poses that were added. placed: better poses at some of their instants, in order of time; the others
  /// follow them by the causal increments. A start without any has those of the solution: bit-identical to the causal
  /// ones without any map match.
  Trajectory path(const OdomToMap& odom_to_map, const Solution& solution, const Trajectory& placed = {}) const;

  /// The map matches in the images of an instant.
  struct Matches {
    StampedPose T_O_B;  ///< refined
    const std::vector<SE3>& T_B_C;
    std::vector<MapObservation> observations;
  };
  /// The matches from one instant to another, in order of time.
  std::vector<Matches> matches(Timestamp first, Timestamp last) const;
  /// The instants of the keyframes with a number, from the first of this run on; and that number.
  std::map<Timestamp, std::size_t> keyframe_numbers() const;

 private:
  struct View {
    StampedPose T_O_B;
    std::vector<SE3> T_B_C;
    double sigma;                                       ///< the smallest
    std::vector<MapObservationOf<float>> observations;  ///< their sigmas as multiples of that one
  };
  /// From one start of the odometry to the next.
  struct Session {
    StampedPose start;  ///< T_O_B
    double position_sigma, yaw_sigma;
    std::size_t first_keyframe;  ///< the number of the first of `keyframes`; they are numbered on
    Trajectory causal;           ///< T_O_B
    Trajectory refined;          ///< T_refined_causal, applied on the left to causal poses of that instant
    Trajectory keyframes;        ///< T_O_K
    std::vector<View> views;
  };
  /// Number in the graph and T_O_B of the instants of a session with information.
  struct Node {
    std::size_t number;
    SE3 T_O_B;
    const SE3* known = nullptr;  ///< T_M_B, of a keyframe
  };
  using Nodes = std::map<Timestamp, Node>;
  class Fit;

  bool relocalized() const;
  static std::vector<MapObservation> observations(const View& view);
  static SE3 between(const Trajectory& moved, Timestamp t);

  std::vector<SE3> loaded_;  ///< T_M_K
  bool loaded_fixed_ = false;
  std::vector<Session> sessions_;
  std::size_t keyframes_ = 0;  ///< number of keyframes that have a number
};

}  // namespace edged
