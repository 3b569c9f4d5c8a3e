// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/envelope_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <random>

namespace edged {
namespace {

/// A chain whose links are coupled to the next one, then some rows coupled to all.
Eigen::MatrixXd chain_and_border(Eigen::Index chain, Eigen::Index border) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const Eigen::Index n = chain + border;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = i < chain ? std::max<Eigen::Index>(i - 2, 0) : 0; j < i; ++j) H(i, j) = number(random);
    H(i, i) = static_cast<double>(n);
  }
  return H;
}

TEST(EnvelopeCholesky, SolvesAsTheDenseFactorisationDoes) {
  const Eigen::MatrixXd H = chain_and_border(30, 7);
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(37, -1.0, 1.0);
  EnvelopeCholesky cholesky;
  ASSERT_TRUE(cholesky.factorise(EnvelopeMatrix(H)));
  EXPECT_LT((cholesky.solve(b) - H.selfadjointView<Eigen::Lower>().llt().solve(b)).norm(), 1e-14);
}

TEST(EnvelopeCholesky, EndsWithTheFactorOfTheSchurComplement) {
  const Eigen::MatrixXd H = chain_and_border(30, 7);
  EnvelopeCholesky cholesky;
  ASSERT_TRUE(cholesky.factorise(EnvelopeMatrix(H)));
  const Eigen::MatrixXd L = cholesky.last_of_L(7).triangularView<Eigen::Lower>(),
                        whole = H.selfadjointView<Eigen::Lower>();
  EXPECT_LT(((L * L.transpose()).inverse() - whole.inverse().bottomRightCorner(7, 7)).norm(), 1e-14);
}

TEST(EnvelopeCholesky, RefusesWhatIsNotPositiveDefinite) {
  Eigen::MatrixXd H = chain_and_border(5, 2);
  H(3, 3) = 0.0;
  EXPECT_FALSE(EnvelopeCholesky().factorise(EnvelopeMatrix(H)));
}

}  // namespace
}  // namespace edged
