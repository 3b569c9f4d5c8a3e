// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/landmark_equations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "edged/core/statistics.hpp"
#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
/// A Jacobian of a residual, transposed: products of two are then made of vectors.
template <int Size>
using Transposed = Eigen::Matrix<double, Size, 2>;

/// J_a^T J_b, row by row as it is added; lazy, as it is too small for the kernel that Eigen takes otherwise.
template <int Rows, int Columns>
Eigen::Matrix<double, Rows, Columns, Eigen::RowMajor> product(const Transposed<Rows>& a, const Transposed<Columns>& b) {
  return a.lazyProduct(b.transpose());
}

/// A residual at the weight of its loss, and its Jacobians: by the poses of the anchor, of the observation and of the
/// one before; by the calibrations of the anchor's camera and of another observing camera; by the inverse depth.
struct WeightedResidual {
  Vector2d r;
  Transposed<6> anchor, seen, before;
  Transposed<kCalibrationSize> calibration, seen_calibration;
  Vector2d depth;
};

WeightedResidual weighted(const LandmarkResidual& at, const ObservationError& error, const ObservationError& before,
                          const ceres::LossFunction& loss, bool other_camera) {
  WeightedResidual out;
  out.r = at.weight * (error.e - at.correlation * before.e);
  double rho[3];
  loss.Evaluate(out.r.squaredNorm(), rho);
  const double root = std::sqrt(rho[1]), weight = at.weight * root, weight_before = -at.correlation * weight;
  out.r *= root;
  out.anchor = weight * error.by_anchor.transpose();
  out.calibration = weight * error.by_anchor_calibration.transpose();
  if (other_camera) out.seen_calibration = weight * error.by_seen_calibration.transpose();
  out.depth = weight * error.by_rho;
  out.seen = weight * error.by_seen.transpose();
  out.before.setZero();
  if (at.correlation == 0.0) return out;
  out.anchor += weight_before * before.by_anchor.transpose();
  out.calibration += weight_before * before.by_anchor_calibration.transpose();
  if (other_camera) out.seen_calibration += weight_before * before.by_seen_calibration.transpose();
  out.depth += weight_before * before.by_rho;
  out.before = weight_before * before.by_seen.transpose();
  return out;
}

template <int Rows, int Columns>
Eigen::Matrix<double, Rows, Columns, Eigen::RowMajor> outer(const Eigen::Matrix<double, Rows, 1>& a,
                                                            const Eigen::Matrix<double, Columns, 1>& b) {
  return a.lazyProduct(b.transpose());
}

/// J^T J, of its lower triangle the blocks of six, and the rows that are left over.
template <int Size>
void add_lower(const Transposed<Size>& J, Eigen::Matrix<double, Size, Size, Eigen::RowMajor>& H) {
  constexpr int kWhole = Size / 6 * 6, kRest = Size - kWhole;
  for (int i = 0; i < kWhole; i += 6) {
    const Transposed<6> row = J.template middleRows<6>(i);
    for (int j = 0; j <= i; j += 6) H.template block<6, 6>(i, j) += product<6, 6>(row, J.template middleRows<6>(j));
  }
  if constexpr (kRest > 0) {
    for (int j = 0; j < kWhole; j += 6)
      H.template block<kRest, 6>(kWhole, j) +=
          product<kRest, 6>(J.template bottomRows<kRest>(), J.template middleRows<6>(j));
    H.template block<kRest, kRest>(kWhole, kWhole) +=
        product<kRest, kRest>(J.template bottomRows<kRest>(), J.template bottomRows<kRest>());
  }
}

/// The entry of the block at a column, added if missing.
template <typename Coupling>
std::size_t entry_of(Index global, std::vector<Coupling>& couplings) {
  const auto found = std::ranges::find(couplings, global, &Coupling::global);
  const auto entry = static_cast<std::size_t>(found - couplings.begin());
  if (found == couplings.end()) couplings.push_back({global});
  return entry;
}

}  // namespace

LandmarkEquations::LandmarkEquations(const Window& window, const Layout& layout, NormalEquations& equations,
                                     Purpose purpose)
    : layout_(layout), equations_(equations), purpose_(purpose), views_(window), loss_(visual_loss()) {
  constexpr Index kNowhere = -1;  // of a block that no term knows
  const auto place_of = [&](BlockKey key) {
    const auto found = layout.offset.find(key);
    return found == layout.offset.end() ? kNowhere : found->second;
  };
  for (const auto& [id, state] : window.states()) poses_.push_back(place_of({BlockKind::Pose, id}));
  for (std::size_t i = 0; i < window.cameras().size(); ++i) {
    calibrations_.push_back(place_of({BlockKind::Calibration, i}));
  }
}

void LandmarkEquations::place(const LandmarkTerm& term) {
  H_.setZero();
  g_.setZero();
  coupling_.setZero();
  depth_ = {};
  depth_.landmark = term.id;
  depth_.poses.reserve(term.residuals.size() + 1);
  depth_.poses.push_back({poses_[term.anchor_place]});
  depth_.calibrations.push_back({calibrations_[term.anchor.camera]});
  pose_of_.clear();
  calibration_of_.clear();
  for (const LandmarkResidual& residual : term.residuals) {
    pose_of_.push_back(entry_of(poses_[residual.place], depth_.poses));
    calibration_of_.push_back(entry_of(calibrations_[residual.seen.camera], depth_.calibrations));
  }
}

