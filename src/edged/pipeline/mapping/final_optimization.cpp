// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/mapping/final_optimization.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "edged/core/directions.hpp"
#include "edged/estimator/solver/solver.hpp"
#include "edged/estimator/tuning.hpp"
#include "edged/estimator/window/landmarks.hpp"
#include "edged/map/map_errors.hpp"
#include "edged/map/tuning.hpp"
#include "edged/pipeline/mapping/map_match_factor.hpp"

namespace edged {
namespace {

using PointKey = std::tuple<std::uint32_t, double, double, double>;

/// A map point: its keyframe and its place there.
PointKey point_of(const MapObservation& observation) {
  return {observation.keyframe, observation.p_K.x(), observation.p_K.y(), observation.p_K.z()};
}

Eigen::Matrix2d inverse_root(const Eigen::Matrix2d& R) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(R).operatorInverseSqrt();
}

/// A rotation about z and a translation, by which gravity stays as it is.
SE3 upright(const SE3& T_M_B, const SE3& T_O_B) {
  const Eigen::Quaterniond q = nearest_yaw((T_M_B * T_O_B.inverse()).R());
  return {q, T_M_B.translation() - q * T_O_B.translation()};
}

/// One start. All is in its O, in which gravity and the priors are; M is where the first state is in the solution.
class StartOptimization {
 public:
  StartOptimization(const TrajectorySmoother& record, StartRecord start, const TrajectorySmoother::Solution& solution)
      : record_(record), start_(std::move(start)), solution_(solution) {
    for (std::size_t i = 0; i < start_.states.size(); ++i) places_.emplace(start_.states[i].state.t, i);
    const auto& [id, first, scale] = start_.states.front();
    const SE3 T_O_B = first.T_O_B();
    T_M_O_ = upright(solution.at(record, first.t) * T_O_B, T_O_B);
    add_matches();  // while the states are those of the odometry
    move_to_solution();
    make_factors();
  }

  /// Poses in M.
  Trajectory optimize(FinalCost& cost, const OptimizationProgress& progress) {
    Window window(start_);
    window.relinearise_intrinsics();
    remove_hidden(window);
    predict_observations(window);
    const SolveSummary summary = solve_long(window, kMapTuning.final_iterations, progress);
    if (!summary.usable) return {};
    cost.before += summary.initial_cost;
    cost.after += summary.final_cost;
    Trajectory poses;
    for (const auto& [id, state] : window.states()) poses.push_back({state.t, T_M_O_ * state.T_O_B()});
    return poses;
  }

 private:
  struct Match {
    MatchedImage image;
    MatchedKeyframe keyframe;
    MapObservation observation;
    std::size_t part = 0;  ///< of the states, as long as a track may be
  };

  std::size_t nearest(Timestamp t) const {
    const auto after = places_.lower_bound(t);
    if (after == places_.end()) return places_.size() - 1;
    if (after == places_.begin() || after->first - t <= t - std::prev(after)->first) return after->second;
    return std::prev(after)->second;
  }

  void add_matches() {
    std::map<std::size_t, std::size_t> places;  // of keyframes by their numbers
    for (const auto& [t, number] : record_.keyframe_numbers()) {
      const auto here = places_.find(t);
      if (here != places_.end()) places.emplace(number, here->second);
    }
    const Timestamp first = places_.begin()->first, last = places_.rbegin()->first;
    for (const TrajectorySmoother::Matches& seen : record_.matches(first, last)) {
      const std::size_t at = nearest(seen.T_O_B.t);
      const SE3 T_A_B = start_.states[at].state.T_O_B().inverse() * seen.T_O_B.T;
      for (const MapObservation& observation : seen.observations) {
        MatchedKeyframe keyframe{std::nullopt, SE3()};
        if (const auto place = places.find(observation.keyframe); place == places.end()) {
          keyframe.T_O_K = T_M_O_.inverse() * solution_.keyframes[observation.keyframe];
          outside_ = true;
        } else if (place->second != at) {
          keyframe.state = start_.states[place->second].id;
        } else {
          continue;
        }
        matches_.push_back({{start_.states[at].id, T_A_B, seen.T_B_C[observation.camera]},
                            keyframe,
                            observation,
                            at / kSolverTuning.band_states});
      }
    }
  }

