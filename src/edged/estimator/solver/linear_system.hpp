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

namespace edged {

/// The first column of each block's tangent: marginalized blocks in front; motions first, as they are coupled to their
/// neighbours only (EnvelopeCholesky); each part in the order of the keys.
struct Layout {
  explicit Layout(const std::set<BlockKey>& blocks, const std::set<BlockKey>& leaving = {});

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
  explicit NormalEquations(Eigen::Index size) : H(Eigen::MatrixXd::Zero(size, size)), g(Eigen::VectorXd::Zero(size)) {}

  /// The equations of one term; `blocks` in the order of their local columns.
  void add(const Eigen::Ref<const Eigen::MatrixXd>& term_H, const Eigen::Ref<const Eigen::VectorXd>& term_g,
           std::span<const Placed> blocks);
  void add_gradient(const Eigen::Ref<const Eigen::VectorXd>& term_g, std::span<const Placed> blocks);
  /// The coupling of the block at `row` to that at `column`.
  template <int Rows, int Columns>
  void add(Eigen::Index row, Eigen::Index column, const Eigen::Matrix<double, Rows, Columns>& part) {
    if (row >= column) {
      H.block<Rows, Columns>(row, column) += part;
    } else {
      H.block<Columns, Rows>(column, row) += part.transpose();
    }
  }

  Eigen::MatrixXd H;
  Eigen::VectorXd g;
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
Eigen::VectorXd unit_diagonal_scale(const Eigen::MatrixXd& H);

/// A diagonal entry of H below this has no information.
inline constexpr double kNoInformation = 1e-9;

}  // namespace edged
