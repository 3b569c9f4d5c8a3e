// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/alignment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>

#include "edged/camera/two_view.hpp"

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
  for (std::size_t step : {std::size_t{1}, std::size_t{3}}) {
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

/// One Gauss-Newton term: rays of a pair must be coplanar with the baseline their rotation implies.
void add_coplanarity(const RotationPair& pair, const Vector3d& bg, Matrix3d& H, Vector3d& g) {
  const Matrix3d R = pair.imu.dR(bg).toRotationMatrix();
  const Matrix3d d_phi_d_bg =
      so3::right_jacobian(pair.imu.d_dR_d_bg() * (bg - pair.imu.bias_gyro())) * pair.imu.d_dR_d_bg();
  Matrix3d M = Matrix3d::Zero();
  for (const RayPair& rays : pair.rays) {
    const Vector3d n = rays.ray_0.cross(R * rays.ray_1);
    M += n * n.transpose();
  }
  const Vector3d baseline = Eigen::SelfAdjointEigenSolver<Matrix3d>(M).eigenvectors().col(0);
  for (const RayPair& rays : pair.rays) {
    const double e = baseline.dot(rays.ray_0.cross(R * rays.ray_1)) / kRayNoise;
    const Vector3d J =
        (baseline.transpose() * skew(rays.ray_0) * -R * skew(rays.ray_1) * d_phi_d_bg).transpose() / kRayNoise;
    const double weight = std::abs(e) < 1.5 ? 1.0 : 1.5 / std::abs(e);  // Huber
    H += weight * J * J.transpose();
    g += weight * J * e;
  }
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
/// (v, g), with P eliminated. `v_g` (from the pass before) scales the rows to angles.
void add_track(const std::vector<Sight>& track, const std::vector<RelativeMotion>& motion, const Rig& rig,
               const Vector6d* v_g, Matrix6d& H, Vector6d& b) {
  const auto rows_of = [&](const Sight& s) -> Eigen::Matrix<double, 2, 3> {
    Eigen::Matrix<double, 2, 3> pi;
    pi << 1, 0, -s.point.x(), 0, 1, -s.point.y();
    return pi * (rig.cameras[s.camera].T_B_C.R().transpose() * motion[s.frame].R.transpose());
  };
  std::vector<double> scale(track.size(), 1.0);
  for (int pass = v_g == nullptr ? 1 : 0; pass < 2; ++pass) {
    Eigen::Matrix<double, 9, 9> N = Eigen::Matrix<double, 9, 9>::Zero();
    Eigen::Matrix<double, 9, 1> c = Eigen::Matrix<double, 9, 1>::Zero();
    for (std::size_t k = 0; k < track.size(); ++k) {
      const RelativeMotion& m = motion[track[k].frame];
      const auto pi = rows_of(track[k]);
      Eigen::Matrix<double, 2, 9> A;
      A << pi, -m.t * pi, -0.5 * m.t * m.t * pi;
      A *= scale[k];
      const Vector3d fixed = m.alpha + m.R * rig.cameras[track[k].camera].T_B_C.translation();
      N += A.transpose() * A;
      c += A.transpose() * (scale[k] * (pi * fixed));
    }
    const Eigen::LDLT<Matrix3d> P_P(N.topLeftCorner<3, 3>() + 1e-9 * Matrix3d::Identity());
    if (pass == 1) {
      H += N.bottomRightCorner<6, 6>() - N.bottomLeftCorner<6, 3>() * P_P.solve(N.topRightCorner<3, 6>());
      b += c.tail<6>() - N.bottomLeftCorner<6, 3>() * P_P.solve(c.head<3>());
      return;
    }
    const Vector3d P = P_P.solve(c.head<3>() - N.topRightCorner<3, 6>() * *v_g);
    for (std::size_t k = 0; k < track.size(); ++k) {
      const RelativeMotion& m = motion[track[k].frame];
      const SE3& T_B_C = rig.cameras[track[k].camera].T_B_C;
      const Vector3d p_Bj = v_g->head<3>() * m.t + 0.5 * m.t * m.t * v_g->tail<3>() + m.alpha;
      const double z = (T_B_C.inverse() * Vector3d(m.R.transpose() * (P - p_Bj))).z();
      scale[k] = 1.0 / std::clamp(z, 0.1, 50.0);
    }
  }
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

  Vector6d v_g;
  double free_length = 0.0;
  for (int pass = 0; pass < 3; ++pass) {
    Matrix6d H = Matrix6d::Zero();
    Vector6d b = Vector6d::Zero();
    for (const auto& [id, track] : tracks) add_track(track, motion, rig, pass == 0 ? nullptr : &v_g, H, b);
    v_g = solve_with_gravity_length(H, b, &free_length);
    if (!v_g.allFinite()) return std::nullopt;
  }

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
    const Matrix3d R =
        between(frames, first, frames.size() - 1, Vector3d::Zero(), noise).dR(Vector3d::Zero()).toRotationMatrix();
    std::vector<double> angles;
    for (const RayPair& pair : rays) {
      const Vector3d turned = R * pair.ray_1;
      angles.push_back(std::atan2(pair.ray_0.cross(turned).norm(), pair.ray_0.dot(turned)));
    }
    const auto middle = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2);
    std::nth_element(angles.begin(), middle, angles.end());
    return *middle;
  }
  return 0.0;
}

}  // namespace edged
