// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The lower triangle of a symmetric matrix, row by row, each without the zeros in front. Of a window all rows begin in
// the first column; of a whole start only those of its calibrations do, and memory grows with the number of states.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace edged {

class EnvelopeMatrix {
 public:
  using Index = Eigen::Index;
  /// The rows of one block of unknowns, which all begin in one column. There is room for the upper triangle of the
  /// block, too, so that whole blocks can be added.
  struct Rows {
    Index size, first;
  };

  EnvelopeMatrix() = default;
  /// Zero.
  explicit EnvelopeMatrix(std::span<const Rows> blocks);
  /// The lower triangle of a dense matrix.
  explicit EnvelopeMatrix(const Eigen::MatrixXd& lower);

  Index size() const { return static_cast<Index>(first_.size()); }
  Index first(Index row) const { return first_[static_cast<std::size_t>(row)]; }
  /// row(i)[j] is the entry (i, j), for j from first(i) to i.
  double* row(Index i) { return values_.data() + start_[static_cast<std::size_t>(i)]; }
  const double* row(Index i) const { return values_.data() + start_[static_cast<std::size_t>(i)]; }

  Eigen::VectorXd diagonal() const;
  /// S H S for a diagonal S.
  void scale(const Eigen::VectorXd& S);
  /// Zero above the diagonal.
  Eigen::MatrixXd dense() const;

 private:
  std::vector<double> values_;
  std::vector<std::ptrdiff_t> start_;  ///< of the entry in column 0, which may lie before the row
  std::vector<Index> first_;
};

}  // namespace edged
