// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/trajectory/trajectory_smoother.hpp"

#include <algorithm>
#include <iterator>
#include <optional>

#include "edged/core/angles.hpp"
#include "edged/map/trajectory/pose_graph.hpp"
#include "edged/map/tuning.hpp"

namespace edged {
namespace {

constexpr double kRigid = 1e-4;  // [m], [rad]: between keyframes of another run

/// Covariance of the start of the odometry, relative to its last end.
Matrix6d start_covariance(double position_sigma, double yaw_sigma) {
  constexpr double kTilt_rad = kMapTuning.start_tilt_deg * kDegree;
  Matrix6d P = Matrix6d::Zero();
  P.diagonal().head<3>().setConstant(position_sigma * position_sigma);
  P.diagonal().tail<3>().setConstant(yaw_sigma * yaw_sigma + kTilt_rad * kTilt_rad);
  return P;
}

}  // namespace

/// The graph of all sessions: a pose for each instant with information, odometry with drift between them.
class TrajectorySmoother::Fit {
 public:
  /// One matched image of so many. together: their solution for the keyframes is then fixed, which leaves a chain with
  /// linear time and memory.
  Fit(const TrajectorySmoother& record, const OdomToMap& odom_to_map, const std::optional<Closed>& closed,
      std::size_t of, const Fit* together = nullptr)
      : odom_to_map_(odom_to_map),
        closed_(closed),
        of_(of),
        together_(together),
        loaded_fixed_(record.loaded_fixed_),
        keyframes_(record.keyframes_) {
    for (std::size_t k = 0; k < record.loaded_.size(); ++k) add_loaded(k, record.loaded_);
    for (const Session& session : record.sessions_) add_session(session);
    for (const Session& session : record.sessions_)
      add_observations(session, nodes_[&session - record.sessions_.data()]);
    if (record.relocalized()) graph_.solve();
  }

  const SE3& keyframe(std::size_t number) const { return graph_.poses()[keyframes_[number]]; }
  Trajectory T_M_O(std::size_t session) const {
    Trajectory found;
    for (const auto& [t, node] : nodes_[session])
      found.push_back({t, graph_.poses()[node.number] * node.T_O_B.inverse()});
    return found;
  }

 private:
  void add_loaded(std::size_t k, std::span<const SE3> T_M_K) {
    keyframes_[k] = together_       ? graph_.add_known_pose(together_->keyframe(k))
                    : loaded_fixed_ ? graph_.add_known_pose(T_M_K[k])
                                    : graph_.add_pose(T_M_K[k]);
    if (k > 0) graph_.add_step(k - 1, k, T_M_K[k - 1].inverse() * T_M_K[k], kRigid * kRigid * Matrix6d::Identity());
  }

  /// T_M_O by the keyframes until a loop was closed last; nothing without any.
  Trajectory initial(const Session& session) const {
    Trajectory T_M_O;
    if (!closed_) return T_M_O;
    for (std::size_t k = 0; k < session.keyframes.size(); ++k) {
      const auto placed = closed_->keyframes.find(session.first_keyframe + k);
      if (placed != closed_->keyframes.end() && session.keyframes[k].t <= closed_->last)
        T_M_O.push_back({session.keyframes[k].t, placed->second * session.keyframes[k].T.inverse()});
    }
    return T_M_O;
  }