/// use(index of the residual, error, error before); rho: see LandmarkDerivatives.
template <typename Use>
void LandmarkEquations::linearise(const LandmarkTerm& term, double rho, const Use& use) const {
  const AnchoredLandmark landmark(views_.at(term.anchor.camera, term.anchor_place), term.point, *term.inverse_depth);
  const LandmarkDerivatives derivatives(landmark, rho);
  ObservationError error, before;
  bool defined = false, before_defined = false;
  for (std::size_t i = 0; i < term.residuals.size(); ++i) {
    const LandmarkResidual& at = term.residuals[i];
    before = error;
    before_defined = defined;
    defined = derivatives.error(views_.at(at.seen.camera, at.place), at.point, error);
    if (defined && (before_defined || at.correlation == 0.0)) use(i, error, before);
  }
}

/// The expectation of an estimate's square exceeds the square by the variance: with two sigmas, because landmarks are
/// chosen by their parallax.
double LandmarkEquations::certain_inverse_depth(const LandmarkTerm& term) const {
  const double rho = *term.inverse_depth;
  double h = 0.0;
  linearise(term, rho, [&](std::size_t residual, const ObservationError& error, const ObservationError& before) {
    const LandmarkResidual& at = term.residuals[residual];
    h += weighted(at, error, before, loss_, at.seen.camera != term.anchor.camera).depth.squaredNorm();
  });
  const double squared = square(rho) - square(kLandmarkTuning.certain_sigmas) / std::max(h, kNoInformation);
  return std::copysign(std::sqrt(std::max(squared, 0.0)), rho);
}

/// One residual of the term, at the weight of its loss.
void LandmarkEquations::accumulate(std::size_t residual, const ObservationError& error, const ObservationError& before,
                                   const LandmarkTerm& term) {
  const LandmarkResidual& at = term.residuals[residual];
  const bool correlated = at.correlation != 0.0;
  WeightedResidual J = weighted(at, error, before, loss_, calibration_of_[residual] != 0);
  const std::size_t seen = pose_of_[residual], seen_before = correlated ? pose_of_[residual - 1] : 0;
  // Another camera at the anchor's own state.
  if (seen == 0) J.anchor += std::exchange(J.seen, Transposed<6>::Zero());
  if (correlated && seen_before == 0) J.anchor += std::exchange(J.before, Transposed<6>::Zero());

  const Index anchor_calibration = depth_.calibrations.front().global;
  DepthByPose &anchor = depth_.poses.front(), &view = depth_.poses[seen], &view_before = depth_.poses[seen_before];
  const auto add_view = [&](DepthByPose& of, const Transposed<6>& J_view) {
    of.coupling += J_view * J.depth;
    equations_.g.segment<6>(of.global) += J_view * J.r;
    equations_.add(of.global, of.global, product(J_view, J_view));
    equations_.add(of.global, anchor.global, product(J_view, J.anchor));
    equations_.add(anchor_calibration, of.global, product(J.calibration, J_view));
  };
  if (seen != 0) add_view(view, J.seen);
  if (seen_before != 0) {
    add_view(view_before, J.before);
    equations_.add(view.global, view_before.global, product(J.seen, J.before));
  }
  if (calibration_of_[residual] != 0) {
    DepthByCalibration& camera = depth_.calibrations[calibration_of_[residual]];
    camera.coupling += J.seen_calibration * J.depth;
    equations_.g.segment<kCalibrationSize>(camera.global) += J.seen_calibration * J.r;
    equations_.add(camera.global, camera.global, product(J.seen_calibration, J.seen_calibration));
    equations_.add(camera.global, anchor_calibration, product(J.seen_calibration, J.calibration));
    equations_.add(camera.global, anchor.global, product(J.seen_calibration, J.anchor));
    if (seen != 0) equations_.add(camera.global, view.global, product(J.seen_calibration, J.seen));
    if (seen_before != 0) equations_.add(camera.global, view_before.global, product(J.seen_calibration, J.before));
  }
  Transposed<kOwn> own;
  own << J.anchor, J.calibration;
  add_lower(own, H_);
  g_ += own * J.r;
  coupling_ += own * J.depth;
  depth_.h += J.depth.squaredNorm();
  depth_.g += J.depth.dot(J.r);
}

/// Adds the part of the anchor and of the calibration of its camera, common to all residuals.
void LandmarkEquations::add_own() {
  const Index anchor = depth_.poses.front().global, calibration = depth_.calibrations.front().global;
  equations_.add(anchor, anchor, H_.topLeftCorner<6, 6>());
  equations_.add(calibration, anchor, H_.bottomLeftCorner<kCalibrationSize, 6>());
  equations_.add(calibration, calibration, H_.bottomRightCorner<kCalibrationSize, kCalibrationSize>());
  equations_.g.segment<6>(anchor) += g_.head<6>();
  equations_.g.segment<kCalibrationSize>(calibration) += g_.tail<kCalibrationSize>();
  depth_.poses.front().coupling = coupling_.head<6>();
  depth_.calibrations.front().coupling = coupling_.tail<kCalibrationSize>();
}

