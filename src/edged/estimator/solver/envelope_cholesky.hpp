// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// H = L L^T without the zeros in front of each row, which L has in the same places. The motion blocks of a window are
// coupled to their neighbours only: ordered first, they leave a third of the products.
#pragma once

#include <Eigen/Core>

namespace edged {

class EnvelopeCholesky {
 public:
  /// Factorizes H + damping I; only the lower triangle of H is read. False if that is not positive definite.
  bool factorise(const Eigen::MatrixXd& H, double damping = 0.0);
  /// H^-1 b
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// The last rows and columns of L: the factor of the Schur complement of all before them.
  Eigen::MatrixXd last_of_L(Eigen::Index size) const { return L_.bottomRightCorner(size, size); }

 private:
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> L_;
  Eigen::Matrix<Eigen::Index, Eigen::Dynamic, 1> first_;  ///< column of a row that is not zero
  Eigen::VectorXd inverse_;                               ///< inverse of the diagonal
};

}  // namespace edged
