// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/calibrate/imu_start.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "edged/core/angles.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr Duration kShortest = std::chrono::milliseconds(20), kLongest = std::chrono::milliseconds(300);
constexpr double kSearched_s = 1.0, kCoarse_s = 0.004, kFine_s = 0.0002;
constexpr std::size_t kFewestTurns = 40;
constexpr double kLeastCorrelation = 0.7;
constexpr double kLeastRate = 6.0 * kDegree;  // [rad/s] rms about the axis that turned least

/// A ViewTurn in seconds.
struct CameraTurn {
  double begin_s, end_s;
  Vector3d angle_C;
};

std::vector<CameraTurn> camera_turns(const TargetViews& camera, const std::vector<std::optional<SE3>>& T_C_T,
                                     Timestamp zero) {
  std::vector<CameraTurn> out;
  for (const ViewTurn& turn : view_turns(camera, T_C_T))
    out.push_back({to_seconds(turn.begin - zero), to_seconds(turn.end - zero), turn.angle_C});
  return out;
}

/// The integral of the gyro's readings, linear between samples.
class GyroSum {
 public:
  GyroSum(std::span<const ImuSample> imu, Timestamp zero) {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t i = 0; i < imu.size(); ++i) {
      if (i > 0) sum += 0.5 * to_seconds(imu[i].t - imu[i - 1].t) * (imu[i].gyro_B + imu[i - 1].gyro_B);
      t_.push_back(to_seconds(imu[i].t - zero));
      sum_.push_back(sum);
    }
  }
  /// The integral from one time to another; nothing outside of the samples.
  std::optional<Vector3d> between(double begin_s, double end_s) const {
    const auto a = at(begin_s), b = at(end_s);
    return a && b ? std::optional<Vector3d>(*b - *a) : std::nullopt;
  }

 private:
  std::optional<Vector3d> at(double t_s) const {
    const auto next = std::ranges::upper_bound(t_, t_s);
    if (next == t_.begin() || next == t_.end()) return std::nullopt;
    const auto i = static_cast<std::size_t>(next - t_.begin());
    const double share = (t_s - t_[i - 1]) / (t_[i] - t_[i - 1]);
    return sum_[i - 1] + share * (sum_[i] - sum_[i - 1]);
  }
  std::vector<double> t_;
  std::vector<Vector3d> sum_;
};

/// Correlation of the mean rates of camera and gyro; -1 where too few turns lie within the samples.
double correlation(const std::vector<CameraTurn>& turns, const GyroSum& gyro, double offset_s) {
  double n = 0.0, a = 0.0, b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  for (const CameraTurn& turn : turns) {
    const auto angle_B = gyro.between(turn.begin_s + offset_s, turn.end_s + offset_s);
    if (!angle_B) continue;
    const double x = turn.angle_C.norm() / (turn.end_s - turn.begin_s),
                 y = angle_B->norm() / (turn.end_s - turn.begin_s);
    n += 1.0, a += x, b += y, aa += x * x, bb += y * y, ab += x * y;
  }
  if (n < static_cast<double>(kFewestTurns)) return -1.0;
  return (n * ab - a * b) / std::sqrt(std::max(1e-300, (n * aa - a * a) * (n * bb - b * b)));
}

/// The rotation that takes the camera's turns to the gyro's, and the gyro's bias, in turns; and what is left over.
struct TurnFit {
  ImuStart start;
  double squares = std::numeric_limits<double>::infinity();  // mean of the squared differences [rad^2]
};

TurnFit fit_turns(const std::vector<CameraTurn>& turns, const GyroSum& gyro, double offset_s) {
  TurnFit out;
  out.start.time_offset_s = offset_s;
  std::vector<std::pair<const CameraTurn*, Vector3d>> pairs;
  for (const CameraTurn& turn : turns)
    if (const auto angle_B = gyro.between(turn.begin_s + offset_s, turn.end_s + offset_s))
      pairs.emplace_back(&turn, *angle_B);
  if (pairs.size() < kFewestTurns) return out;
  for (int round = 0; round < 4; ++round) {
    Matrix3d sum = Matrix3d::Zero();
    for (const auto& [turn, angle_B] : pairs)
      sum += (angle_B - (turn->end_s - turn->begin_s) * out.start.bias_gyro) * turn->angle_C.transpose();
    const Eigen::JacobiSVD<Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Vector3d sign(1.0, 1.0, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0);
    const Matrix3d R = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
    out.start.R_B_C = Eigen::Quaterniond(R).normalized();
    Vector3d left = Vector3d::Zero();
    double length_s = 0.0;
    for (const auto& [turn, angle_B] : pairs)
      left += angle_B - R * turn->angle_C, length_s += turn->end_s - turn->begin_s;
    out.start.bias_gyro = left / length_s;
  }
  out.squares = 0.0;
  for (const auto& [turn, angle_B] : pairs)
    out.squares += (angle_B - out.start.R_B_C * turn->angle_C - (turn->end_s - turn->begin_s) * out.start.bias_gyro)
                       .squaredNorm() /
                   static_cast<double>(pairs.size());
  return out;
}