void LandmarkEquations::add_depth(Index place) {
  for (const DepthByPose& pose : depth_.poses) equations_.add(place, pose.global, pose.coupling.transpose());
  for (const DepthByCalibration& camera : depth_.calibrations) {
    equations_.add(place, camera.global, camera.coupling.transpose());
  }
  equations_.H.row(place)[place] += depth_.h;
  equations_.g[place] += depth_.g;
}

/// Eliminates the inverse depth (docs/math.md, S1).
void LandmarkEquations::eliminate_depth() {
  for (std::size_t i = 0; i < depth_.poses.size(); ++i) {
    const DepthByPose& row = depth_.poses[i];
    const Vector6d row_share = row.coupling / -depth_.h;
    for (std::size_t j = 0; j <= i; ++j) {
      const DepthByPose& column = depth_.poses[j];
      equations_.add(row.global, column.global, outer(row_share, column.coupling));
    }
    equations_.g.segment<6>(row.global) += row_share * depth_.g;
  }
  for (std::size_t i = 0; i < depth_.calibrations.size(); ++i) {
    const DepthByCalibration& row = depth_.calibrations[i];
    const CalibrationVector share = row.coupling / -depth_.h;
    for (const DepthByPose& pose : depth_.poses) {
      equations_.add(row.global, pose.global, outer(share, pose.coupling));
    }
    for (std::size_t j = 0; j <= i; ++j) {
      const DepthByCalibration& column = depth_.calibrations[j];
      equations_.add(row.global, column.global, outer(share, column.coupling));
    }
    equations_.g.segment<kCalibrationSize>(row.global) += share * depth_.g;
  }
}

void LandmarkEquations::add(const LandmarkTerm& term, std::vector<DepthEquation>* eliminated) {
  if (term.residuals.empty()) return;
  place(term);
  const double rho = purpose_ == Purpose::Information ? certain_inverse_depth(term) : *term.inverse_depth;
  linearise(term, rho, [&](std::size_t residual, const ObservationError& error, const ObservationError& before) {
    accumulate(residual, error, before, term);
  });
  add_own();
  if (term.coupled) {
    add_depth(layout_.offset.at({BlockKind::InverseDepth, term.id}));
  } else if (depth_.h > kNoInformation) {
    eliminate_depth();
    if (eliminated != nullptr) eliminated->push_back(std::move(depth_));
  }
}

void LandmarkEquations::add_gradient(const LandmarkTerm& term, DepthEquation* earlier) {
  Eigen::VectorXd& g = equations_.g;
  const Index anchor = poses_[term.anchor_place], anchor_calibration = calibrations_[term.anchor.camera];
  double g_depth = 0.0;
  const double rho = *term.inverse_depth;
  linearise(term, rho, [&](std::size_t residual, const ObservationError& error, const ObservationError& before) {
    const LandmarkResidual& at = term.residuals[residual];
    const bool other_camera = at.seen.camera != term.anchor.camera;
    const WeightedResidual J = weighted(at, error, before, loss_, other_camera);
    g.segment<6>(anchor) += J.anchor * J.r;
    g.segment<6>(poses_[at.place]) += J.seen * J.r;
    if (at.correlation != 0.0) g.segment<6>(poses_[term.residuals[residual - 1].place]) += J.before * J.r;
    g.segment<kCalibrationSize>(anchor_calibration) += J.calibration * J.r;
    if (other_camera) g.segment<kCalibrationSize>(calibrations_[at.seen.camera]) += J.seen_calibration * J.r;
    g_depth += J.depth.dot(J.r);
  });
  if (term.coupled) {
    g[layout_.offset.at({BlockKind::InverseDepth, term.id})] += g_depth;
  } else if (earlier != nullptr) {
    earlier->g = g_depth;
    const double share = -g_depth / earlier->h;
    for (const DepthByPose& pose : earlier->poses) g.segment<6>(pose.global) += share * pose.coupling;
    for (const DepthByCalibration& camera : earlier->calibrations)
      g.segment<kCalibrationSize>(camera.global) += share * camera.coupling;
  }
}

double value_of(const LandmarkTerm& term, const CameraPoses& views, const ceres::LossFunction& loss) {
  const CameraView anchor = views.at(term.anchor.camera, term.anchor_place);
  const AnchoredLandmark landmark(anchor, term.point, *term.inverse_depth);
  double sum = 0.0;
  Vector2d e = Vector2d::Zero(), before;
  for (const LandmarkResidual& at : term.residuals) {
    before = e;
    if (!landmark.error(views.at(at.seen.camera, at.place), at.point, e))
      return std::numeric_limits<double>::infinity();
    double rho[3];
    loss.Evaluate((at.weight * (e - at.correlation * before)).squaredNorm(), rho);
    sum += 0.5 * rho[0];
  }
  return sum;
}

}  // namespace edged
