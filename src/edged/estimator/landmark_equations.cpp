// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/landmark_equations.hpp"

#include <cmath>
#include <limits>

namespace edged {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Matrix26 = Eigen::Matrix<double, 2, 6>;

constexpr Index kCalibration = 6, kDepth = 10, kViews = 11;  // first columns of a landmark's own equations

Index view_column(std::size_t residual) { return kViews + 6 * static_cast<Index>(residual); }

}  // namespace

LandmarkEquations::LandmarkEquations(Window& window, const Layout& layout, Linearisation at)
    : layout_(layout),
      present_(window),
      taken_(at == Linearisation::Present ? present_ : CameraViews::at_first_estimates(window)),
      at_present_(at == Linearisation::Present),
      loss_(window.visual_loss()) {}

/// One residual of the term, at the weight of its loss.
void LandmarkEquations::accumulate(std::size_t residual, const ObservationError& error, const ObservationError& before,
                                   const LandmarkTerm& term) {
  const LandmarkResidual& at = term.residuals[residual];
  const double correlation = at.correlation;
  Vector2d r = at.weight * (error.e - correlation * before.e);
  double rho[3];
  loss_->Evaluate(r.squaredNorm(), rho);
  const double root = std::sqrt(rho[1]), weight = at.weight * root, weight_before = -correlation * weight;
  r *= root;
  Eigen::Matrix<double, 2, kViews> J;
  Matrix26 J_seen = weight * error.by_seen, J_before = Matrix26::Zero();
  J << weight * error.by_anchor, weight * error.by_calibration, weight * error.by_rho;
  const Index column = view_column(residual);
  r -= J_seen * taken_.moved(at.place);
  if (correlation != 0.0) {
    J.leftCols<6>() += weight_before * before.by_anchor;
    J.middleCols<4>(kCalibration) += weight_before * before.by_calibration;
    J.col(kDepth) += weight_before * before.by_rho;
    J_before = weight_before * before.by_seen;
    r -= J_before * taken_.moved(term.residuals[residual - 1].place);
    H_.block<6, kViews>(column - 6, 0).noalias() += J_before.transpose() * J;
    H_.block<6, 6>(column - 6, column - 6).noalias() += J_before.transpose() * J_before;
    H_.block<6, 6>(column, column - 6).noalias() += J_seen.transpose() * J_before;
  }
  r -= J.leftCols<6>() * taken_.moved(term.anchor_place);
  if (correlation != 0.0) g_.segment<6>(column - 6).noalias() += J_before.transpose() * r;
  H_.topLeftCorner<kViews, kViews>().noalias() += J.transpose() * J;
  H_.block<6, kViews>(column, 0).noalias() += J_seen.transpose() * J;
  H_.block<6, 6>(column, column).noalias() += J_seen.transpose() * J_seen;
  g_.head<kViews>().noalias() += J.transpose() * r;
  g_.segment<6>(column).noalias() += J_seen.transpose() * r;
}

/// Residuals at the present values, Jacobians where they are taken.
void LandmarkEquations::linearise(const LandmarkTerm& term) {
  const Index size = view_column(term.residuals.size());
  H_.setZero(size, size);
  g_.setZero(size);
  const CameraViews &now = present_, &taken = taken_;
  const std::size_t c = term.camera;
  const AnchoredLandmark landmark(now.camera(c), now.at(c, term.anchor_place), term.point, *term.inverse_depth);
  const AnchoredLandmark first(taken.camera(c), taken.at(c, term.anchor_place), term.point, *term.inverse_depth);
  const LandmarkDerivatives derivatives(first);
  ObservationError error, before;
  bool defined = false, before_defined = false;
  for (std::size_t i = 0; i < term.residuals.size(); ++i) {
    const LandmarkResidual& at = term.residuals[i];
    before = error;
    before_defined = defined;
    defined = derivatives.error(taken.at(c, at.place), at.point, error) &&
              (at_present_ || landmark.error(now.at(c, at.place), at.point, error.e));
    if (defined && (before_defined || at.correlation == 0.0)) accumulate(i, error, before, term);
  }
}

void LandmarkEquations::place(const LandmarkTerm& term) {
  const auto at = [&](BlockKind kind, std::uint64_t id) { return layout_.offset.at({kind, id}); };
  blocks_.clear();
  blocks_.push_back({0, 6, at(BlockKind::Pose, term.anchor)});
  blocks_.push_back({kCalibration, 4, at(BlockKind::Calibration, term.camera)});
  if (term.coupled) blocks_.push_back({kDepth, 1, at(BlockKind::InverseDepth, term.id)});
  for (std::size_t i = 0; i < term.residuals.size(); ++i) {
    blocks_.push_back({view_column(i), 6, at(BlockKind::Pose, term.residuals[i].seen)});
  }
}

void LandmarkEquations::eliminate_depth(const LandmarkTerm& term, std::vector<EliminatedDepth>* eliminated) {
  const double h = H_(kDepth, kDepth), g = g_[kDepth];
  if (!(h > kNoInformation)) return;
  const Index views = H_.rows() - kViews;
  coupling_.resize(H_.rows());
  coupling_ << H_.row(kDepth).head<kDepth>().transpose(), 0.0, H_.col(kDepth).tail(views);
  H_.selfadjointView<Eigen::Lower>().rankUpdate(coupling_, -1.0 / h);
  g_ -= coupling_ * (g / h);
  if (eliminated != nullptr) eliminated->push_back({term.inverse_depth, h, g, coupling_, blocks_});
}

void LandmarkEquations::add(const LandmarkTerm& term, NormalEquations& equations,
                            std::vector<EliminatedDepth>* eliminated) {
  if (term.residuals.empty()) return;
  linearise(term);
  place(term);
  if (!term.coupled) eliminate_depth(term, eliminated);
  equations.add(H_, g_, blocks_);
}

double value_of(const LandmarkTerm& term, const CameraViews& views, const ceres::LossFunction& loss) {
  const std::size_t c = term.camera;
  const AnchoredLandmark landmark(views.camera(c), views.at(c, term.anchor_place), term.point, *term.inverse_depth);
  double sum = 0.0;
  Vector2d e = Vector2d::Zero(), before;
  for (const LandmarkResidual& at : term.residuals) {
    before = e;
    if (!landmark.error(views.at(c, at.place), at.point, e)) return std::numeric_limits<double>::infinity();
    double rho[3];
    loss.Evaluate((at.weight * (e - at.correlation * before)).squaredNorm(), rho);
    sum += 0.5 * rho[0];
  }
  return sum;
}

}  // namespace edged
