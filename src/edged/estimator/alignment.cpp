// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>

#include "edged/camera/two_view.hpp"
#include "edged/core/statistics.hpp"

namespace edged {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr std::size_t kMinPairCorners = 10;
constexpr double kBiasPrior = 0.15;      // [rad/s]
constexpr double kRayNoise = 5e-3;       // [rad]
constexpr double kGravity = 9.81;        // [m/s^2]

/// A corner seen in two frames, as rays in the body frame's orientation at each.
struct RayPair {
  Vector3d ray_0, ray_1;
};

const CameraObservations* observations_of(const InitFrame& frame, const std::string& camera) {
  const auto found = std::find_if(frame.observations.begin(), frame.observations.end(),
                                  [&](const CameraObservations& o) { return o.camera == camera; });
  return found == frame.observations.end() ? nullptr : &*found;
}

std::vector<RayPair> common_rays(const InitFrame& a, const InitFrame& b, const RigCamera& camera) {
  std::vector<RayPair> pairs;
  const CameraObservations *in_a = observations_of(a, camera.name), *in_b = observations_of(b, camera.name);
  if (in_a == nullptr || in_b == nullptr) return pairs;
  std::map<FeatureId, Eigen::Vector2d> points;
  for (const FeatureObservation& f : in_a->features) points.emplace(f.id, f.point);
  for (const FeatureObservation& f : in_b->features) {
    const auto found = points.find(f.id);
    if (found == points.end()) continue;
    pairs.push_back({camera.T_B_C.rotation() * found->second.homogeneous().normalized(),
                     camera.T_B_C.rotation() * f.point.homogeneous().normalized()});
  }
  return pairs;
}

/// IMU from frame `first` to frame `last` as one preintegration.
Preintegration between(const std::vector<InitFrame>& frames, std::size_t first, std::size_t last, const Vector3d& bg,
                       const ImuNoise& noise) {
  std::vector<ImuSample> samples = frames[first + 1].imu;
  for (std::size_t i = first + 2; i <= last; ++i) {
    samples.insert(samples.end(), frames[i].imu.begin() + 1, frames[i].imu.end());
  }
  return {samples, bg, Vector3d::Zero(), noise};
}

struct RotationPair {
  std::vector<RayPair> rays;
  Preintegration imu;
};

std::vector<RotationPair> rotation_pairs(const std::vector<InitFrame>& frames, const Rig& rig, const ImuNoise& noise) {
  std::vector<RotationPair> out;
  for (const std::size_t step : {1U, 3U, 8U}) {
    for (std::size_t i = 0; i + step < frames.size(); ++i) {
      for (const RigCamera& camera : rig.cameras) {
        std::vector<RayPair> rays = common_rays(frames[i], frames[i + step], camera);
        if (rays.size() < kMinPairCorners) continue;
        out.push_back({std::move(rays), between(frames, i, i + step, Vector3d::Zero(), noise)});
      }
    }
  }
  return out;
}

/// The baseline that a pair's corners agree on best under the rotation R. Noise turns every normal f_0 x R f_1 about
/// its rays only: C is the covariance it leaves, without which the baseline leans towards the optical axis.
Vector3d baseline_of(const RotationPair& pair, const Matrix3d& R) {
  Matrix3d M = Matrix3d::Zero(), C = Matrix3d::Zero();
  for (const RayPair& rays : pair.rays) {
    const Vector3d n = rays.ray_0.cross(R * rays.ray_1);
    M += n * n.transpose();
    C += Matrix3d::Identity() - rays.ray_0 * rays.ray_0.transpose();
  }
  return Eigen::GeneralizedSelfAdjointEigenSolver<Matrix3d>(M, C).eigenvectors().col(0).normalized();
}

/// One Gauss-Newton term: the angle of each corner's ray to the plane of its partner and the baseline; the baseline, two
/// angles a pair, is eliminated.
void add_coplanarity(const RotationPair& pair, const Vector3d& bg, Matrix3d& H, Vector3d& g) {
  const Matrix3d R = pair.imu.dR(bg).toRotationMatrix();
  const Matrix3d d_phi_d_bg =
      so3::right_jacobian(pair.imu.d_dR_d_bg() * (bg - pair.imu.bias_gyro())) * pair.imu.d_dR_d_bg();
  const Vector3d baseline = baseline_of(pair, R);
  const Vector3d tangent_1 = baseline.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> tangent;
  tangent << tangent_1, baseline.cross(tangent_1);
  Eigen::Matrix<double, 5, 5> N = Eigen::Matrix<double, 5, 5>::Zero();  // over (bias, baseline)
  Eigen::Matrix<double, 5, 1> c = Eigen::Matrix<double, 5, 1>::Zero();
  for (const RayPair& rays : pair.rays) {
    const Vector3d turned = R * rays.ray_1, n = rays.ray_0.cross(turned);
    const double along = baseline.dot(rays.ray_0), across = std::sqrt(std::max(1.0 - along * along, 1e-4));
    const double e = baseline.dot(n) / (across * kRayNoise);
    Eigen::Matrix<double, 5, 1> J;
    J.head<3>() = (baseline.transpose() * skew(rays.ray_0) * -R * skew(rays.ray_1) * d_phi_d_bg).transpose() /
                  (across * kRayNoise);
    J.tail<2>() = tangent.transpose() * (n / (across * kRayNoise) + e * along / (across * across) * rays.ray_0);
    const double weight = std::abs(e) < 1.5 ? 1.0 : 1.5 / std::abs(e);  // Huber
    N += weight * J * J.transpose();
    c += weight * J * e;
  }
  const Eigen::Matrix2d baseline_info = N.bottomRightCorner<2, 2>() + Eigen::Matrix2d::Identity();
  const Eigen::Matrix<double, 2, 3> coupling = baseline_info.ldlt().solve(N.bottomLeftCorner<2, 3>());
  H += N.topLeftCorner<3, 3>() - coupling.transpose() * N.bottomLeftCorner<2, 3>();
  g += c.head<3>() - coupling.transpose() * c.tail<2>();
}

/// A landmark's rays, gathered over the frames.
struct Sight {
  std::size_t frame, camera;
  Eigen::Vector2d point;
};

std::map<FeatureId, std::vector<Sight>> gather_tracks(const std::vector<InitFrame>& frames, const Rig& rig) {
  std::map<FeatureId, std::vector<Sight>> tracks;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
      const CameraObservations* seen = observations_of(frames[i], rig.cameras[c].name);
      if (seen == nullptr) continue;
      for (const FeatureObservation& f : seen->features) tracks[f.id].push_back({i, c, f.point});
    }
  }
  std::erase_if(tracks, [](const auto& track) { return track.second.size() < 4; });
  return tracks;
}

