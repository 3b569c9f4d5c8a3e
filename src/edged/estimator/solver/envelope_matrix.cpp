// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/envelope_matrix.hpp"

namespace edged {

EnvelopeMatrix::EnvelopeMatrix(std::span<const Rows> blocks) {
  std::ptrdiff_t stored = 0;
  Index rows = 0;
  for (const Rows& block : blocks) {
    rows += block.size;
    for (Index i = 0; i < block.size; ++i) {
      first_.push_back(block.first);
      start_.push_back(stored - block.first);
      stored += rows - block.first;
    }
  }
  values_.assign(static_cast<std::size_t>(stored), 0.0);
}

EnvelopeMatrix::EnvelopeMatrix(const Eigen::MatrixXd& lower)
    : EnvelopeMatrix(std::vector<Rows>(static_cast<std::size_t>(lower.rows()), Rows{1, 0})) {
  for (Index i = 0; i < size(); ++i)
    for (Index j = 0; j <= i; ++j) row(i)[j] = lower(i, j);
}

Eigen::VectorXd EnvelopeMatrix::diagonal() const {
  Eigen::VectorXd entries(size());
  for (Index i = 0; i < size(); ++i) entries[i] = row(i)[i];
  return entries;
}

void EnvelopeMatrix::scale(const Eigen::VectorXd& S) {
  for (Index i = 0; i < size(); ++i) {
    double* entries = row(i);
    for (Index j = first(i); j <= i; ++j) entries[j] *= S[i] * S[j];
  }
}

Eigen::MatrixXd EnvelopeMatrix::dense() const {
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size(), size());
  for (Index i = 0; i < size(); ++i)
    for (Index j = first(i); j <= i; ++j) H(i, j) = row(i)[j];
  return H;
}

}  // namespace edged
