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
constexpr std::size_t kMinSights = 3;    // of a corner
constexpr double kBiasPrior = 0.15;      // [rad/s]
constexpr double kRayNoise = 5e-3;       // [rad]

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
  std::erase_if(tracks, [](const auto& track) { return track.second.size() < kMinSights; });
  return tracks;
}

/// What is unknown once rotations are: first velocity, gravity, both in the first body frame, and accelerometer bias.
using Start = Eigen::Matrix<double, 9, 1>;
using StartMatrix = Eigen::Matrix<double, 9, 9>;
/// Of a track: its point P, then the start.
using PointAndStart = Eigen::Matrix<double, 12, 1>;
using PointAndStartMatrix = Eigen::Matrix<double, 12, 12>;

/// Poses relative to the first body frame: p_j = alpha_j + B_j x, x being the start.
struct RelativeMotion {
  double t = 0.0;
  Matrix3d R = Matrix3d::Identity();
  Vector3d alpha = Vector3d::Zero(), beta = Vector3d::Zero();          ///< position and velocity from the accelerometer
  Matrix3d d_alpha = Matrix3d::Zero(), d_beta = Matrix3d::Zero();      ///< their derivatives by its bias

  Eigen::Matrix<double, 3, 9> d_position() const {
    Eigen::Matrix<double, 3, 9> B;
    B << t * Matrix3d::Identity(), 0.5 * t * t * Matrix3d::Identity(), d_alpha;
    return B;
  }
  Vector3d position(const Start& x) const { return alpha + d_position() * x; }
  Vector3d velocity(const Start& x) const { return beta + x.head<3>() + t * x.segment<3>(3) + d_beta * x.tail<3>(); }
};

/// Normal equations H x = b of the start.
struct StartEquations {
  StartMatrix H = StartMatrix::Zero();
  Start b = Start::Zero();

  /// Adds those of a track, its point eliminated.
  void add(const PointAndStartMatrix& N, const PointAndStart& c) {
    const Eigen::LDLT<Matrix3d> P_P(N.topLeftCorner<3, 3>() + 1e-9 * Matrix3d::Identity());
    H += N.bottomRightCorner<9, 9>() - N.bottomLeftCorner<9, 3>() * P_P.solve(N.topRightCorner<3, 9>());
    b += c.tail<9>() - N.bottomLeftCorner<9, 3>() * P_P.solve(c.head<3>());
  }
};

/// Adds one track's equations Pi_j (P - p_j) = Pi_j R_j p_B_C.
void add_track(const std::vector<Sight>& track, const std::vector<RelativeMotion>& motion, const Rig& rig,
               StartEquations& equations) {
  PointAndStartMatrix N = PointAndStartMatrix::Zero();
  PointAndStart c = PointAndStart::Zero();
  for (const Sight& sight : track) {
    const RelativeMotion& m = motion[sight.frame];
    const SE3& T_B_C = rig.cameras[sight.camera].T_B_C;
    Eigen::Matrix<double, 2, 3> pi;
    pi << 1, 0, -sight.point.x(), 0, 1, -sight.point.y();
    pi *= T_B_C.R().transpose() * m.R.transpose();
    Eigen::Matrix<double, 2, 12> A;
    A << pi, -pi * m.d_position();
    N += A.transpose() * A;
    c += A.transpose() * (pi * (m.alpha + m.R * T_B_C.translation()));
  }
  equations.add(N, c);
}

/// The pose of a sight's camera in the frame of the first body.
SE3 camera_pose(const Sight& sight, const std::vector<RelativeMotion>& motion, const Rig& rig, const Start& x) {
  const RelativeMotion& m = motion[sight.frame];
  return SE3(m.R, m.position(x)) * rig.cameras[sight.camera].T_B_C;
}

/// One Gauss-Newton term of the reprojection errors of a track around x, its point at its best place and eliminated.
void add_reprojection(const std::vector<Sight>& track, const std::vector<RelativeMotion>& motion, const Rig& rig,
                      const Start& x, StartEquations& equations) {
  std::vector<View> views;
  for (const Sight& sight : track) views.push_back({camera_pose(sight, motion, rig, x), sight.point});
  const auto point = triangulate(views, kRayNoise);
  if (!point) return;
  PointAndStartMatrix N = PointAndStartMatrix::Zero();
  PointAndStart c = PointAndStart::Zero();
  for (std::size_t k = 0; k < track.size(); ++k) {
    const Vector3d p_C = views[k].T_W_C.inverse() * point->p_W;
    const Eigen::Vector2d seen_now = p_C.hnormalized(), r = (seen_now - track[k].point) / kRayNoise;
    Eigen::Matrix<double, 2, 3> d_r_d_P;
    d_r_d_P << 1, 0, -seen_now.x(), 0, 1, -seen_now.y();
    d_r_d_P *= views[k].T_W_C.R().transpose() / (p_C.z() * kRayNoise);
    Eigen::Matrix<double, 2, 12> J;
    J << d_r_d_P, -d_r_d_P * motion[track[k].frame].d_position();
    const double weight = r.norm() < 1.5 ? 1.0 : 1.5 / r.norm();  // Huber
    N += weight * J.transpose() * J;
    c -= weight * J.transpose() * r;
  }
  equations.add(N, c);
}

