// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Normal equations over blocks: where they are taken, how terms are added, what has been eliminated from them.
#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "edged/estimator/factors/blocks.hpp"

namespace edged {

/// Where each block's tangent begins: those that leave in front, the motions first, which know their neighbours only
/// (EnvelopeCholesky), each part in the order of the keys.
struct Layout {
  explicit Layout(const std::set<BlockKey>& blocks, const std::set<BlockKey>& leaving = {});

  std::map<BlockKey, Eigen::Index> offset;
  std::vector<BlockKey> staying;
  Eigen::Index leaving = 0;  ///< columns of all that leaves
  Eigen::Index size = 0;
};

/// A block's place in a term's own equations and in those of the window.
struct Placed {
  Eigen::Index local, size, global;
};

/// H d = -g over the tangent steps d. Of H the lower triangle counts.
struct NormalEquations {
  explicit NormalEquations(Eigen::Index size) : H(Eigen::MatrixXd::Zero(size, size)), g(Eigen::VectorXd::Zero(size)) {}

  /// A term's own equations; `blocks` in the order of their local places.
  void add(const Eigen::Ref<const Eigen::MatrixXd>& term_H, const Eigen::Ref<const Eigen::VectorXd>& term_g,
           std::span<const Placed> blocks);
  /// What ties the block at `row` to that at `column`.
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

/// Where Jacobians are taken; residuals always at the present values. FirstEstimates: at the
/// Window::linearisation_point of each block, so that directions the measurements cannot see stay unseen; d then counts
/// from there.
enum class Linearisation { Present, FirstEstimates };

/// How a landmark's inverse depth and the pose of one of its views go together.
struct DepthByPose {
  Eigen::Index global = 0;
  Vector6d coupling = Vector6d::Zero();
};

/// The same with the calibration of one of its cameras.
struct DepthByCalibration {
  Eigen::Index global = 0;
  Eigen::Vector4d coupling = Eigen::Vector4d::Zero();
};

/// A landmark's inverse depth in the normal equations; eliminated from them, its step is -(g + couplings^T d) / h.
struct DepthEquation {
  std::uint64_t landmark = 0;  ///< FeatureId
  double h = 0.0, g = 0.0;
  std::vector<DepthByPose> poses;                ///< each once: the anchor's, then the others that see it
  std::vector<DepthByCalibration> calibrations;  ///< each once, in the same order
};

/// S with ones on the diagonal of S H S, zero where nothing was measured: positions, angles and biases differ in
/// information by ten orders of magnitude.
Eigen::VectorXd unit_diagonal_scale(const Eigen::MatrixXd& H);

/// A diagonal entry of H below this was not measured at all.
inline constexpr double kNoInformation = 1e-9;

}  // namespace edged