  void add_session(const Session& session) {
    Nodes nodes;
    const Trajectory T_M_O = initial(session);
    const auto guess = [&](Timestamp t) {
      return T_M_O.empty() || t > closed_->last ? odom_to_map_.T_M_O(nodes_.size(), t) : between(T_M_O, t);
    };
    for (const StampedPose* causal : instants(session))
      nodes[causal->t].T_O_B = between(session.refined, causal->t) * causal->T;
    for (std::size_t k = 0; k < session.keyframes.size(); ++k) {
      Node& node = nodes[session.keyframes[k].t];
      node.T_O_B = session.keyframes[k].T;
      if (together_) node.known = &together_->keyframe(session.first_keyframe + k);
    }
    for (auto node = nodes.begin(); node != nodes.end(); ++node) {
      const auto& [t, at] = *node;
      const SE3 T_M_B = at.known ? *at.known : guess(t) * at.T_O_B;
      const std::size_t number = node->second.number = at.known ? graph_.add_known_pose(T_M_B) : graph_.add_pose(T_M_B);
      if (node != nodes.begin()) {
        const auto& [t_before, before] = *std::prev(node);
        graph_.add_step(number - 1, number, before.T_O_B.inverse() * at.T_O_B,
                        drift_covariance(kMapTuning.final_drift, T_M_B, to_seconds(t - t_before)));
        graph_.add_gravity(number, observed_gravity(at.T_O_B, to_seconds(t - t_before)));
      } else if (number > 0) {
        graph_.add_step(number - 1, number, graph_.poses()[number - 1].inverse() * T_M_B,
                        start_covariance(session.position_sigma, session.yaw_sigma));
      }
    }
    for (std::size_t k = 0; k < session.keyframes.size(); ++k)
      keyframes_[session.first_keyframe + k] = nodes[session.keyframes[k].t].number;
    nodes_.push_back(std::move(nodes));
  }

  std::vector<const StampedPose*> instants(const Session& session) const {
    std::vector<const StampedPose*> causal = {&session.start};
    for (std::size_t i = 0; i < session.views.size(); i += of_) causal.push_back(&session.views[i].T_O_B);
    return causal;
  }

  void add_observations(const Session& session, const Nodes& nodes) {
    for (std::size_t i = 0; i < session.views.size(); i += of_) {
      const View& view = session.views[i];
      std::vector<MapObservation> observations = TrajectorySmoother::observations(view);
      for (MapObservation& observation : observations)
        observation.keyframe = static_cast<std::uint32_t>(keyframes_[observation.keyframe]);
      graph_.add_observations(nodes.at(view.T_O_B.t).number, view.T_B_C, observations);
    }
  }

