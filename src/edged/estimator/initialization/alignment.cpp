// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/initialization/alignment.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

using Eigen::Vector3d;
using Chosen = InitializationSolver::Chosen;

/// An initialization, its inlier tracks, and the share of the view that they cover.
struct Hypothesis {
  Start x;
  Chosen fit;
  double support = 0.0;
};

Chosen all_of(const InitializationSolver& solver) {
  Chosen all(solver.tracks().size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

/// The weight of a hypothesis. A dynamic object fills a part of the view with features, the static scene all of it: the
/// tracks of one direction share one vote.
class HypothesisScorer {
 public:
  explicit HypothesisScorer(const InitializationSolver& solver) {
    std::map<std::array<long, 3>, double> tracks_in;
    std::vector<std::array<long, 3>> cells;
    for (const std::size_t k : all_of(solver)) {
      const Vector3d cell = solver.direction(k) / kAlignmentTuning.cell_rad;
      cells.push_back({std::lround(cell.x()), std::lround(cell.y()), std::lround(cell.z())});
      ++tracks_in[cells.back()];
    }
    for (const auto& cell : cells) votes_.push_back(1.0 / tracks_in.at(cell));
  }

  Hypothesis scored(const InitializationSolver& solver, const Start& x) const {
    Hypothesis hypothesis{x, {}, 0.0};
    const std::vector<double> misfits = solver.misfits(x);
    for (std::size_t k = 0; k < votes_.size(); ++k) {
      if (misfits[k] > kAlignmentTuning.inlier_sigma) continue;
      hypothesis.fit.push_back(k);
      hypothesis.support += votes_[k] * (1.0 - std::pow(misfits[k] / kAlignmentTuning.inlier_sigma, 2));
    }
    return hypothesis;
  }

  bool fits_nearly_all(const Hypothesis& hypothesis) const {
    return static_cast<double>(hypothesis.fit.size()) >
           kAlignmentTuning.static_share * static_cast<double>(votes_.size());
  }

  /// Tracks at the centres of patches that divide the view.
  Chosen centres() const {
    const double of_a_patch =
        std::max(1.0, std::accumulate(votes_.begin(), votes_.end(), 0.0) / kAlignmentTuning.patches);
    Chosen centres;
    double since_last = of_a_patch;
    for (std::size_t k = 0; k < votes_.size(); ++k) {
      since_last += votes_[k];
      if (since_last < of_a_patch) continue;
      since_last = 0.0;
      centres.push_back(k);
    }
    return centres;
  }

 private:
  std::vector<double> votes_;
};

/// The tracks around one track.
Chosen patch(const InitializationSolver& solver, std::size_t centre) {
  Chosen nearest = all_of(solver);
  const Vector3d there = solver.direction(centre);
  std::vector<double> off;
  for (const std::size_t k : nearest) off.push_back((solver.direction(k) - there).squaredNorm());
  std::stable_sort(nearest.begin(), nearest.end(), [&](std::size_t a, std::size_t b) { return off[a] < off[b]; });
  nearest.resize(std::min(nearest.size(), kAlignmentTuning.patch_tracks));
  return nearest;
}

std::optional<RefinedStart> started(const InitializationSolver& solver, const Chosen& chosen, int iterations) {
  double free_length = 0.0;
  const std::optional<Start> linear = solver.linear(chosen, &free_length);
  return linear ? solver.refine(chosen, *linear, iterations) : std::nullopt;
}

/// The initialization from the tracks of a patch, refined with its inliers; nothing if its support is too small.
std::optional<Hypothesis> grown(const InitializationSolver& solver, const HypothesisScorer& scorer, const Chosen& seed,
                                double wanted) {
  const std::optional<RefinedStart> start = started(solver, seed, kAlignmentTuning.patch_iterations);
  if (!start) return std::nullopt;
  const Hypothesis found = scorer.scored(solver, start->x);
  if (found.fit.size() < kAlignmentTuning.min_tracks || found.support < wanted) return std::nullopt;
  const std::optional<RefinedStart> better = solver.refine(found.fit, found.x, kAlignmentTuning.patch_iterations);
  return better ? std::optional(scorer.scored(solver, better->x)) : std::nullopt;
}

/// The best motion for a gyro bias.
struct Found {
  Vector3d gyro_bias;
  InitializationSolver solver;
  Hypothesis best;
};

bool better(const std::optional<Found>& a, const std::optional<Found>& b) {
  return a && (!b || a->best.support > b->best.support);
}

std::set<FeatureId> outliers_of(const Found& found) {
  std::set<FeatureId> outliers;
  for (const std::size_t k : all_of(found.solver)) {
    if (std::binary_search(found.best.fit.begin(), found.best.fit.end(), k)) continue;
    outliers.insert(found.solver.tracks()[k].id);
  }
  return outliers;
}

std::vector<InitFrame> without(std::vector<InitFrame> frames, const std::set<FeatureId>& left_out) {
  for (InitFrame& frame : frames) {
    for (CameraObservations& view : frame.observations) {
      std::erase_if(view.features, [&](const FeatureObservation& f) { return left_out.contains(f.id); });
    }
  }
  return frames;
}

/// Estimates the motion relative to the static scene from a start-up buffer.
class MotionSearch {
 public:
  MotionSearch(const std::vector<InitFrame>& frames, const Rig& rig, const ImuNoise& noise, const StartPriors& priors)
      : frames_(frames), rig_(rig), noise_(noise), priors_(priors) {}

  /// Dynamic objects bias the gyro bias too: if there are some, it is estimated from the inliers, or is zero at first.
  std::optional<Found> best() {
    if (priors_.gyro_known) return best_at(priors_.biases.gyro);
    std::optional<Found> best = best_at(align_gyro_bias(frames_, rig_, noise_));
    if (!best || scorer_->fits_nearly_all(best->best)) return best;
    std::optional<Found> other = best_at(Vector3d(Vector3d::Zero()));
    for (int round = 0; round < kAlignmentTuning.bias_rounds; ++round) {
      if (better(other, best)) best = std::move(other);
      other = best_at(align_gyro_bias(without(frames_, outliers_of(*best)), rig_, noise_));
    }
    return better(other, best) ? std::move(other) : std::move(best);
  }

  /// The share of the support that an estimate at the last frame explains, too.
  double inlier_share(const Found& found, const OdomState& running) const {
    const double support = scorer_->scored(found.solver, found.solver.start_of(running)).support;
    return std::min(1.0, support / found.best.support);
  }

 private:
  std::optional<Found> best_at(const std::optional<Vector3d>& bias) {
    if (!bias) return std::nullopt;
    InitializationSolver solver(frames_, rig_, *bias, noise_, priors_);
    if (solver.tracks().size() < kAlignmentTuning.min_tracks) return std::nullopt;
    const std::optional<RefinedStart> of_all = started(solver, all_of(solver), kAlignmentTuning.iterations);
    if (!of_all) return std::nullopt;
    if (!scorer_) scorer_.emplace(solver);
    Hypothesis best = best_hypothesis(solver, of_all->x);
    return Found{*bias, std::move(solver), std::move(best)};
  }

  /// If one motion does not fit nearly all tracks, some are on dynamic objects and least squares are biased: then each
  /// patch makes a hypothesis, and the motion that explains the largest part of the view is chosen.
  Hypothesis best_hypothesis(const InitializationSolver& solver, const Start& of_all) const {
    Hypothesis best = scorer_->scored(solver, of_all);
    if (scorer_->fits_nearly_all(best)) {
      best.fit = all_of(solver);
      return best;
    }
    for (const std::size_t centre : scorer_->centres()) {
      std::optional<Hypothesis> found =
          grown(solver, *scorer_, patch(solver, centre), kAlignmentTuning.min_support * best.support);
      if (found && found->support > best.support) best = std::move(*found);
    }
    return best;
  }

  const std::vector<InitFrame>& frames_;
  const Rig& rig_;
  const ImuNoise& noise_;
  const StartPriors& priors_;
  std::optional<HypothesisScorer> scorer_;  ///< made from the first bias, used for all
};

}  // namespace

std::optional<Alignment> align(const std::vector<InitFrame>& frames, const Rig& rig, const ImuNoise& noise,
                               const StartPriors& priors, const OdomState* running) {
  MotionSearch search(frames, rig, noise, priors);
  const std::optional<Found> found = search.best();
  if (!found) return std::nullopt;
  const InitializationSolver& solver = found->solver;
  double free_length = 0.0;
  if (!solver.linear(found->best.fit, &free_length)) return std::nullopt;
  const std::optional<RefinedStart> start = solver.refine(found->best.fit, found->best.x, kAlignmentTuning.iterations);
  if (!start) return std::nullopt;
  const Start& x = start->x;
  const SE3 T_O_B0(Eigen::Quaterniond::FromTwoVectors(-x.segment<3>(3), Vector3d::UnitZ()), Vector3d::Zero());
  Alignment result;
  result.gravity_error = free_length / kGravity - 1.0;
  result.scale_sigma = solver.relative_sigma(*start);
  result.baseline_sigma = solver.baseline_sigma(found->best.fit);
  result.outliers = outliers_of(*found);
  if (running != nullptr) result.inlier_share = search.inlier_share(*found, *running);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const RelativeMotion& m = solver.motion()[i];
    OdomState state;
    state.t = frames[i].t;
    state.T_O_B = T_O_B0 * SE3(m.R, m.position(x));
    state.v_O = T_O_B0.rotation() * m.velocity(x);
    state.bias_gyro = found->gyro_bias;
    state.bias_accel = solver.accel_bias(x);
    result.states.push_back(state);
  }
  return result;
}

}  // namespace edged