/// The directions in which a start is free: gravity keeps its length.
Eigen::Matrix<double, 9, 8> free_directions(const Start& x) {
  const Vector3d up = -x.segment<3>(3).normalized(), tangent = up.unitOrthogonal();
  Eigen::Matrix<double, 9, 8> free = Eigen::Matrix<double, 9, 8>::Zero();
  free.topLeftCorner<3, 3>().setIdentity();
  free.block<3, 1>(3, 3) = tangent;
  free.block<3, 1>(3, 4) = up.cross(tangent);
  free.bottomRightCorner<3, 3>().setIdentity();
  return free;
}

struct Refined {
  Start x;
  StartMatrix covariance;
};

/// Noise makes the linear solution too small, points too near: what follows minimises the reprojection error itself, |g|
/// kept, the accelerometer bias held near zero.
std::optional<Refined> refine(const std::map<FeatureId, std::vector<Sight>>& tracks,
                              const std::vector<RelativeMotion>& motion, const Rig& rig, Start x, double bias_sigma) {
  Eigen::Matrix<double, 8, 8> H;
  Eigen::Matrix<double, 9, 8> free;
  for (int iteration = 0; iteration < 12; ++iteration) {
    StartEquations equations;
    for (const auto& [id, track] : tracks) add_reprojection(track, motion, rig, x, equations);
    equations.H.bottomRightCorner<3, 3>() += Matrix3d::Identity() / (bias_sigma * bias_sigma);
    equations.b.tail<3>() -= x.tail<3>() / (bias_sigma * bias_sigma);
    free = free_directions(x);
    H = free.transpose() * equations.H * free;
    const Eigen::Matrix<double, 8, 1> step = H.ldlt().solve(free.transpose() * equations.b);
    if (!step.allFinite()) return std::nullopt;
    x += free * step;
    x.segment<3>(3) *= kGravity / x.segment<3>(3).norm();
    if (step.norm() < 1e-4) break;
  }
  return Refined{x, free * H.inverse() * free.transpose()};
}

/// Standard deviation of the longest baseline over its length.
double relative_sigma(const Refined& start, const std::vector<RelativeMotion>& motion) {
  const RelativeMotion& farthest = *std::max_element(motion.begin(), motion.end(), [&](const auto& a, const auto& b) {
    return a.position(start.x).norm() < b.position(start.x).norm();
  });
  const Vector3d way = farthest.position(start.x);
  const Start d_way = farthest.d_position().transpose() * way;
  return std::sqrt(d_way.dot(start.covariance * d_way)) / way.squaredNorm();
}

/// min x^T H x - 2 b^T x over x = (v, g), the bias zero, with |g| = kGravity: v is eliminated, g solves (D + lambda I) g =
/// d, the largest root of |g(lambda)| = kGravity being the global minimum.
Start solve_with_gravity_length(const StartEquations& equations, double* free_length) {
  const Eigen::Matrix<double, 6, 6> H = equations.H.topLeftCorner<6, 6>();
  const Eigen::Matrix<double, 6, 1> b = equations.b.head<6>();
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
  Start x;
  x << H_vv.solve(b.head<3>() - H.topRightCorner<3, 3>() * g), g, Vector3d::Zero();
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
    next.d_alpha = m.d_alpha + m.d_beta * imu.dt() + m.R * imu.d_dp_d_ba();
    next.d_beta = m.d_beta + m.R * imu.d_dv_d_ba();
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

std::optional<Alignment> align(const std::vector<InitFrame>& frames, const Rig& rig, const ImuNoise& noise,
                               double accel_bias_sigma) {
  const std::optional<Vector3d> bg = align_gyro_bias(frames, rig, noise);
  if (!bg) return std::nullopt;
  const std::vector<RelativeMotion> motion = relative_motion(frames, *bg, noise);
  const auto tracks = gather_tracks(frames, rig);
  if (tracks.size() < kMinPairCorners) return std::nullopt;

  StartEquations equations;
  for (const auto& [id, track] : tracks) add_track(track, motion, rig, equations);
  double free_length = 0.0;
  const Start linear = solve_with_gravity_length(equations, &free_length);
  if (!linear.allFinite()) return std::nullopt;
  const std::optional<Refined> start = refine(tracks, motion, rig, linear, accel_bias_sigma);
  if (!start) return std::nullopt;
  const Start& x = start->x;
  const SE3 T_W_B0(Eigen::Quaterniond::FromTwoVectors(-x.segment<3>(3), Vector3d::UnitZ()), Vector3d::Zero());
  Alignment result;
  result.gravity_error = free_length / kGravity - 1.0;
  result.scale_sigma = relative_sigma(*start, motion);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    NavState state;
    state.t = frames[i].t;
    state.T_W_B = T_W_B0 * SE3(motion[i].R, motion[i].position(x));
    state.v_W = T_W_B0.rotation() * motion[i].velocity(x);
    state.bias_gyro = *bg;
    state.bias_accel = x.tail<3>();
    result.states.push_back(state);
  }
  return result;
}

}  // namespace edged
