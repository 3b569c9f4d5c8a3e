// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/initialization/initialization_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>

#include "edged/estimator/initialization/stereo_scale.hpp"
#include "edged/estimator/tuning.hpp"

namespace edged {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// The unknowns of a track: its point P, then the start.
using PointAndStart = Eigen::Matrix<double, 12, 1>;
using PointAndStartMatrix = Eigen::Matrix<double, 12, 12>;

std::vector<StartTrack> gather_tracks(const std::vector<InitFrame>& frames, const Rig& rig) {
  std::map<FeatureId, std::vector<StartObservation>> seen;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (const CameraObservations& view : frames[i].observations) {
      const auto camera = std::find_if(rig.cameras.begin(), rig.cameras.end(),
                                       [&](const RigCamera& c) { return c.name == view.camera; });
      if (camera == rig.cameras.end()) continue;
      const auto index = static_cast<std::size_t>(camera - rig.cameras.begin());
      for (const FeatureObservation& f : view.features) seen[f.id].push_back({i, index, f.point, f.sigma});
    }
  }
  std::vector<StartTrack> tracks;
  for (auto& [id, observations] : seen) {
    if (observations.size() >= kAlignmentTuning.min_observations) tracks.push_back({id, std::move(observations)});
  }
  return tracks;
}

/// The motion after the interval of the IMU, around the biases that it was integrated with.
RelativeMotion extrapolated(const RelativeMotion& m, const Preintegration& imu) {
  const Vector3d &bg = imu.bias_gyro(), &ba = imu.bias_accel();
  RelativeMotion next;
  next.t = m.t + imu.dt();
  next.R = m.R * imu.dR(bg).toRotationMatrix();
  next.alpha = m.alpha + m.beta * imu.dt() + m.R * imu.dp(bg, ba);
  next.beta = m.beta + m.R * imu.dv(bg, ba);
  next.d_alpha = m.d_alpha + m.d_beta * imu.dt() + m.R * imu.d_dp_d_ba();
  next.d_beta = m.d_beta + m.R * imu.d_dv_d_ba();
  return next;
}

std::vector<RelativeMotion> relative_motion(const std::vector<InitFrame>& frames, const Vector3d& bg,
                                            const Vector3d& ba, const ImuNoise& noise) {
  std::vector<RelativeMotion> motion(1);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    motion.push_back(extrapolated(motion.back(), {frames[i].imu, bg, ba, noise}));
  }
  return motion;
}

/// R_S_B (R^T (beta + v + t g + d_beta b_a) + (omega - b_g) x l) = u at the time of the sample.
StartVelocity velocity_equation(const RelativeMotion& m, const Vector3d& omega_B, const VelocitySample& sample,
                                const VelocityConfig& config) {
  const SE3 T_B_S = config.T_B_S();
  const Matrix3d R_S_0 = T_B_S.R().transpose() * m.R.transpose();
  StartVelocity equation;
  equation.A << R_S_0, m.t * R_S_0, R_S_0 * m.d_beta;
  equation.b = sample.v_S - T_B_S.R().transpose() * omega_B.cross(T_B_S.translation()) - R_S_0 * m.beta;
  for (int axis = 0; axis < 3; ++axis) {
    const double sigma = sample.sigma[axis] > 0.0 ? sample.sigma[axis] : config.sigma_mps;
    equation.A.row(axis) /= sigma;
    equation.b[axis] = std::isinf(sigma) ? 0.0 : equation.b[axis] / sigma;
  }
  return equation;
}

std::vector<StartVelocity> velocity_equations(const std::vector<InitFrame>& frames,
                                              const std::vector<RelativeMotion>& motion, const Vector3d& bg,
                                              const Vector3d& ba, const ImuNoise& noise, const VelocityConfig& config) {
  std::vector<StartVelocity> equations;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    for (const ExternalSample& any : frames[i].external) {
      const auto* sample = std::get_if<VelocitySample>(&any);
      if (sample == nullptr) continue;
      const Preintegration imu(slice_imu(frames[i].imu, frames[i].imu.front().t, sample->t), bg, ba, noise);
      equations.push_back(
          velocity_equation(extrapolated(motion[i - 1], imu), imu.samples().back().gyro_B - bg, *sample, config));
    }
  }
  return equations;
}