/// Poses relative to the first body frame but for velocity and gravity: p_j = v t_j + g t_j^2 / 2 + alpha_j.
struct RelativeMotion {
  double t = 0.0;
  Matrix3d R = Matrix3d::Identity();
  Vector3d alpha = Vector3d::Zero(), beta = Vector3d::Zero();  ///< position and velocity from the accelerometer
};

/// Adds one track's equations Pi_j (P - v t_j - g t_j^2/2) = Pi_j (alpha_j + R_j p_B_C) to the normal equations of
/// (v, g), with P eliminated.
void add_track(const std::vector<Sight>& track, const std::vector<RelativeMotion>& motion, const Rig& rig, Matrix6d& H,
               Vector6d& b) {
  Eigen::Matrix<double, 9, 9> N = Eigen::Matrix<double, 9, 9>::Zero();
  Eigen::Matrix<double, 9, 1> c = Eigen::Matrix<double, 9, 1>::Zero();
  for (const Sight& sight : track) {
    const RelativeMotion& m = motion[sight.frame];
    const SE3& T_B_C = rig.cameras[sight.camera].T_B_C;
    Eigen::Matrix<double, 2, 3> pi;
    pi << 1, 0, -sight.point.x(), 0, 1, -sight.point.y();
    pi *= T_B_C.R().transpose() * m.R.transpose();
    Eigen::Matrix<double, 2, 9> A;
    A << pi, -m.t * pi, -0.5 * m.t * m.t * pi;
    N += A.transpose() * A;
    c += A.transpose() * (pi * (m.alpha + m.R * T_B_C.translation()));
  }
  const Eigen::LDLT<Matrix3d> P_P(N.topLeftCorner<3, 3>() + 1e-9 * Matrix3d::Identity());
  H += N.bottomRightCorner<6, 6>() - N.bottomLeftCorner<6, 3>() * P_P.solve(N.topRightCorner<3, 6>());
  b += c.tail<6>() - N.bottomLeftCorner<6, 3>() * P_P.solve(c.head<3>());
}