void check_turns(const TargetViews& camera, const std::vector<CameraTurn>& turns) {
  if (turns.size() < kFewestTurns)
    throw InputError::format(
        "camera {}: only {} turns between successive views of the target, {} are needed; record longer, and keep the "
        "target in view",
        camera.name, turns.size(), kFewestTurns);
  Matrix3d squares = Matrix3d::Zero();
  double length_s = 0.0;
  for (const CameraTurn& turn : turns) {
    squares += turn.angle_C * turn.angle_C.transpose() / (turn.end_s - turn.begin_s);
    length_s += turn.end_s - turn.begin_s;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(squares / length_s);
  const double rate = std::sqrt(std::max(0.0, axes.eigenvalues()[0]));
  if (rate >= kLeastRate) return;
  Eigen::Index axis = 0;
  axes.eigenvectors().col(0).cwiseAbs().maxCoeff(&axis);
  constexpr const char* kAxes[] = {"its x axis (nod up and down)", "its y axis (look left and right)",
                                   "its optical axis (roll)"};
  throw InputError::format(
      "camera {}: it hardly rotated about {}: {:.1f} deg/s on average, {:.0f} are needed for pose and clock of the "
      "IMU; rotate back and forth about all three axes",
      camera.name, kAxes[axis], rate / kDegree, kLeastRate / kDegree);
}

}  // namespace

std::vector<ViewTurn> view_turns(const TargetViews& camera, const std::vector<std::optional<SE3>>& T_C_T) {
  std::vector<ViewTurn> out;
  std::optional<std::size_t> last;
  for (std::size_t i = 0; i < camera.views.size(); ++i) {
    if (!T_C_T[i]) continue;
    if (last) {
      const Timestamp begin = camera.views[*last].t, end = camera.views[i].t;
      if (end - begin >= kShortest && end - begin <= kLongest)
        out.push_back({begin, end, so3::log(T_C_T[*last]->rotation() * T_C_T[i]->rotation().conjugate())});
    }
    last = i;
  }
  return out;
}

ImuStart align_imu(const TargetViews& camera, const std::vector<std::optional<SE3>>& T_C_T,
                   std::span<const ImuSample> imu) {
  if (imu.size() < 10) throw InputError("the recording has no IMU samples; give them with --imu, or use --no-imu");
  const Timestamp zero = imu.front().t;
  const std::vector<CameraTurn> turns = camera_turns(camera, T_C_T, zero);
  check_turns(camera, turns);
  const GyroSum gyro(imu, zero);
  double best = -1.0, offset_s = 0.0;
  for (double tried_s = -kSearched_s; tried_s <= kSearched_s; tried_s += kCoarse_s)
    if (const double r = correlation(turns, gyro, tried_s); r > best) best = r, offset_s = tried_s;
  if (best < kLeastCorrelation)
    throw InputError::format(
        "camera {}: turns differently from the gyro (correlation {:.2f} of {:.1f}): are they of one recording, on one "
        "body? An IMU whose clock is more than {:.0f} s off needs --imu-time-offset auto",
        camera.name, best, kLeastCorrelation, kSearched_s);
  TurnFit fit;
  const double about_s = offset_s;
  for (double tried_s = about_s - 2 * kCoarse_s; tried_s <= about_s + 2 * kCoarse_s; tried_s += kFine_s)
    if (const TurnFit tried = fit_turns(turns, gyro, tried_s); tried.squares < fit.squares) fit = tried;
  return fit.start;
}

}  // namespace edged
