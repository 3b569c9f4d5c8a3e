// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Step 1 of the alignment: the gyro bias, from rotations.
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>

#include "edged/estimator/initialization/alignment.hpp"
#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A feature observed in two frames, as rays with the orientation of the body frame at each.
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
        if (rays.size() < kAlignmentTuning.min_pair_features) continue;
        out.push_back({std::move(rays), between(frames, i, i + step, Vector3d::Zero(), noise)});
      }
    }
  }
  return out;
}

/// The baseline that fits the features of a pair best under the rotation R. Noise turns every normal f_0 x R f_1 about
/// its rays only: C is their covariance, without which the baseline is biased towards the optical axis.
Vector3d baseline_of(const RotationPair& pair, const Matrix3d& R) {
  Matrix3d M = Matrix3d::Zero(), C = Matrix3d::Zero();
  for (const RayPair& rays : pair.rays) {
    const Vector3d n = rays.ray_0.cross(R * rays.ray_1);
    M += n * n.transpose();
    C += Matrix3d::Identity() - rays.ray_0 * rays.ray_0.transpose();
  }
  return Eigen::GeneralizedSelfAdjointEigenSolver<Matrix3d>(M, C).eigenvectors().col(0).normalized();
}

/// One Gauss-Newton term: the angle of each feature's ray to the plane of its partner and the baseline; the baseline,
/// two angles per pair, is eliminated.
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
    const double e = baseline.dot(n) / (across * kAlignmentTuning.ray_sigma);
    Eigen::Matrix<double, 5, 1> J;
    J.head<3>() = (baseline.transpose() * skew(rays.ray_0) * -R * skew(rays.ray_1) * d_phi_d_bg).transpose() /
                  (across * kAlignmentTuning.ray_sigma);
    J.tail<2>() =
        tangent.transpose() * (n / (across * kAlignmentTuning.ray_sigma) + e * along / (across * across) * rays.ray_0);
    const double huber = kAlignmentTuning.huber_sigma, weight = std::abs(e) < huber ? 1.0 : huber / std::abs(e);
    N += weight * J * J.transpose();
    c += weight * J * e;
  }
  const Eigen::Matrix2d baseline_info = N.bottomRightCorner<2, 2>() + Eigen::Matrix2d::Identity();
  const Eigen::Matrix<double, 2, 3> coupling = baseline_info.ldlt().solve(N.bottomLeftCorner<2, 3>());
  H += N.topLeftCorner<3, 3>() - coupling.transpose() * N.bottomLeftCorner<2, 3>();
  g += c.head<3>() - coupling.transpose() * c.tail<2>();
}

}  // namespace

std::optional<Vector3d> align_gyro_bias(const std::vector<InitFrame>& frames, const Rig& rig, const ImuNoise& noise) {
  const std::vector<RotationPair> pairs = rotation_pairs(frames, rig, noise);
  if (pairs.size() < 3) return std::nullopt;
  Vector3d bg = Vector3d::Zero();
  for (int iteration = 0; iteration < 10; ++iteration) {
    Matrix3d H = Matrix3d::Identity() / (kAlignmentTuning.gyro_bias_sigma * kAlignmentTuning.gyro_bias_sigma);
    Vector3d g = bg / (kAlignmentTuning.gyro_bias_sigma * kAlignmentTuning.gyro_bias_sigma);
    for (const RotationPair& pair : pairs) add_coplanarity(pair, bg, H, g);
    const Vector3d step = H.ldlt().solve(-g);
    bg += step;
    if (step.norm() < 1e-6) break;
  }
  return bg;
}

}  // namespace edged
