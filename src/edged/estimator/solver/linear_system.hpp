// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Normal equations over blocks: linearization points, sums of terms, eliminated landmarks.
#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "edged/estimator/factors/blocks.hpp"
#include "edged/estimator/solver/envelope_matrix.hpp"

namespace edged {

/// The first column of each block's tangent: marginalized blocks in front; motions first, as they are coupled to their
/// neighbours only (EnvelopeCholesky); each part in the order of the keys.
struct Layout {
  explicit Layout(const std::set<BlockKey>& blocks, const std::set<BlockKey>& leaving = {});
  /// In the given order.
  explicit Layout(std::span<const BlockKey> order);

  /// The zeros in front of each block's rows, where not all blocks are coupled to the first ones.
  std::vector<EnvelopeMatrix::Rows> envelope;
  std::map<BlockKey, Eigen::Index> offset;
  std::vector<BlockKey> staying;
  Eigen::Index leaving = 0;  ///< columns of the marginalized blocks
  Eigen::Index size = 0;
};

/// The column of a block in the equations of a term, and in those of the window.
struct Placed {
  Eigen::Index local, size, global;
};

/// H d = -g over the tangent steps d. Only the lower triangle of H is used.
struct NormalEquations {
  explicit NormalEquations(const Layout& layout) : H(layout.envelope), g(Eigen::VectorXd::Zero(layout.size)) {}
  /// For the gradient alone.
  explicit NormalEquations(Eigen::Index size) : g(Eigen::VectorXd::Zero(size)) {}

  /// The equations of one term; `blocks` in the order of their local columns.
  void add(const Eigen::Ref<const Eigen::MatrixXd>& term_H, const Eigen::Ref<const Eigen::VectorXd>& term_g,
           std::span<const Placed> blocks);
  void add_gradient(const Eigen::Ref<const Eigen::VectorXd>& term_g, std::span<const Placed> blocks);
  /// The coupling of the block at `row` to that at `column`.
  template <typename Part>
  void add(Eigen::Index row, Eigen::Index column, const Eigen::MatrixBase<Part>& part) {
    if (row >= column) {
      add_lower(row, column, part.derived());
    } else {
      add_lower(column, row, part.transpose());
    }
  }

  EnvelopeMatrix H;
  Eigen::VectorXd g;

 private:
  template <typename Part>
  void add_lower(Eigen::Index row, Eigen::Index column, const Part& part) {
    using Entries = Eigen::Matrix<double, 1, Part::ColsAtCompileTime>;
    for (Eigen::Index i = 0; i < part.rows(); ++i)
      Eigen::Map<Entries>(H.row(row + i) + column, part.cols()) += part.row(i);
  }
};

/// The coupling of a landmark's inverse depth and the pose of one of its views.
struct DepthByPose {
  Eigen::Index global = 0;
  Vector6d coupling = Vector6d::Zero();
};

/// The coupling of a landmark's inverse depth and the calibration of one of its cameras.
struct DepthByCalibration {
  Eigen::Index global = 0;
  CalibrationVector coupling = CalibrationVector::Zero();
};

/// A landmark's inverse depth in the normal equations; eliminated from them, its step is -(g + couplings^T d) / h.
struct DepthEquation {
  std::uint64_t landmark = 0;  ///< FeatureId
  double h = 0.0, g = 0.0;
  std::vector<DepthByPose> poses;                ///< each once: the anchor's, then those of other observing states
  std::vector<DepthByCalibration> calibrations;  ///< each once, in the same order
};

/// S with ones on the diagonal of S H S, zero where H is zero: positions, angles and biases differ in
/// information by ten orders of magnitude.
Eigen::VectorXd unit_diagonal_scale(const Eigen::VectorXd& diagonal_of_H);

/// A diagonal entry of H below this has no information.
inline constexpr double kNoInformation = 1e-9;

}  // namespace edged
