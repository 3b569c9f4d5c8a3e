// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Remembers what the odometry said and what was found again of the map, and in the end fits the whole path to it.
// Nothing of it acts back on odometry or map.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "edged/map/map_errors.hpp"
#include "edged/options/map.hpp"
#include "edged/se3.hpp"
#include "edged/state.hpp"

namespace edged {

/// Calls come in order of time, `load` or `restart` first. Frames: O of the odometry, a new one each start; M of the
/// map. Half a megabyte a minute; path() takes six times that while it works.
class TrajectorySmoother {
 public:
  explicit TrajectorySmoother(const MapFilterConfig& config) : config_(config) {}

  /// Nothing has started yet.
  bool empty() const { return sessions_.empty(); }

  /// The map has keyframes of another run, numbered from zero on. They stay where they are.
  void load(std::span<const SE3> T_M_K);
  /// The odometry starts in a new O, at T_M_O for all that is known, by those sigmas of position and yaw [m], [rad].
  void restart(const StampedPose& T_O_B, const SE3& T_M_O, double position_sigma, double yaw_sigma);
  /// The guess of the start was far off: where O has been put last it was all the time since.
  void forget_guess();
  /// What was before that start lay in another frame than M.
  void move_before(const SE3& T_M_before);
  /// A pose that was given out: one of the path.
  void add(const StampedPose& T_O_B);
  /// A keyframe has left the odometry's window: where it was at an instant that was added is now better known.
  void refine(const StampedPose& T_O_K);
  /// The map keeps that keyframe. Returns its number, by which observations speak of it from now on.
  std::size_t add_keyframe(const StampedPose& T_O_K);
  /// Points were found in an image, by which O lies at T_M_O from now on.
  void add_observations(const StampedPose& T_O_B, const SE3& T_B_C, std::span<const MapObservation> observations,
                        const SE3& T_M_O);

  struct Path {
    Trajectory poses;            ///< T_M_B of all that were added
    std::vector<SE3> keyframes;  ///< T_M_K by number
  };
  /// Where nothing was ever found again all are as they were given out, to the bit.
  Path path() const;

 private:
  /// What has moved to where from then on, or by how much what was said of that instant has to be.
  struct Moved {
    Timestamp t;
    SE3 T;
  };
  struct Observation {
    std::uint32_t keyframe;
    Eigen::Vector3f p_K, depth_sigma_K;
    Eigen::Vector2f seen;
    float stretch;  ///< its sigma over that of the view
  };
  struct View {
    StampedPose T_O_B;
    SE3 T_B_C;
    double sigma;  ///< the smallest
    std::vector<Observation> observations;
  };
  struct Keyframe {
    StampedPose T_O_K;
    std::size_t number;
  };
  /// From one start of the odometry to the next.
  struct Session {
    StampedPose start;  ///< T_O_B
    double position_sigma, yaw_sigma;
    std::vector<Moved> T_M_O;
    Trajectory causal;           ///< T_O_B
    std::vector<Moved> refined;  ///< T_refined_causal, on the left
    std::vector<Keyframe> keyframes;
    std::vector<View> views;
  };
  /// Number in the graph and T_O_B of the instants of a session that something is known of.
  struct Node {
    std::size_t number;
    SE3 T_O_B;
    const SE3* known = nullptr;  ///< T_M_B, of a keyframe
  };
  using Nodes = std::map<Timestamp, Node>;
  class Fit;

  bool relocalized() const;
  static SE3 between(const std::vector<Moved>& moved, Timestamp t);
  static SE3 newest(const std::vector<Moved>& moved, Timestamp t);

  MapFilterConfig config_;
  std::vector<SE3> loaded_;  ///< T_M_K
  std::vector<Session> sessions_;
  std::size_t keyframes_ = 0;  ///< how many have a number
};

}  // namespace edged
