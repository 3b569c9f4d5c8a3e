// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/envelope_cholesky.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace edged {

using Eigen::Index;

namespace {

constexpr Index kRowsAtOnce = 4;  // at once: they share the loads of the row that they are multiplied with

/// Dot products of row i with each of the rows from j on, over the columns from k up to j.
std::array<double, kRowsAtOnce> dots_of(const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& L,
                                        Index i, Index j, Index k) {
  using Two = Eigen::Array2d;
  const double* row = &L(i, 0);
  const double* of[kRowsAtOnce];
  for (Index m = 0; m < kRowsAtOnce; ++m) of[m] = &L(j + m, 0);
  Two a = Two::Zero(), b = Two::Zero(), c = Two::Zero(), d = Two::Zero();
  for (; k + 2 <= j; k += 2) {
    const Two x = Eigen::Map<const Two>(row + k);
    a += x * Eigen::Map<const Two>(of[0] + k);
    b += x * Eigen::Map<const Two>(of[1] + k);
    c += x * Eigen::Map<const Two>(of[2] + k);
    d += x * Eigen::Map<const Two>(of[3] + k);
  }
  std::array<double, kRowsAtOnce> sums = {a.sum(), b.sum(), c.sum(), d.sum()};
  if (k < j) {
    for (Index m = 0; m < kRowsAtOnce; ++m) sums[static_cast<std::size_t>(m)] += row[k] * of[m][k];
  }
  return sums;
}

}  // namespace

bool EnvelopeCholesky::factorise(const Eigen::MatrixXd& H, double damping) {
  L_ = H;
  L_.diagonal().array() += damping;
  first_.resize(H.rows());
  inverse_.resize(H.rows());
  for (Index i = 0; i < L_.rows(); ++i) {
    auto row = L_.row(i);
    Index& first = first_[i];
    for (first = 0; first < i && row[first] == 0.0;) ++first;
    Index j = first;
    for (; j + kRowsAtOnce <= i; j += kRowsAtOnce) {
      Index k = j;
      for (Index m = 0; m < kRowsAtOnce; ++m) k = std::min(k, std::max(first, first_[j + m]));
      const std::array<double, kRowsAtOnce> dots = dots_of(L_, i, j, k);
      for (Index m = 0; m < kRowsAtOnce; ++m) {
        double sum = dots[static_cast<std::size_t>(m)];
        for (Index p = 0; p < m; ++p) sum += row[j + p] * L_(j + m, j + p);
        row[j + m] = (row[j + m] - sum) * inverse_[j + m];
      }
    }
    for (; j < i; ++j) {
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
