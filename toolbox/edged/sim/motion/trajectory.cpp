// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/motion/trajectory.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"

namespace edged {
namespace {

constexpr int kOrder = 6;
using Vector7d = PoseSpline::Vector7d;
using Weights = std::array<double, kOrder>;

/// Weights of the six control points around a segment, and their first and second derivatives by u, u in [0, 1].
struct Basis {
  Weights value{}, first{}, second{};
};

/// Cox-de Boor on integer knots: the order grows one at a time, the derivatives are differences of lower orders.
Basis basis(double u) {
  std::array<Weights, kOrder + 1> b{};  // b[k][i]: order k, i-th of the last k weights
  b[1][0] = 1.0;
  for (int k = 2; k <= kOrder; ++k) {
    for (int i = 0; i < k; ++i) {
      const double left = i > 0 ? (u + k - 1 - i) * b[k - 1][i - 1] : 0.0;
      const double right = i < k - 1 ? (1.0 + i - u) * b[k - 1][i] : 0.0;
      b[k][i] = (left + right) / (k - 1);
    }
  }
  const auto lower = [&b](int k, int i) { return i >= 0 && i < k ? b[k][i] : 0.0; };
  Basis out;
  out.value = b[kOrder];
  for (int i = 0; i < kOrder; ++i) {
    out.first[i] = lower(5, i - 1) - lower(5, i);
    out.second[i] = lower(4, i - 2) - 2.0 * lower(4, i - 1) + lower(4, i);
  }
  return out;
}

struct Segment {
  int index;
  double u;
};

Segment locate(double s, double knot_s, std::size_t controls) {
  const double position = s / knot_s;
  const int last = static_cast<int>(controls) - kOrder;
  const int index = std::clamp(static_cast<int>(std::floor(position)), 0, last);
  return {index, position - index};
}

Vector7d combine(const std::vector<Vector7d>& control, int index, const Weights& weights) {
  Vector7d sum = Vector7d::Zero();
  for (int i = 0; i < kOrder; ++i) sum += weights[i] * control[static_cast<std::size_t>(index + i)];
  return sum;
}

struct Samples {
  std::vector<double> s;         // since the first
  std::vector<Vector7d> values;  // quaternions without sign flips
};

Samples unroll(const Trajectory& poses) {
  Samples out;
  for (const StampedPose& pose : poses) {
    const double s = to_seconds(pose.t - poses.front().t);
    if (!out.s.empty() && s <= out.s.back())
      throw InputError::format("trajectory: stamp {} s does not increase; sort the file", to_seconds(pose.t));
    Vector7d v;
    v << pose.T.translation(), pose.T.rotation().coeffs();
    if (!out.values.empty() && v.tail<4>().dot(out.values.back().tail<4>()) < 0.0) v.tail<4>() *= -1.0;
    out.s.push_back(s);
    out.values.push_back(v);
  }
  return out;
}

/// Minimises the weighted squared residuals plus a small penalty on roughness, which only matters where samples are
/// missing.
std::vector<Vector7d> solve(const Samples& samples, const std::vector<double>& weights, double knot_s,
                            std::size_t controls) {
  constexpr double kRoughness = 1e-4;
  constexpr std::array<double, 4> kThirdDifference{-1.0, 3.0, -3.0, 1.0};
  const int n = static_cast<int>(controls);
  std::vector<Eigen::Triplet<double>> normal;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, 7);
  for (std::size_t k = 0; k < samples.s.size(); ++k) {
    const Segment at = locate(samples.s[k], knot_s, controls);
    const Weights b = basis(at.u).value;
    for (int i = 0; i < kOrder; ++i) {
      right.row(at.index + i) += weights[k] * b[i] * samples.values[k].transpose();
      for (int j = 0; j < kOrder; ++j) normal.emplace_back(at.index + i, at.index + j, weights[k] * b[i] * b[j]);
    }
  }
  for (int k = 0; k + 4 <= n; ++k)
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        normal.emplace_back(k + i, k + j, kRoughness * kThirdDifference[i] * kThirdDifference[j]);
  Eigen::SparseMatrix<double> A(n, n);
  A.setFromTriplets(normal.begin(), normal.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(A);
  EDGED_CHECK(ldlt.info() == Eigen::Success, "spline fit with {} control points is singular", n);
  const Eigen::MatrixXd x = ldlt.solve(right);
  std::vector<Vector7d> control(controls);
  for (int i = 0; i < n; ++i) control[static_cast<std::size_t>(i)] = x.row(i).transpose();
  return control;
}

/// Cauchy weights, residuals in units of their own median; separate for position and rotation, with the smaller weight
/// for both.
std::vector<double> reweight(const Samples& samples, const std::vector<Vector7d>& control, double knot_s) {
  const std::size_t n = samples.s.size();
  std::vector<double> position(n), rotation(n), weights(n);
  for (std::size_t k = 0; k < n; ++k) {
    const Segment at = locate(samples.s[k], knot_s, control.size());
    const Vector7d r = samples.values[k] - combine(control, at.index, basis(at.u).value);
    position[k] = r.head<3>().norm();
    rotation[k] = r.tail<4>().norm();
  }
  const double scale_p = std::max(median(position), 1e-6), scale_q = std::max(median(rotation), 1e-6);
  for (std::size_t k = 0; k < n; ++k) {
    const double r = std::max(position[k] / scale_p, rotation[k] / scale_q) / 4.0;
    weights[k] = 1.0 / (1.0 + r * r);
  }
  return weights;
}

}  // namespace

PoseSpline PoseSpline::fit(const Trajectory& samples, const SplineFit& options) {
  if (samples.size() < 8)
    throw InputError::format("trajectory: {} poses are too few for a motion; give at least 8", samples.size());
  const Samples unrolled = unroll(samples);
  PoseSpline spline;
  spline.knot_s_ = options.knot_s;
  spline.duration_ = unrolled.s.back();
  const std::size_t controls = static_cast<std::size_t>(std::floor(spline.duration_ / options.knot_s)) + kOrder;
  std::vector<double> weights(samples.size(), 1.0);
  spline.control_ = solve(unrolled, weights, options.knot_s, controls);
  for (int round = 0; round < options.reweightings; ++round) {
    weights = reweight(unrolled, spline.control_, options.knot_s);
    spline.control_ = solve(unrolled, weights, options.knot_s, controls);
  }
  return spline;
}

Kinematics PoseSpline::at(double s) const {
  const Segment segment = locate(std::clamp(s, 0.0, duration_), knot_s_, control_.size());
  const Basis b = basis(segment.u);
  const Vector7d value = combine(control_, segment.index, b.value);
  const Vector7d first = combine(control_, segment.index, b.first) / knot_s_;
  const Vector7d second = combine(control_, segment.index, b.second) / (knot_s_ * knot_s_);
  const Eigen::Quaterniond q(Eigen::Vector4d(value.tail<4>())), dq(Eigen::Vector4d(first.tail<4>()));
  Kinematics k;
  k.T_W_B = SE3(q, value.head<3>());
  k.v_W = first.head<3>();
  k.a_W = second.head<3>();
  // The scalar part of q^-1 dq is the change of the norm, which the normalisation removes.
  k.omega_B = 2.0 * (q.conjugate() * dq).vec() / q.squaredNorm();
  return k;
}

Ramp ramp(double t, double length_s) {
  const double x = length_s > 0.0 ? std::clamp(t / length_s, 0.0, 1.0) : (t < 0.0 ? 0.0 : 1.0);
  return {x * x * x * (10.0 + x * (-15.0 + 6.0 * x)),
          length_s > 0.0 ? 30.0 * x * x * (1.0 - x) * (1.0 - x) / length_s : 0.0,
          x * x * x * x * (2.5 + x * (-3.0 + x)) * length_s + std::max(0.0, t - length_s)};
}

Kinematics ContinuousTrajectory::at(double t) const {
  // Speed and time of the clock of the spline.
  auto [rate, rate_change, s] = ramp(t - rest_s_, blend_s_);
  if (s >= spline_.duration()) s = spline_.duration(), rate = 0.0, rate_change = 0.0;
  Kinematics k = spline_.at(s);
  k.a_W = k.a_W * rate * rate + k.v_W * rate_change;
  k.v_W *= rate;
  k.omega_B *= rate;
  return k;
}

}  // namespace edged
