// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/trajectory_smoother.hpp"

#include <algorithm>
#include <iterator>
#include <optional>

#include "edged/core/angles.hpp"
#include "edged/map/pose_graph.hpp"

namespace edged {
namespace {

// Of the odometry's drift as the filter has it: looks at both ends of a stretch tell more of it than those behind.
constexpr double kFinalDriftScale = 3.0;
constexpr double kTiltAtStart_rad = 0.2 * kDegree;
constexpr double kRigid = 1e-4;  // [m], [rad]: between keyframes of another run
// Looks that are fitted with the keyframes: each hangs together with the one before and with most keyframes, and time
// and memory grow faster than their number.
constexpr std::size_t kMostTogether = 500;

/// Of where the odometry starts, against where it ended.
Matrix6d start_covariance(double position_sigma, double yaw_sigma) {
  Matrix6d P = Matrix6d::Zero();
  P.diagonal().head<3>().setConstant(position_sigma * position_sigma);
  P.diagonal().tail<3>().setConstant(yaw_sigma * yaw_sigma + kTiltAtStart_rad * kTiltAtStart_rad);
  return P;
}

}  // namespace

/// The graph of all sessions: an instant that something is known of is a pose, drift of the odometry lies between.
class TrajectorySmoother::Fit {
 public:
  /// One look of so many. together: keyframes stay where that has found them, which leaves a chain, of which time and
  /// memory are linear.
  Fit(const TrajectorySmoother& record, std::size_t of, const Fit* together = nullptr)
      : config_(record.config_), of_(of), together_(together), keyframes_(record.keyframes_) {
    config_.drift_m *= kFinalDriftScale;
    config_.drift_yaw_deg *= kFinalDriftScale;
    config_.drift_tilt_deg *= kFinalDriftScale;
    for (std::size_t k = 0; k < record.loaded_.size(); ++k) add_loaded(k, record.loaded_);
    for (const Session& session : record.sessions_) add_session(session);
    for (const Session& session : record.sessions_)
      add_observations(session, nodes_[&session - record.sessions_.data()]);
    if (record.relocalized()) graph_.solve();
  }

  const SE3& keyframe(std::size_t number) const { return graph_.poses()[keyframes_[number]]; }
  std::vector<Moved> T_M_O(std::size_t session) const {
    std::vector<Moved> found;
    for (const auto& [t, node] : nodes_[session])
      found.push_back({t, graph_.poses()[node.number] * node.T_O_B.inverse()});
    return found;
  }

 private:
  void add_loaded(std::size_t k, std::span<const SE3> T_M_K) {
    keyframes_[k] = together_ ? graph_.add_known_pose(together_->keyframe(k)) : graph_.add_pose(T_M_K[k]);
    if (k > 0) graph_.add_step(k - 1, k, T_M_K[k - 1].inverse() * T_M_K[k], kRigid * kRigid * Matrix6d::Identity());
  }

  void add_session(const Session& session) {
    Nodes nodes;
    for (const StampedPose* causal : instants(session))
      nodes[causal->t].T_O_B = between(session.refined, causal->t) * causal->T;
    for (const Keyframe& keyframe : session.keyframes) {
      Node& node = nodes[keyframe.T_O_K.t];
      node.T_O_B = keyframe.T_O_K.T;
      if (together_) node.known = &together_->keyframe(keyframe.number);
    }
    for (auto node = nodes.begin(); node != nodes.end(); ++node) {
      const auto& [t, at] = *node;
      const SE3 T_M_B = at.known ? *at.known : newest(session.T_M_O, t) * at.T_O_B;
      const std::size_t number = node->second.number = at.known ? graph_.add_known_pose(T_M_B) : graph_.add_pose(T_M_B);
      if (node != nodes.begin()) {
        const auto& [t_before, before] = *std::prev(node);
        graph_.add_step(number - 1, number, before.T_O_B.inverse() * at.T_O_B,
                        drift_covariance(config_, T_M_B, to_seconds(t - t_before)));
      } else if (number > 0) {
        graph_.add_step(number - 1, number, graph_.poses()[number - 1].inverse() * T_M_B,
                        start_covariance(session.position_sigma, session.yaw_sigma));
      }
    }
    for (const Keyframe& keyframe : session.keyframes) keyframes_[keyframe.number] = nodes[keyframe.T_O_K.t].number;
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
      std::vector<MapObservation> observations;
      for (const Observation& s : view.observations)
        observations.push_back({keyframes_[s.keyframe], s.p_K.cast<double>(), s.depth_sigma_K.cast<double>(),
                                s.seen.cast<double>(), s.stretch * view.sigma});
      graph_.add_observations(nodes.at(view.T_O_B.t).number, view.T_B_C, observations);
    }
  }

