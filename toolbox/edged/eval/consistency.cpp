// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/eval/consistency.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "edged/eval/association.hpp"

namespace edged {
namespace {

constexpr double kChiSquare = 14.156;  // of three degrees of freedom, 99.73 %
constexpr double kLeastSigma = 1e-4;   // [m], [rad]
constexpr Duration kSilentAfter = std::chrono::milliseconds(500);

/// Alignment of the estimate with the truth in position and yaw.
SE3 gauge(const SE3& truth, const SE3& estimate) {
  const Eigen::Matrix3d R = (truth.rotation() * estimate.rotation().conjugate()).toRotationMatrix();
  const double yaw = std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
  const Eigen::Quaterniond q = so3::exp({0.0, 0.0, yaw});
  return {q, truth.translation() - q * estimate.translation()};
}

/// The alignment of the estimate with the truth at one sample. That sample is itself uncertain, and so are all errors
/// relative to it.
struct Anchor {
  SE3 T_Wtrue_W, truth;
  Eigen::Matrix3d position = Eigen::Matrix3d::Zero();  ///< covariance of the sample, in the true W [m^2]
  double yaw = 0.0;                                    ///< its variance about z [rad^2]

  Anchor(const PosePair& pair, const PoseCovarianceSample& sample)
      : T_Wtrue_W(gauge(pair.truth, pair.estimate)), truth(pair.truth) {
    position = T_Wtrue_W.R() * sample.position * T_Wtrue_W.R().transpose();
    const Eigen::Vector3d up_B = pair.estimate.R().row(2);
    yaw = up_B.dot(sample.rotation * up_B);
  }
  /// Its part in the covariance of a position.
  Eigen::Matrix3d of_position(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d swing = Eigen::Vector3d::UnitZ().cross(p - truth.translation());
    return position + yaw * swing * swing.transpose();
  }
  /// The same of a rotation of B.
  Eigen::Matrix3d of_rotation(const SE3& T_W_B) const {
    const Eigen::Vector3d up_B = T_W_B.R().row(2);
    return yaw * up_B * up_B.transpose();
  }
};

/// Adds up the errors of one kind.
class Sum {
 public:
  /// Whether the error is consistent with its covariance.
  bool add(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance) {
    const Eigen::Matrix3d P = covariance + kLeastSigma * kLeastSigma * Eigen::Matrix3d::Identity();
    const double nees = error.dot(P.ldlt().solve(error));
    const Eigen::Array3d sigmas = error.array().abs() / P.diagonal().array().sqrt();
    const bool believable = nees <= kChiSquare;
    ++count_;
    nees_ += nees;
    max_nees_ = std::max(max_nees_, nees);
    within_ += believable ? 1.0 : 0.0;
    axes_within_ += (sigmas <= 3.0).cast<double>().matrix();
    return believable;
  }

  NormalizedErrors mean() const {
    if (count_ == 0) return {};
    const double n = static_cast<double>(count_);
    return {nees_ / n, max_nees_, within_ / n, axes_within_ / n};
  }

 private:
  std::size_t count_ = 0;
  double nees_ = 0.0, max_nees_ = 0.0, within_ = 0.0;
  Eigen::Vector3d axes_within_ = Eigen::Vector3d::Zero();
};

/// Collects time spans longer than kSilentAfter in which a condition holds without a break.
class Spans {
 public:
  void add(Timestamp t, bool holds) {
    if (!holds) return end();
    if (!open_) open_ = {t, t};
    open_->end = t;
  }
  void end() {
    if (open_ && open_->end - open_->begin > kSilentAfter) spans_.push_back(*open_);
    open_.reset();
  }
  std::vector<TimeSpan> take() {
    end();
    return std::move(spans_);
  }

 private:
  std::optional<TimeSpan> open_;
  std::vector<TimeSpan> spans_;
};

}  // namespace

double Consistency::silent_s() const {
  double sum = 0.0;
  for (const TimeSpan& span : silent) sum += to_seconds(span.end - span.begin);
  return sum;
}

Consistency check_consistency(const Trajectory& truth, const std::vector<PoseCovarianceSample>& samples) {
  Trajectory estimate;
  for (const PoseCovarianceSample& sample : samples) estimate.push_back({sample.t, sample.T_W_B});
  Consistency result;
  Sum position, rotation;
  Spans silent;
  std::optional<Anchor> anchor;
  int start = 0;
  auto sample = samples.begin();
  for (const PosePair& pair : associate(truth, estimate).pairs) {
    while (sample->t < pair.t) ++sample;  // where the truth is sparser, the first one after its stamp
    if (sample->t != pair.t && sample->start != std::prev(sample)->start) continue;
    if (anchor && sample->start != start) anchor.reset(), silent.end();
    if (!anchor) {
      if (!sample->good) continue;
      anchor.emplace(pair, *sample);
      start = sample->start;
      ++result.starts;
    }
    const SE3 T_W_B = anchor->T_Wtrue_W * pair.estimate;
    const Eigen::Matrix3d R = anchor->T_Wtrue_W.R();
    const Eigen::Vector3d error = T_W_B.translation() - pair.truth.translation();
    const Eigen::Matrix3d covariance = R * sample->position * R.transpose() + anchor->of_position(T_W_B.translation());
    result.errors.push_back({pair.t, error, covariance.diagonal().cwiseSqrt()});
    const bool position_believable = position.add(error, covariance);
    const bool rotation_believable = rotation.add(so3::log(T_W_B.rotation().conjugate() * pair.truth.rotation()),
                                                  sample->rotation + anchor->of_rotation(T_W_B));
    silent.add(pair.t, sample->good && !(position_believable && rotation_believable));
    ++result.poses;
  }
  result.position = position.mean();
  result.rotation = rotation.mean();
  result.silent = silent.take();
  return result;
}

}  // namespace edged
