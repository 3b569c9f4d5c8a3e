// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/envelope_cholesky.hpp"

#include <algorithm>
#include <cmath>

namespace edged {

using Eigen::Index;

bool EnvelopeCholesky::factorise(const Eigen::MatrixXd& H, double damping) {
  L_ = H;
  L_.diagonal().array() += damping;
  first_.resize(H.rows());
  inverse_.resize(H.rows());
  for (Index i = 0; i < L_.rows(); ++i) {
    auto row = L_.row(i);
    Index& first = first_[i];
    for (first = 0; first < i && row[first] == 0.0;) ++first;
    for (Index j = first; j < i; ++j) {
      const Index k = std::max(first, first_[j]);
      if (k < j) row[j] -= row.segment(k, j - k).dot(L_.row(j).segment(k, j - k));
      row[j] *= inverse_[j];
    }
    const double pivot = row[i] - row.segment(first, i - first).squaredNorm();
    if (!(pivot > 0.0)) return false;
    row[i] = std::sqrt(pivot);
    inverse_[i] = 1.0 / row[i];
  }
  return true;
}

Eigen::VectorXd EnvelopeCholesky::solve(const Eigen::VectorXd& b) const {
  Eigen::VectorXd x = b;
  for (Index i = 0; i < x.size(); ++i) {
    const Index first = first_[i], n = i - first;
    x[i] = (x[i] - L_.row(i).segment(first, n).dot(x.segment(first, n))) * inverse_[i];
  }
  for (Index i = x.size() - 1; i >= 0; --i) {
    const Index first = first_[i], n = i - first;
    x[i] *= inverse_[i];
    x.segment(first, n) -= x[i] * L_.row(i).segment(first, n).transpose();
  }
  return x;
}

}  // namespace edged