  /// States and landmarks to their initial values.
  void move_to_solution() {
    std::map<StateId, SE3> moved;
    for (StartRecord::State& kept : start_.states) {
      const SE3 T_O_odom = T_M_O_.inverse() * solution_.at(record_, kept.state.t);
      OdomState nav = kept.state.nav();
      nav.T_O_B = T_O_odom * nav.T_O_B;
      nav.v_O = T_O_odom.rotation() * nav.v_O;
      kept.state.pose = to_block(nav.T_O_B);
      kept.state.motion = motion_block(nav);
      moved.emplace(kept.id, T_O_odom);
    }
    for (StartRecord::Part& part : start_.parts) {
      const auto by = moved.find(start_.observations[part.first].state);
      if (by != moved.end()) part.p_O = (by->second * part.p_O.cast<double>()).cast<float>();
    }
  }

  /// The errors of a map point's depth and patch are the same in all its matches: those within the length of a track
  /// count as one; all of a run as one would let a long one drift from its map.
  void make_factors() {
    std::map<StateId, SE3> T_O_A;
    for (const StartRecord::State& kept : start_.states) T_O_A.emplace(kept.id, kept.state.T_O_B());
    std::map<std::pair<PointKey, std::size_t>, int> times;
    for (const Match& match : matches_) ++times[{point_of(match.observation), match.part}];
    for (const auto& [image, keyframe, observation, part] : matches_) {
      const SE3 T_O_K = keyframe.state ? T_O_A.at(*keyframe.state) : keyframe.T_O_K;
      const auto row = linearised(observation, T_O_A.at(image.state) * image.T_A_B, T_O_K, image.T_B_C);
      if (!row) continue;
      start_.factors.push_back(std::make_shared<MapMatchFactor>(image, keyframe, observation, inverse_root(row->R),
                                                                1.0 / times.at({point_of(observation), part})));
    }
    if (outside_) free_gauge();
  }

  /// Keyframes outside of the start tell where it is in M, better than its first pose does.
  void free_gauge() {
    const BlockKey first{BlockKind::Pose, start_.states.front().id};
    std::erase_if(start_.factors, [&](const auto& factor) { return factor->blocks() == std::vector<BlockKey>{first}; });
    start_.factors.push_back(std::make_shared<LinearPriorFactor>(
        gauge_prior(first, start_.states.front().state.pose, kMapTuning.same_place_m, kMapTuning.same_place_rad)));
  }

  const TrajectorySmoother& record_;
  StartRecord start_;
  const TrajectorySmoother::Solution& solution_;
  SE3 T_M_O_;
  std::map<Timestamp, std::size_t> places_;  ///< of the states
  std::vector<Match> matches_;
  bool outside_ = false;  ///< some are of keyframes of other starts
};

}  // namespace

Trajectory optimize_jointly(const TrajectorySmoother& record, std::vector<StartRecord> starts,
                            TrajectorySmoother::Solution& solution, FinalCost& cost,
                            const OptimizationProgress& progress) {
  const std::map<Timestamp, std::size_t> numbers = record.keyframe_numbers();
  std::erase_if(starts, [](const StartRecord& start) { return start.states.size() < 2; });
  double states = 0.0, done = 0.0;
  for (const StartRecord& start : starts) states += static_cast<double>(start.states.size());
  Trajectory all;
  for (StartRecord& start : starts) {
    const auto part = static_cast<double>(start.states.size());
    const auto of_all = [&](double share) {
      if (progress) progress((done + share * part) / states);
    };
    const Trajectory poses = StartOptimization(record, std::move(start), solution).optimize(cost, of_all);
    done += part;
    for (const StampedPose& pose : poses) {
      if (const auto number = numbers.find(pose.t); number != numbers.end())
        solution.keyframes[number->second] = pose.T;
      all.push_back(pose);
    }
  }
  return all;
}

}  // namespace edged
