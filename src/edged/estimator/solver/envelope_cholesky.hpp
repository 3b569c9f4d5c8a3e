// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// H = L L^T without the zeros in front of each row, which L has in the same places. The motion blocks of a window are
// coupled to their neighbours only: ordered first, they leave a third of the products.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "edged/estimator/solver/envelope_matrix.hpp"

namespace edged {

class EnvelopeCholesky {
 public:
  /// Factorizes H + damping I. False if that is not positive definite.
  bool factorise(const EnvelopeMatrix& H, double damping = 0.0);
  /// H^-1 b
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// The last rows and columns of L: the factor of the Schur complement of all before them.
  Eigen::MatrixXd last_of_L(Eigen::Index size) const;

 private:
  EnvelopeMatrix L_;
  Eigen::Matrix<Eigen::Index, Eigen::Dynamic, 1> first_;  ///< column of a row that is not zero
  Eigen::VectorXd inverse_;                               ///< inverse of the diagonal
};

}  // namespace edged
