// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/trajectory/pose_graph.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <map>
#include <optional>
#include <utility>

#include "edged/map/tuning.hpp"

namespace edged {
namespace {

constexpr int kIterations = 12;
constexpr int kTrusting = 3;  // of them without a robust loss: after a long drift, inliers have large residuals, too
constexpr double kConverged = 1e-6;  // largest step of an iteration, metres and radians

}  // namespace

/// H dx = -g of the unknown poses, with only the non-zero blocks: of each pair of poses the one with a >= b.
class PoseGraph::Equations {
 public:
  explicit Equations(const PoseGraph& graph) : rows_(graph.rows_), g_(Eigen::VectorXd::Zero(graph.unknowns_)) {}

  void add(std::size_t pose_a, std::size_t pose_b, const Matrix6d& aa, const Matrix6d& ab, const Matrix6d& bb) {
    const Eigen::Index a = rows_[pose_a], b = rows_[pose_b];
    if (a != kKnown) block(a, a) += aa;
    if (b != kKnown) block(b, b) += bb;
    if (a == kKnown || b == kKnown) return;
    if (a > b) {
      block(a, b) += ab;
    } else {
      block(b, a) += ab.transpose();
    }
  }
  void add(std::size_t pose, const Matrix6d& H, const Vector6d& g) {
    if (rows_[pose] != kKnown) block(rows_[pose], rows_[pose]) += H;
    add(pose, g);
  }
  void add(std::size_t pose, const Vector6d& g) {
    if (rows_[pose] != kKnown) g_.segment<6>(rows_[pose]) += g;
  }

  std::optional<Eigen::VectorXd> solved() const {
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& [at, H] : blocks_) {
      for (int column = 0; column < 6; ++column) {
        for (int row = at.first == at.second ? column : 0; row < 6; ++row)
          entries.emplace_back(at.second + row, at.first + column, H(row, column));
      }
    }
    Eigen::SparseMatrix<double> H(g_.size(), g_.size());
    H.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(H);
    if (factors.info() != Eigen::Success) return std::nullopt;
    return factors.solve(-g_);
  }

 private:
  Matrix6d& block(Eigen::Index a, Eigen::Index b) {
    return blocks_.try_emplace({b, a}, Matrix6d::Zero()).first->second;
  }

  const std::vector<Eigen::Index>& rows_;
  std::map<std::pair<Eigen::Index, Eigen::Index>, Matrix6d> blocks_;  ///< by column, then row
  Eigen::VectorXd g_;
};

std::size_t PoseGraph::add_known_pose(const SE3& T_M_B) {
  T_M_B_.push_back(T_M_B);
  rows_.push_back(kKnown);
  return T_M_B_.size() - 1;
}

std::size_t PoseGraph::add_pose(const SE3& T_M_B) {
  const std::size_t pose = add_known_pose(T_M_B);
  if (pose > 0) rows_[pose] = std::exchange(unknowns_, unknowns_ + 6);
  return pose;
}

void PoseGraph::add_step(std::size_t a, std::size_t b, const SE3& T_A_B, const Matrix6d& covariance) {
  steps_.push_back({a, b, T_A_B, covariance.inverse()});
}

void PoseGraph::add_gravity(std::size_t body, const GravityObservation& observation) {
  gravity_.push_back({body, observation});
}

void PoseGraph::add_observations(std::size_t body, std::vector<SE3> T_B_C,
                                 std::span<const MapObservation> observations) {
  views_.push_back({body, std::move(T_B_C), {observations.begin(), observations.end()}});
}

void PoseGraph::take(const Step& step, Equations& equations) const {
  const SE3 &T_M_A = T_M_B_[step.a], expected = T_M_A * step.T_A_B, &found = T_M_B_[step.b];
  Vector6d r;
  r << found.translation() - expected.translation(), so3::log(expected.rotation().conjugate() * found.rotation());
  const Matrix6d by_a = -transport(T_M_A, step.T_A_B), weighed = by_a.transpose() * step.information;
  equations.add(step.a, step.b, weighed * by_a, weighed, step.information);
  equations.add(step.a, weighed * r);
  equations.add(step.b, step.information * r);
}

void PoseGraph::take(const Gravity& gravity, Equations& equations) const {
  const LinearizedGravity row = linearised(gravity.observation, T_M_B_[gravity.body]);
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  H.bottomRightCorner<3, 3>() = row.H;
  g.tail<3>() = row.g;
  equations.add(gravity.body, H, g);
}

void PoseGraph::take(const View& view, bool trusting, Equations& equations) const {
  for (const MapObservation& observation : view.observations) {
    const auto row =
        linearised(observation, T_M_B_[view.body], T_M_B_[observation.keyframe], view.T_B_C[observation.camera]);
    if (!row) continue;
    const Eigen::Matrix2d information = row->R.inverse();
    const double far =
        trusting ? 0.0 : row->r.dot(information * row->r) / (kMapTuning.cauchy_sigmas * kMapTuning.cauchy_sigmas);
    const Eigen::Matrix2d W = information / (1.0 + far);
    const Eigen::Matrix<double, 6, 2> body = row->by_body.transpose() * W, keyframe = row->by_keyframe.transpose() * W;
    equations.add(view.body, observation.keyframe, body * row->by_body, body * row->by_keyframe,
                  keyframe * row->by_keyframe);
    equations.add(view.body, body * row->r);
    equations.add(observation.keyframe, keyframe * row->r);
  }
}

void PoseGraph::solve() {
  if (unknowns_ == 0) return;
  for (int i = 0; i < kIterations; ++i) {
    Equations equations(*this);
    for (const Step& step : steps_) take(step, equations);
    for (const Gravity& gravity : gravity_) take(gravity, equations);
    for (const View& view : views_) take(view, i < kTrusting, equations);
    const std::optional<Eigen::VectorXd> errors = equations.solved();
    if (!errors || !errors->allFinite()) return;
    for (std::size_t k = 0; k < T_M_B_.size(); ++k) {
      if (rows_[k] != kKnown) T_M_B_[k] = corrected(T_M_B_[k], errors->segment<6>(rows_[k]));
    }
    if (i >= kTrusting && errors->lpNorm<Eigen::Infinity>() < kConverged) return;
  }
}

}  // namespace edged