/// The pose of a sight's camera in the frame of the first body.
SE3 camera_pose(const Sight& sight, const std::vector<RelativeMotion>& motion, const Rig& rig, const Vector6d& v_g) {
  const RelativeMotion& m = motion[sight.frame];
  return SE3(m.R, m.t * v_g.head<3>() + 0.5 * m.t * m.t * v_g.tail<3>() + m.alpha) * rig.cameras[sight.camera].T_B_C;
}

/// One Gauss-Newton term of the reprojection errors of a track over (v, g), its point at its best place and eliminated.
void add_reprojection(const std::vector<Sight>& track, const std::vector<RelativeMotion>& motion, const Rig& rig,
                      const Vector6d& v_g, Matrix6d& H, Vector6d& b) {
  std::vector<View> views;
  for (const Sight& sight : track) views.push_back({camera_pose(sight, motion, rig, v_g), sight.point});
  const auto point = triangulate(views, kRayNoise);
  if (!point) return;
  Eigen::Matrix<double, 9, 9> N = Eigen::Matrix<double, 9, 9>::Zero();
  Eigen::Matrix<double, 9, 1> c = Eigen::Matrix<double, 9, 1>::Zero();
  for (std::size_t k = 0; k < track.size(); ++k) {
    const double t = motion[track[k].frame].t;
    const Vector3d p_C = views[k].T_W_C.inverse() * point->p_W;
    const Eigen::Vector2d seen_now = p_C.hnormalized(), r = (seen_now - track[k].point) / kRayNoise;
    Eigen::Matrix<double, 2, 3> d_r_d_P;
    d_r_d_P << 1, 0, -seen_now.x(), 0, 1, -seen_now.y();
    d_r_d_P *= views[k].T_W_C.R().transpose() / (p_C.z() * kRayNoise);
    Eigen::Matrix<double, 2, 9> J;
    J << d_r_d_P, -t * d_r_d_P, -0.5 * t * t * d_r_d_P;
    const double weight = r.norm() < 1.5 ? 1.0 : 1.5 / r.norm();  // Huber
    N += weight * J.transpose() * J;
    c += weight * J.transpose() * r;
  }
  const Eigen::LDLT<Matrix3d> P_P(N.topLeftCorner<3, 3>());
  H += N.bottomRightCorner<6, 6>() - N.bottomLeftCorner<6, 3>() * P_P.solve(N.topRightCorner<3, 6>());
  b += c.tail<6>() - N.bottomLeftCorner<6, 3>() * P_P.solve(c.head<3>());
}

/// Noise makes the linear solution too small, points too near: what follows minimises the reprojection error itself, |g|
/// kept.
Vector6d refine(const std::map<FeatureId, std::vector<Sight>>& tracks, const std::vector<RelativeMotion>& motion,
                const Rig& rig, Vector6d v_g) {
  for (int iteration = 0; iteration < 10; ++iteration) {
    Matrix6d H = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero();
    for (const auto& [id, track] : tracks) add_reprojection(track, motion, rig, v_g, H, b);
    const Vector3d up = -v_g.tail<3>().normalized(), tangent = up.unitOrthogonal();
    Eigen::Matrix<double, 6, 5> free = Eigen::Matrix<double, 6, 5>::Zero();
    free.topLeftCorner<3, 3>().setIdentity();
    free.col(3).tail<3>() = tangent;
    free.col(4).tail<3>() = up.cross(tangent);
    const Eigen::Matrix<double, 5, 1> step = (free.transpose() * H * free).ldlt().solve(-free.transpose() * b);
    if (!step.allFinite()) return v_g;
    v_g += free * step;
    v_g.tail<3>() *= kGravity / v_g.tail<3>().norm();
    if (step.norm() < 1e-4) break;
  }
  return v_g;
}

/// min x^T H x - 2 b^T x over x = (v, g) with |g| = kGravity: v is eliminated, g solves (D + lambda I) g = d, the largest
/// root of |g(lambda)| = kGravity being the global minimum.
Vector6d solve_with_gravity_length(const Matrix6d& H, const Vector6d& b, double* free_length) {
  const Eigen::LDLT<Matrix3d> H_vv(H.topLeftCorner<3, 3>());
  const Matrix3d D = H.bottomRightCorner<3, 3>() - H.bottomLeftCorner<3, 3>() * H_vv.solve(H.topRightCorner<3, 3>());
  const Vector3d d = b.tail<3>() - H.bottomLeftCorner<3, 3>() * H_vv.solve(b.head<3>());
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
  Vector6d x;
  x << H_vv.solve(b.head<3>() - H.topRightCorner<3, 3>() * g), g;
  return x;
}

