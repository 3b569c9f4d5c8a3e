// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/eval/alignment.hpp"

#include <Eigen/SVD>
#include <cmath>

#include "edged/core/check.hpp"

namespace edged {
namespace {

/// First and second moments of the two point sets.
struct Moments {
  Eigen::Vector3d mean_truth = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_estimate = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< between truth (rows) and estimate (columns)
  double variance_estimate = 0.0;
};

Moments moments(const std::vector<PosePair>& pairs) {
  Moments m;
  const double n = static_cast<double>(pairs.size());
  for (const PosePair& pair : pairs) {
    m.mean_truth += pair.truth.translation() / n;
    m.mean_estimate += pair.estimate.translation() / n;
  }
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d truth = pair.truth.translation() - m.mean_truth;
    const Eigen::Vector3d estimate = pair.estimate.translation() - m.mean_estimate;
    m.covariance += truth * estimate.transpose() / n;
    m.variance_estimate += estimate.squaredNorm() / n;
  }
  return m;
}

// Singular values below this share of the largest are rounding, not motion.
constexpr double kRankTolerance = 1e-12;

struct Fit {
  Similarity alignment;
  bool unique = false;  ///< the positions fix the rotation
};

Fit umeyama(const Moments& m, bool with_scale) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m.covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& d = svd.singularValues();
  Eigen::Vector3d s(1, 1, 1);
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) s(2) = -1;
  const Eigen::Matrix3d R = svd.matrixU() * s.asDiagonal() * svd.matrixV().transpose();
  const double scale = with_scale ? d.dot(s) / m.variance_estimate : 1.0;
  return {{scale, SE3(R, m.mean_truth - scale * R * m.mean_estimate)}, d(1) > kRankTolerance * d(0)};
}

Similarity position_yaw(const Moments& m) {
  // Maximises sum(truth . Rz(yaw) estimate) over yaw.
  const double sine = m.covariance(1, 0) - m.covariance(0, 1);
  const double cosine = m.covariance(0, 0) + m.covariance(1, 1);
  if (std::hypot(sine, cosine) <= kRankTolerance * m.variance_estimate) {
    throw InputError("cannot align: no horizontal motion fixes the yaw; use alignment none or a longer window");
  }
  const Eigen::Quaterniond q(Eigen::AngleAxisd(std::atan2(sine, cosine), Eigen::Vector3d::UnitZ()));
  return {1.0, SE3(q, m.mean_truth - q * m.mean_estimate)};
}

}  // namespace

std::string to_string(AlignmentKind kind) {
  switch (kind) {
    case AlignmentKind::None:
      return "none";
    case AlignmentKind::PositionYaw:
      return "position+yaw";
    case AlignmentKind::SE3:
      return "SE3";
    case AlignmentKind::Sim3:
      return "Sim3";
  }
  EDGED_CHECK(false, "alignment {}", static_cast<int>(kind));
}

std::vector<PosePair> within(const std::vector<PosePair>& pairs, const TimeWindow& window) {
  std::vector<PosePair> inside;
  for (const PosePair& pair : pairs) {
    const double t = to_seconds(pair.t - pairs.front().t);
    if (t >= window.begin_s && t <= window.end_s) inside.push_back(pair);
  }
  return inside;
}

Similarity align(const std::vector<PosePair>& pairs, AlignmentKind kind) {
  if (kind == AlignmentKind::None) return {};
  if (pairs.size() < 3) {
    throw InputError::format(
        "cannot align {} poses that have ground truth (3 needed); do the stamps of the two "
        "trajectories share one clock?",
        pairs.size());
  }
  const Moments m = moments(pairs);
  if (kind == AlignmentKind::PositionYaw) return position_yaw(m);
  const Fit fit = umeyama(m, kind == AlignmentKind::Sim3);
  if (!fit.unique) {
    throw InputError(
        "cannot align: the positions lie on a point or a line and do not determine the rotation; "
        "use alignment none or a longer window");
  }
  return fit.alignment;
}

Similarity align_rigidly(const std::vector<PosePair>& pairs) {
  EDGED_CHECK(!pairs.empty(), "nothing to align");
  return umeyama(moments(pairs), false).alignment;
}

double mean_squared_error(const std::vector<PosePair>& pairs, const Similarity& alignment) {
  double sum = 0.0;
  for (const PosePair& pair : pairs) {
    sum += (pair.truth.translation() - alignment * pair.estimate.translation()).squaredNorm();
  }
  return sum / static_cast<double>(pairs.size());
}

}  // namespace edged
