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

using Rows = std::array<const double*, kRowsAtOnce>;

Eigen::Map<const Eigen::VectorXd> part(const double* row, Index first, Index size) { return {row + first, size}; }

/// Dot products of a row with others, over the columns from k up to j.
std::array<double, kRowsAtOnce> dots_of(const double* row, const Rows& of, Index k, Index j) {
  using Two = Eigen::Array2d;
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
    for (Index m = 0; m < kRowsAtOnce; ++m)
      sums[static_cast<std::size_t>(m)] += row[k] * of[static_cast<std::size_t>(m)][k];
  }
  return sums;
}

}  // namespace

bool EnvelopeCholesky::factorise(const EnvelopeMatrix& H, double damping) {
  L_ = H;
  first_.resize(H.size());
  inverse_.resize(H.size());
  for (Index i = 0; i < L_.size(); ++i) {
    double* row = L_.row(i);
    row[i] += damping;
    Index& first = first_[i];
    for (first = L_.first(i); first < i && row[first] == 0.0;) ++first;
    const auto one = [&](Index j) {
      const Index k = std::max(first, first_[j]);
      if (k < j) row[j] -= part(row, k, j - k).dot(part(L_.row(j), k, j - k));
      row[j] *= inverse_[j];
    };
    Index j = first;
    for (; j + kRowsAtOnce <= i; j += kRowsAtOnce) {
      Index k = j, stored = 0;
      Rows of;
      for (Index m = 0; m < kRowsAtOnce; ++m) {
        k = std::min(k, std::max(first, first_[j + m]));
        stored = std::max(stored, L_.first(j + m));
        of[static_cast<std::size_t>(m)] = L_.row(j + m);
      }
      if (k < stored) {  // not all of them have so many columns
        for (Index m = 0; m < kRowsAtOnce; ++m) one(j + m);
        continue;
      }
      const std::array<double, kRowsAtOnce> dots = dots_of(row, of, k, j);
      for (Index m = 0; m < kRowsAtOnce; ++m) {
        const double* other = of[static_cast<std::size_t>(m)];
        double sum = dots[static_cast<std::size_t>(m)];
        for (Index p = 0; p < m; ++p) sum += row[j + p] * other[j + p];
        row[j + m] = (row[j + m] - sum) * inverse_[j + m];
      }
    }
    for (; j < i; ++j) one(j);
    const double pivot = row[i] - part(row, first, i - first).squaredNorm();
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
    x[i] = (x[i] - part(L_.row(i), first, n).dot(x.segment(first, n))) * inverse_[i];
  }
  for (Index i = x.size() - 1; i >= 0; --i) {
    const Index first = first_[i], n = i - first;
    x[i] *= inverse_[i];
    x.segment(first, n) -= x[i] * part(L_.row(i), first, n);
  }
  return x;
}

Eigen::MatrixXd EnvelopeCholesky::last_of_L(Index size) const {
  Eigen::MatrixXd last = Eigen::MatrixXd::Zero(size, size);
  const Index begin = L_.size() - size;
  for (Index i = 0; i < size; ++i)
    for (Index j = std::max<Index>(L_.first(begin + i) - begin, 0); j <= i; ++j)
      last(i, j) = L_.row(begin + i)[begin + j];
  return last;
}

}  // namespace edged
