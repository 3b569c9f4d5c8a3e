// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/eval/consistency.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include "edged/core/directions.hpp"
#include "edged/eval/association.hpp"

namespace edged {
namespace {

constexpr double kChiSquare = 14.156;         // of three degrees of freedom, 99.73 %
constexpr double kLeastSigma = 1e-4;          // [m], [rad]
constexpr double kLeastVelocitySigma = 1e-3;  // [m/s]: the true velocity is not exact
constexpr double kNear_s = 0.25;
constexpr Duration kSilentAfter = std::chrono::milliseconds(500);

/// Alignment of the estimate with the truth in position and yaw.
SE3 gauge(const SE3& truth, const SE3& estimate) {
  const Eigen::Quaterniond q = nearest_yaw((truth.rotation() * estimate.rotation().conjugate()).toRotationMatrix());
  return {q, truth.translation() - q * estimate.translation()};
}

/// The alignment of the estimate with the truth at one sample. That sample is itself uncertain, and so are all errors
/// relative to it.
struct Anchor {
  Timestamp t;
  SE3 T_Wtrue_W, truth;
  Eigen::Matrix3d position = Eigen::Matrix3d::Zero();  ///< covariance of the sample, in the true W [m^2]
  double yaw = 0.0;                                    ///< its variance about z [rad^2]