std::vector<RelativeMotion> relative_motion(const std::vector<InitFrame>& frames, const Vector3d& bg,
                                            const ImuNoise& noise) {
  std::vector<RelativeMotion> motion(1);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Preintegration imu(frames[i].imu, bg, Vector3d::Zero(), noise);
    const RelativeMotion& m = motion.back();
    RelativeMotion next;
    next.t = m.t + imu.dt();
    next.R = m.R * imu.dR(bg).toRotationMatrix();
    next.alpha = m.alpha + m.beta * imu.dt() + m.R * imu.dp(bg, Vector3d::Zero());
    next.beta = m.beta + m.R * imu.dv(bg, Vector3d::Zero());
    motion.push_back(next);
  }
  return motion;
}

}  // namespace

std::optional<Vector3d> align_gyro_bias(const std::vector<InitFrame>& frames, const Rig& rig, const ImuNoise& noise) {
  const std::vector<RotationPair> pairs = rotation_pairs(frames, rig, noise);
  if (pairs.size() < 3) return std::nullopt;
  Vector3d bg = Vector3d::Zero();
  for (int iteration = 0; iteration < 10; ++iteration) {
    Matrix3d H = Matrix3d::Identity() / (kBiasPrior * kBiasPrior);
    Vector3d g = bg / (kBiasPrior * kBiasPrior);
    for (const RotationPair& pair : pairs) add_coplanarity(pair, bg, H, g);
    const Vector3d step = H.ldlt().solve(-g);
    bg += step;
    if (step.norm() < 1e-6) break;
  }
  return bg;
}

std::optional<Alignment> align(const std::vector<InitFrame>& frames, const Rig& rig, const ImuNoise& noise) {
  const std::optional<Vector3d> bg = align_gyro_bias(frames, rig, noise);
  if (!bg) return std::nullopt;
  const std::vector<RelativeMotion> motion = relative_motion(frames, *bg, noise);
  const auto tracks = gather_tracks(frames, rig);
  if (tracks.size() < kMinPairCorners) return std::nullopt;

  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  for (const auto& [id, track] : tracks) add_track(track, motion, rig, H, b);
  double free_length = 0.0;
  const Vector6d linear = solve_with_gravity_length(H, b, &free_length);
  if (!linear.allFinite()) return std::nullopt;
  const Vector6d v_g = refine(tracks, motion, rig, linear);
  const Vector3d v = v_g.head<3>(), g = v_g.tail<3>();
  const SE3 T_W_B0(Eigen::Quaterniond::FromTwoVectors(-g, Vector3d::UnitZ()), Vector3d::Zero());
  Alignment result;
  result.gravity_error = free_length / kGravity - 1.0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const RelativeMotion& m = motion[i];
    NavState state;
    state.t = frames[i].t;
    state.T_W_B = T_W_B0 * SE3(m.R, v * m.t + 0.5 * m.t * m.t * g + m.alpha);
    state.v_W = T_W_B0.rotation() * (v + g * m.t + m.beta);
    state.bias_gyro = *bg;
    result.states.push_back(state);
  }
  return result;
}

double median_parallax(const std::vector<InitFrame>& frames, const Rig& rig, const ImuNoise& noise) {
  for (std::size_t first = 0; first + 1 < frames.size(); ++first) {
    std::vector<RayPair> rays;
    for (const RigCamera& camera : rig.cameras) {
      const std::vector<RayPair> more = common_rays(frames[first], frames.back(), camera);
      rays.insert(rays.end(), more.begin(), more.end());
    }
    if (rays.size() < kMinPairCorners) continue;
    // Without its bias the gyro would call the drift of a second or two parallax.
    const Vector3d bg = align_gyro_bias(frames, rig, noise).value_or(Vector3d::Zero());
    const Matrix3d R = between(frames, first, frames.size() - 1, bg, noise).dR(bg).toRotationMatrix();
    std::vector<double> angles;
    for (const RayPair& pair : rays) {
      const Vector3d turned = R * pair.ray_1;
      angles.push_back(std::atan2(pair.ray_0.cross(turned).norm(), pair.ray_0.dot(turned)));
    }
    return median(std::move(angles));
  }
  return 0.0;
}

}  // namespace edged