/// The free directions of an initialization: the magnitude of gravity is fixed.
Eigen::Matrix<double, 9, 8> free_directions(const Start& x) {
  const Vector3d up = -x.segment<3>(3).normalized(), tangent = up.unitOrthogonal();
  Eigen::Matrix<double, 9, 8> free = Eigen::Matrix<double, 9, 8>::Zero();
  free.topLeftCorner<3, 3>().setIdentity();
  free.block<3, 1>(3, 3) = tangent;
  free.block<3, 1>(3, 4) = up.cross(tangent);
  free.bottomRightCorner<3, 3>().setIdentity();
  return free;
}

/// Derivative of a point's projection on the unit plane of a camera with rotation R at p_C.
Eigen::Matrix<double, 2, 3> d_seen_d_point(const Matrix3d& R_O_C, const Vector3d& p_C) {
  Eigen::Matrix<double, 2, 3> d;
  d << 1, 0, -p_C.x() / p_C.z(), 0, 1, -p_C.y() / p_C.z();
  return d * R_O_C.transpose() / p_C.z();
}

}  // namespace

/// Normal equations H x = b of the start.
struct StartEquations {
  StartMatrix H = StartMatrix::Zero();
  Start b = Start::Zero();

  /// Adds the equations of a track, its point eliminated.
  void add(const PointAndStartMatrix& N, const PointAndStart& c) {
    const Eigen::LDLT<Matrix3d> P_P(N.topLeftCorner<3, 3>() + 1e-9 * Matrix3d::Identity());
    H += N.bottomRightCorner<9, 9>() - N.bottomLeftCorner<9, 3>() * P_P.solve(N.topRightCorner<3, 9>());
    b += c.tail<9>() - N.bottomLeftCorner<9, 3>() * P_P.solve(c.head<3>());
  }

  /// min x^T H x - 2 b^T x over x = (v, g), the bias zero, with |g| = kGravity: v is eliminated, g solves (D + lambda
  /// I) g = d, the largest root of |g(lambda)| = kGravity being the global minimum. free_length: |g| at lambda = 0.
  Start solved_with_gravity_length(double* free_length) const {
    const Eigen::Matrix<double, 6, 6> H_6 = H.topLeftCorner<6, 6>();
    const Eigen::Matrix<double, 6, 1> b_6 = b.head<6>();
    const Eigen::LDLT<Matrix3d> H_vv(H_6.topLeftCorner<3, 3>());
    const Matrix3d D =
        H_6.bottomRightCorner<3, 3>() - H_6.bottomLeftCorner<3, 3>() * H_vv.solve(H_6.topRightCorner<3, 3>());
    const Vector3d d = b_6.tail<3>() - H_6.bottomLeftCorner<3, 3>() * H_vv.solve(b_6.head<3>());
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(0.5 * (D + D.transpose()));
    const Vector3d w = eigen.eigenvectors().transpose() * d;
    const Vector3d values = eigen.eigenvalues();
    const auto g_of = [&](double lambda) { return Vector3d(w.array() / (values.array() + lambda)); };
    *free_length = g_of(1e-12 * values.maxCoeff()).norm();
    double low = -values[0] + 1e-12 * values[2], high = w.norm() / kGravity + values[2];
    for (int i = 0; i < 200 && high - low > 1e-14 * high; ++i) {
      const double middle = 0.5 * (low + high);
      (g_of(middle).norm() > kGravity ? low : high) = middle;
    }
    const Vector3d g = eigen.eigenvectors() * g_of(high);
    Start x;
    x << H_vv.solve(b_6.head<3>() - H_6.topRightCorner<3, 3>() * g), g, Vector3d::Zero();
    return x;
  }
};

InitializationSolver::InitializationSolver(const std::vector<InitFrame>& frames, const Rig& rig,
                                           const Vector3d& gyro_bias, const ImuNoise& noise, const StartPriors& priors)
    : rig_(&rig),
      biases_(priors.biases),
      motion_(relative_motion(frames, gyro_bias, biases_.accel, noise)),
      tracks_(gather_tracks(frames, rig)) {
  const std::vector<SE3> cameras = camera_poses(Start::Zero());
  for (const StartTrack& track : tracks_) {
    std::vector<Ray>& rays = rays_.emplace_back();
    for (const StartObservation& seen : track.observations)
      rays.push_back(ray_of({cameras[pose_index(seen)], seen.point}));
    parallaxes_.push_back(largest_angle(rays));
  }
  if (priors.velocity != nullptr) {
    velocities_ = velocity_equations(frames, motion_, gyro_bias, biases_.accel, noise, *priors.velocity);
  }
}