  MapFilterConfig config_;
  std::size_t of_;
  const Fit* together_;
  PoseGraph graph_;
  std::vector<std::size_t> keyframes_;  ///< their numbers in the graph
  std::vector<Nodes> nodes_;            ///< by session
};

bool TrajectorySmoother::relocalized() const {
  return std::ranges::any_of(sessions_, [](const Session& session) { return !session.views.empty(); });
}

/// Between the two around t; the first and the last hold beyond.
SE3 TrajectorySmoother::between(const std::vector<Moved>& moved, Timestamp t) {
  const auto after = std::ranges::upper_bound(moved, t, {}, &Moved::t);
  if (after == moved.begin()) return after->T;
  const auto before = std::prev(after);
  if (after == moved.end()) return before->T;
  return interpolate(before->T, after->T, to_seconds(t - before->t) / to_seconds(after->t - before->t));
}

/// The newest at t, without one the first.
SE3 TrajectorySmoother::newest(const std::vector<Moved>& moved, Timestamp t) {
  const auto after = std::ranges::upper_bound(moved, t, {}, &Moved::t);
  return after == moved.begin() ? after->T : std::prev(after)->T;
}

void TrajectorySmoother::load(std::span<const SE3> T_M_K) {
  loaded_.assign(T_M_K.begin(), T_M_K.end());
  keyframes_ = loaded_.size();
}

void TrajectorySmoother::restart(const StampedPose& T_O_B, const SE3& T_M_O, double position_sigma, double yaw_sigma) {
  sessions_.push_back({T_O_B, position_sigma, yaw_sigma, {{T_O_B.t, T_M_O}}, {}, {{T_O_B.t, SE3()}}, {}, {}});
}

void TrajectorySmoother::forget_guess() {
  std::vector<Moved>& T_M_O = sessions_.back().T_M_O;
  T_M_O.erase(T_M_O.begin(), std::prev(T_M_O.end()));
}

void TrajectorySmoother::move_before(const SE3& T_M_before) {
  for (auto session = sessions_.begin(); session != std::prev(sessions_.end()); ++session) {
    for (Moved& moved : session->T_M_O) moved.T = T_M_before * moved.T;
  }
}

void TrajectorySmoother::add(const StampedPose& T_O_B) { sessions_.back().causal.push_back(T_O_B); }

void TrajectorySmoother::refine(const StampedPose& T_O_K) {
  Session& session = sessions_.back();
  const auto causal = std::ranges::lower_bound(session.causal, T_O_K.t, {}, &StampedPose::t);
  if (causal == session.causal.end() || causal->t != T_O_K.t || session.refined.back().t >= T_O_K.t) return;
  session.refined.push_back({T_O_K.t, T_O_K.T * causal->T.inverse()});
}

std::size_t TrajectorySmoother::add_keyframe(const StampedPose& T_O_K) {
  sessions_.back().keyframes.push_back({T_O_K, keyframes_});
  return keyframes_++;
}

void TrajectorySmoother::add_observations(const StampedPose& T_O_B, const SE3& T_B_C,
                                          std::span<const MapObservation> observations, const SE3& T_M_O) {
  View view{T_O_B, T_B_C, std::ranges::min(observations, {}, &MapObservation::sigma).sigma, {}};
  for (const MapObservation& s : observations)
    view.observations.push_back({static_cast<std::uint32_t>(s.keyframe), s.p_K.cast<float>(),
                                 s.depth_sigma_K.cast<float>(), s.seen.cast<float>(),
                                 static_cast<float>(s.sigma / view.sigma)});
  sessions_.back().T_M_O.push_back({T_O_B.t, T_M_O});
  sessions_.back().views.push_back(std::move(view));
}

TrajectorySmoother::Path TrajectorySmoother::path() const {
  std::size_t looks = 0;
  for (const Session& session : sessions_) looks += session.views.size();
  const std::size_t of = looks / kMostTogether + 1;
  const Fit together(*this, of);
  const std::optional<Fit> chain = of > 1 ? std::optional<Fit>(std::in_place, *this, 1, &together) : std::nullopt;
  const Fit& fit = chain ? *chain : together;
  const bool as_given = !relocalized();
  Path path;
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    const Session& session = sessions_[i];
    const std::vector<Moved> T_M_O = fit.T_M_O(i);
    for (const auto& [t, T_O_B] : session.causal) {
      path.poses.push_back(
          {t, as_given ? newest(session.T_M_O, t) * T_O_B : between(T_M_O, t) * between(session.refined, t) * T_O_B});
    }
  }
  for (std::size_t k = 0; k < keyframes_; ++k) path.keyframes.push_back(fit.keyframe(k));
  return path;
}

}  // namespace edged