  const OdomToMap& odom_to_map_;
  const std::optional<Closed>& closed_;
  std::size_t of_;
  const Fit* together_;
  bool loaded_fixed_;
  PoseGraph graph_;
  std::vector<std::size_t> keyframes_;  ///< their numbers in the graph
  std::vector<Nodes> nodes_;            ///< by session
};

bool TrajectorySmoother::relocalized() const {
  return std::ranges::any_of(sessions_, [](const Session& session) { return !session.views.empty(); });
}

/// Between the two around t; the first and the last hold beyond.
SE3 TrajectorySmoother::between(const Trajectory& moved, Timestamp t) {
  const auto after = std::ranges::upper_bound(moved, t, {}, &StampedPose::t);
  if (after == moved.begin()) return after->T;
  const auto before = std::prev(after);
  if (after == moved.end()) return before->T;
  return interpolate(before->T, after->T, to_seconds(t - before->t) / to_seconds(after->t - before->t));
}

void TrajectorySmoother::load(std::span<const SE3> T_M_K, bool fixed) {
  loaded_.assign(T_M_K.begin(), T_M_K.end());
  loaded_fixed_ = fixed;
  keyframes_ = loaded_.size();
}

void TrajectorySmoother::restart(const StampedPose& T_O_B, double position_sigma, double yaw_sigma) {
  sessions_.push_back({T_O_B, position_sigma, yaw_sigma, keyframes_, {}, {{T_O_B.t, SE3()}}, {}, {}});
}

void TrajectorySmoother::add(const StampedPose& T_O_B) { sessions_.back().causal.push_back(T_O_B); }

void TrajectorySmoother::refine(const StampedPose& T_O_K) {
  Session& session = sessions_.back();
  const auto causal = std::ranges::lower_bound(session.causal, T_O_K.t, {}, &StampedPose::t);
  if (causal == session.causal.end() || causal->t != T_O_K.t || session.refined.back().t >= T_O_K.t) return;
  session.refined.push_back({T_O_K.t, T_O_K.T * causal->T.inverse()});
}

std::size_t TrajectorySmoother::add_keyframe(const StampedPose& T_O_K) {
  sessions_.back().keyframes.push_back(T_O_K);
  return keyframes_++;
}

void TrajectorySmoother::add_observations(const StampedPose& T_O_B, std::vector<SE3> T_B_C,
                                          std::span<const MapObservation> observations) {
  View view{T_O_B, std::move(T_B_C), std::ranges::min(observations, {}, &MapObservation::sigma).sigma, {}};
  for (MapObservation observation : observations) {
    observation.sigma /= view.sigma;
    view.observations.push_back(observation.cast<float>());
  }
  sessions_.back().views.push_back(std::move(view));
}

std::vector<MapObservation> TrajectorySmoother::observations(const View& view) {
  std::vector<MapObservation> observations;
  for (const MapObservationOf<float>& kept : view.observations)
    observations.emplace_back(kept.cast<double>()).sigma *= view.sigma;
  return observations;
}

std::vector<TrajectorySmoother::Matches> TrajectorySmoother::matches(Timestamp first, Timestamp last) const {
  std::vector<Matches> found;
  for (const Session& session : sessions_) {
    for (const View& view : session.views) {
      const auto& [t, T_O_B] = view.T_O_B;
      if (t >= first && t <= last)
        found.push_back({{t, between(session.refined, t) * T_O_B}, view.T_B_C, observations(view)});
    }
  }
  return found;
}

std::map<Timestamp, std::size_t> TrajectorySmoother::keyframe_numbers() const {
  std::map<Timestamp, std::size_t> numbers;
  for (const Session& session : sessions_)
    for (std::size_t k = 0; k < session.keyframes.size(); ++k)
      numbers.insert_or_assign(session.keyframes[k].t, session.first_keyframe + k);
  return numbers;
}

SE3 TrajectorySmoother::Solution::at(const TrajectorySmoother& record, Timestamp t) const {
  std::size_t start = 0;
  while (start + 1 < record.sessions_.size() && record.sessions_[start + 1].start.t <= t) ++start;
  return between(T_M_O[start], t);
}

TrajectorySmoother::Solution TrajectorySmoother::solve(const OdomToMap& odom_to_map,
                                                       const std::optional<Closed>& closed) const {
  std::size_t views = 0;
  for (const Session& session : sessions_) views += session.views.size();
  const std::size_t of = views / kMapTuning.joint_images + 1;
  const Fit together(*this, odom_to_map, closed, of);
  const std::optional<Fit> chain =
      of > 1 ? std::optional<Fit>(std::in_place, *this, odom_to_map, closed, 1, &together) : std::nullopt;
  const Fit& fit = chain ? *chain : together;
  Solution solution;
  for (std::size_t i = 0; i < sessions_.size(); ++i) solution.T_M_O.push_back(fit.T_M_O(i));
  for (std::size_t k = 0; k < keyframes_; ++k) solution.keyframes.push_back(fit.keyframe(k));
  return solution;
}

Trajectory TrajectorySmoother::path(const OdomToMap& odom_to_map, const Solution& solution,
                                    const Trajectory& placed) const {
  const bool as_given = !relocalized();
  Trajectory path;
  auto next = placed.begin();
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    const Session& session = sessions_[i];
    Trajectory moved;  // T_M_O, with the correction of the causal pose
    for (const auto& [t, T_O_B] : session.causal) {
      while (next != placed.end() && next->t < t) ++next;
      if (next != placed.end() && next->t == t) moved.push_back({t, next->T * T_O_B.inverse()});
    }
    for (const auto& [t, T_O_B] : session.causal) {
      const SE3 T_M_B = !moved.empty() ? between(moved, t) * T_O_B
                        : as_given     ? odom_to_map.T_M_O(i, t) * T_O_B
                                       : between(solution.T_M_O[i], t) * between(session.refined, t) * T_O_B;
      path.push_back({t, T_M_B});
    }
  }
  return path;
}

}  // namespace edged