  Anchor(const PosePair& pair, const StateCovarianceSample& sample)
      : t(pair.t), T_Wtrue_W(gauge(pair.truth, pair.estimate)), truth(pair.truth) {
    position = in_true_W(sample.covariance.position);
    const Eigen::Vector3d up_B = pair.estimate.R().row(2);
    yaw = up_B.dot(sample.covariance.rotation * up_B);
  }
  Eigen::Matrix3d in_true_W(const Eigen::Matrix3d& P_W) const {
    return T_Wtrue_W.R() * P_W * T_Wtrue_W.R().transpose();
  }
  /// Its part in the covariance of a vector of W: by its yaw.
  Eigen::Matrix3d of_vector(const Eigen::Vector3d& v) const {
    const Eigen::Vector3d swing = Eigen::Vector3d::UnitZ().cross(v);
    return yaw * swing * swing.transpose();
  }
  /// Its part in the covariance of a position.
  Eigen::Matrix3d of_position(const Eigen::Vector3d& p) const { return position + of_vector(p - truth.translation()); }
  /// Its part in the covariance of a rotation of B.
  Eigen::Matrix3d of_rotation(const SE3& T_W_B) const {
    const Eigen::Vector3d up_B = T_W_B.R().row(2);
    return yaw * up_B * up_B.transpose();
  }
};

/// One error over its covariance.
struct Normalized {
  double nees = 0.0;
  bool within = true;  ///< three sigma, on each axis by itself
};

/// Adds up the errors of one kind.
class Sum {
 public:
  Normalized add(const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance, double least_sigma = kLeastSigma) {
    const Eigen::Matrix3d P = covariance + least_sigma * least_sigma * Eigen::Matrix3d::Identity();
    const double nees = error.dot(P.ldlt().solve(error));
    const Eigen::Array<bool, 3, 1> within = error.array().abs() <= 3.0 * P.diagonal().array().sqrt();
    ++count_;
    nees_ += nees;
    max_nees_ = std::max(max_nees_, nees);
    within_ += nees <= kChiSquare ? 1.0 : 0.0;
    axes_within_ += within.cast<double>().matrix();
    return {nees, within.all()};
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

/// Means of the NEES around some instants.
class MeansAt {
 public:
  void add(double since_start_s, const Eigen::Array3d& nees, bool has_velocity) {
    for (std::size_t i = 0; i < kNeesAt_s.size(); ++i) {
      if (std::abs(since_start_s - kNeesAt_s[i]) > kNear_s) continue;
      sums_[i] += nees;
      counts_[i] += Eigen::Array3d(1.0, 1.0, has_velocity ? 1.0 : 0.0);
    }
  }
  std::vector<NeesAt> means() const {
    std::vector<NeesAt> means;
    for (std::size_t i = 0; i < kNeesAt_s.size(); ++i) {
      if (counts_[i][0] == 0.0) continue;
      const Eigen::Array3d mean = sums_[i] / counts_[i];
      means.push_back({kNeesAt_s[i], mean[0], mean[1], mean[2]});
    }
    return means;
  }

 private:
  using Sums = std::array<Eigen::Array3d, kNeesAt_s.size()>;
  static Sums zeros() {
    Sums sums;
    sums.fill(Eigen::Array3d::Zero());
    return sums;
  }
  Sums sums_ = zeros(), counts_ = zeros();
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

/// The velocity of a trajectory at ascending times, from its positions one step before and after.
class VelocityOf {
 public:
  /// The trajectory must outlive this.
  explicit VelocityOf(const Trajectory& trajectory) : trajectory_(trajectory), step_(typical_step(trajectory)) {}
  /// Nothing at its ends and in gaps.
  std::optional<Eigen::Vector3d> at(Timestamp t) const {
    const auto before = position(t - step_), after = position(t + step_);
    if (!before || !after) return std::nullopt;
    return (*after - *before) / (2.0 * to_seconds(step_));
  }

 private:
  std::optional<Eigen::Vector3d> position(Timestamp t) const {
    const auto after = std::ranges::lower_bound(trajectory_, t, {}, &StampedPose::t);
    if (after == trajectory_.begin() || after == trajectory_.end()) return std::nullopt;
    const auto before = std::prev(after);
    if (after->t - before->t > 2 * step_) return std::nullopt;
    return interpolated(*before, *after, t).translation();
  }

  const Trajectory& trajectory_;
  Duration step_;
};

/// Gathers the errors of all samples.
class ConsistencySums {
 public:
  /// The truth must outlive this.
  explicit ConsistencySums(const Trajectory& truth) : true_velocity_(truth) {}

  /// Whether position and rotation are within three sigma.
  bool add(const PosePair& pair, const StateCovarianceSample& sample, const Anchor& anchor, bool first_start) {
    const SE3 T_W_B = anchor.T_Wtrue_W * pair.estimate;
    const Eigen::Vector3d error = T_W_B.translation() - pair.truth.translation();
    const Eigen::Matrix3d P = anchor.in_true_W(sample.covariance.position) + anchor.of_position(T_W_B.translation());
    of_each_.push_back({pair.t, error, P.diagonal().cwiseSqrt()});
    const Normalized position = position_.add(error, P);
    const Normalized rotation = rotation_.add(so3::log(T_W_B.rotation().conjugate() * pair.truth.rotation()),
                                              sample.covariance.rotation + anchor.of_rotation(T_W_B));
    const std::optional<double> velocity = add_velocity(pair, sample, anchor);
    if (first_start) {
      at_.add(to_seconds(pair.t - anchor.t), {position.nees, rotation.nees, velocity.value_or(0.0)},
              velocity.has_value());
    }
    return position.within && rotation.within;
  }

  void write(Consistency& result) {
    result.poses = of_each_.size();
    result.position = position_.mean();
    result.rotation = rotation_.mean();
    result.velocity = velocity_.mean();
    result.at = at_.means();
    result.errors = std::move(of_each_);
  }

 private:
  std::optional<double> add_velocity(const PosePair& pair, const StateCovarianceSample& sample, const Anchor& anchor) {
    const auto true_v = sample.t == pair.t ? true_velocity_.at(pair.t) : std::nullopt;
    if (!true_v || sample.covariance.velocity.isZero(0.0)) return std::nullopt;
    const Eigen::Vector3d v = anchor.T_Wtrue_W.rotation() * sample.v_W;
    return velocity_
        .add(v - *true_v, anchor.in_true_W(sample.covariance.velocity) + anchor.of_vector(v), kLeastVelocitySigma)
        .nees;
  }

  VelocityOf true_velocity_;
  Sum position_, rotation_, velocity_;
  MeansAt at_;
  std::vector<PoseErrorSample> of_each_;
};

}  // namespace

double Consistency::silent_s() const {
  double sum = 0.0;
  for (const TimeSpan& span : silent) sum += to_seconds(span.end - span.begin);
  return sum;
}

Consistency check_consistency(const Trajectory& truth, const std::vector<StateCovarianceSample>& samples) {
  Trajectory estimate;
  for (const StateCovarianceSample& sample : samples) estimate.push_back({sample.t, sample.T_W_B});
  Consistency result;
  ConsistencySums errors(truth);
  Spans silent;
  std::optional<Anchor> anchor;
  int reference = 0;
  auto sample = samples.begin();
  for (const PosePair& pair : associate(truth, estimate).pairs) {
    while (sample->t < pair.t) ++sample;  // where the truth is sparser, the first one after its stamp
    if (sample->t != pair.t && sample->reference != std::prev(sample)->reference) continue;
    if (anchor && sample->reference != reference) anchor.reset(), silent.end();
    if (!anchor) {
      if (!sample->good) continue;
      anchor.emplace(pair, *sample);
      reference = sample->reference;
      ++result.references;
    }
    const bool within = errors.add(pair, *sample, *anchor, result.references == 1);
    silent.add(pair.t, sample->good && !within);
  }
  errors.write(result);
  result.silent = silent.take();
  return result;
}

}  // namespace edged