/// Pi_j (P - p_j) = Pi_j R_j p_B_C of every view j.
void InitializationSolver::add_algebraic(const StartTrack& track, StartEquations& equations) const {
  PointAndStartMatrix N = PointAndStartMatrix::Zero();
  PointAndStart c = PointAndStart::Zero();
  for (const StartObservation& observation : track.observations) {
    const RelativeMotion& m = motion_[observation.frame];
    const SE3& T_B_C = rig_->cameras[observation.camera].T_B_C;
    Eigen::Matrix<double, 2, 3> pi;
    pi << 1, 0, -observation.point.x(), 0, 1, -observation.point.y();
    pi *= T_B_C.R().transpose() * m.R.transpose();
    Eigen::Matrix<double, 2, 12> A;
    A << pi, -pi * m.d_position();
    N += A.transpose().lazyProduct(A);  // the general product costs many times as much at this size
    c += A.transpose() * (pi * (m.alpha + m.R * T_B_C.translation()));
  }
  equations.add(N, c);
}

/// T_0_C of all frames and cameras, in the frame of the first body.
std::vector<SE3> InitializationSolver::camera_poses(const Start& x) const {
  std::vector<SE3> poses;
  for (const RelativeMotion& m : motion_) {
    const SE3 T_0_B(m.R, m.position(x));
    for (const RigCamera& camera : rig_->cameras) poses.push_back(T_0_B * camera.T_B_C);
  }
  return poses;
}

std::vector<Ray> InitializationSolver::rays_from(std::size_t track, const std::vector<SE3>& cameras) const {
  std::vector<Ray> rays = rays_[track];
  for (std::size_t k = 0; k < rays.size(); ++k)
    rays[k].centre_A = cameras[pose_index(tracks_[track].observations[k])].translation();
  return rays;
}

/// One Gauss-Newton term around x, with the point of the track optimized and eliminated.
void InitializationSolver::add_reprojection(std::size_t track, const std::vector<SE3>& cameras,
                                            StartEquations& equations) const {
  if (parallaxes_[track] < kAlignmentTuning.ray_sigma) return;
  const auto point = triangulate(rays_from(track, cameras), parallaxes_[track]);
  if (!point) return;
  PointAndStartMatrix N = PointAndStartMatrix::Zero();
  PointAndStart c = PointAndStart::Zero();
  for (const StartObservation& seen : tracks_[track].observations) {
    const SE3& T_0_C = cameras[pose_index(seen)];
    const Vector3d p_C = T_0_C.inverse() * point->p_A;
    const Eigen::Vector2d r = (p_C.hnormalized() - seen.point) / kAlignmentTuning.ray_sigma;
    const Eigen::Matrix<double, 2, 3> d_r_d_P = d_seen_d_point(T_0_C.R(), p_C) / kAlignmentTuning.ray_sigma;
    Eigen::Matrix<double, 2, 12> J;
    J << d_r_d_P, -d_r_d_P * motion_[seen.frame].d_position();
    const double weight = r.norm() < kAlignmentTuning.huber_sigma ? 1.0 : kAlignmentTuning.huber_sigma / r.norm();
    N += weight * J.transpose().lazyProduct(J);
    c -= weight * J.transpose() * r;
  }
  equations.add(N, c);
}

/// Adds the velocities, linearised around x; what is far off counts for less.
void InitializationSolver::add_velocities(const Start& x, StartEquations& equations) const {
  for (const StartVelocity& velocity : velocities_) {
    const double misfit = (velocity.A * x - velocity.b).norm();
    const double weight = misfit < kAlignmentTuning.huber_sigma ? 1.0 : kAlignmentTuning.huber_sigma / misfit;
    equations.H += weight * velocity.A.transpose() * velocity.A;
    equations.b -= weight * velocity.A.transpose() * (velocity.A * x - velocity.b);
  }
}

std::optional<Start> InitializationSolver::linear(const Chosen& chosen, double* free_length) const {
  StartEquations equations;
  for (const std::size_t track : chosen) add_algebraic(tracks_[track], equations);
  const double same_unit = std::pow(kAlignmentTuning.ray_sigma * kAlignmentTuning.usual_depth_m, 2);
  for (const StartVelocity& velocity : velocities_) {
    equations.H += same_unit * velocity.A.transpose() * velocity.A;
    equations.b += same_unit * velocity.A.transpose() * velocity.b;
  }
  const Start x = equations.solved_with_gravity_length(free_length);
  return x.allFinite() ? std::optional(x) : std::nullopt;
}

std::optional<RefinedStart> InitializationSolver::refine(const Chosen& chosen, Start x, int iterations) const {
  const double bias_information = 1.0 / (biases_.accel_sigma * biases_.accel_sigma);
  Eigen::Matrix<double, 8, 8> H = Eigen::Matrix<double, 8, 8>::Identity();
  Eigen::Matrix<double, 9, 8> free = Eigen::Matrix<double, 9, 8>::Identity();
  for (int iteration = 0; iteration < iterations; ++iteration) {
    StartEquations equations;
    const std::vector<SE3> cameras = camera_poses(x);
    for (const std::size_t track : chosen) add_reprojection(track, cameras, equations);
    add_velocities(x, equations);
    equations.H.bottomRightCorner<3, 3>() += bias_information * Matrix3d::Identity();
    equations.b.tail<3>() -= bias_information * x.tail<3>();
    free = free_directions(x);
    H = free.transpose() * equations.H * free;
    const Eigen::Matrix<double, 8, 1> step = H.ldlt().solve(free.transpose() * equations.b);
    if (!step.allFinite()) return std::nullopt;
    x += free * step;
    x.segment<3>(3) *= kGravity / x.segment<3>(3).norm();
    if (step.norm() < 1e-4) break;
  }
  return RefinedStart{x, free * H.inverse() * free.transpose()};
}

Start InitializationSolver::start_of(const OdomState& last) const {
  const RelativeMotion& m = motion_.back();
  const Matrix3d R_0_O = m.R * last.T_O_B.R().transpose();
  Start x;
  x << Vector3d::Zero(), R_0_O * Vector3d(0.0, 0.0, -kGravity), last.bias_accel - biases_.accel;
  x.head<3>() = R_0_O * last.v_O - m.velocity(x);
  return x;
}

std::vector<double> InitializationSolver::misfits(const Start& x) const {
  const std::vector<SE3> cameras = camera_poses(x);
  std::vector<double> misfits;
  for (std::size_t track = 0; track < tracks_.size(); ++track) {
    const auto point = triangulate(rays_from(track, cameras), parallaxes_[track]);
    misfits.push_back(point ? point->rms_residual / tracks_[track].observations.front().sigma
                            : std::numeric_limits<double>::infinity());
  }
  return misfits;
}

double InitializationSolver::relative_sigma(const RefinedStart& start) const {
  const auto distance_of = [&](const RelativeMotion& m) { return m.position(start.x).norm(); };
  const RelativeMotion& farthest = *std::max_element(
      motion_.begin(), motion_.end(), [&](const auto& a, const auto& b) { return distance_of(a) < distance_of(b); });
  const Vector3d baseline = farthest.position(start.x);
  const Start d_baseline = farthest.d_position().transpose() * baseline;
  return std::sqrt(d_baseline.dot(start.covariance * d_baseline)) / baseline.squaredNorm();
}

/// Each track counts once, in the first frame that two cameras have it in: later ones have the same errors.
double InitializationSolver::baseline_sigma(const Chosen& chosen) const {
  StereoScale scale;
  const auto T_B_C = [&](const StartObservation& seen) -> const SE3& { return rig_->cameras[seen.camera].T_B_C; };
  const auto ray = [&](const StartObservation& seen) { return Vector3d(T_B_C(seen).R() * seen.point.homogeneous()); };
  for (const std::size_t track : chosen) {
    const std::vector<StartObservation>& seen = tracks_[track].observations;
    const auto first = std::ranges::adjacent_find(seen, {}, &StartObservation::frame);
    if (first == seen.end()) continue;
    const StartObservation& second = *std::next(first);
    scale.add(ray(*first), ray(second), T_B_C(second).translation() - T_B_C(*first).translation(), first->sigma);
  }
  return scale.sigma();
}

Vector3d InitializationSolver::direction(std::size_t track) const {
  const std::vector<StartObservation>& observations = tracks_[track].observations;
  const StartObservation& observation = observations[observations.size() / 2];
  return motion_[observation.frame].R *
         (rig_->cameras[observation.camera].T_B_C.R() * observation.point.homogeneous().normalized());
}

}  // namespace edged
