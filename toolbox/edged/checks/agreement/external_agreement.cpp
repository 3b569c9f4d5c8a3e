// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/external_agreement.hpp"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "edged/core/angles.hpp"

namespace edged {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kMostSamples = 22'500;
constexpr Duration kWindow = std::chrono::seconds(4);
constexpr Duration kForGravity = std::chrono::seconds(4);  // duration before and after a window
constexpr std::size_t kFewestSamples = 12;                 // in a window
constexpr Duration kForRate = std::chrono::milliseconds(10);
constexpr double kCorrelated = 2.0;    // inflation of sigmas: the residuals of a window are correlated
constexpr double kKnown = 0.2;         // largest sigma of a determined scale or entry of a rotation
constexpr double kKnownHeight = 0.25;  // largest sigma of the determined scale of the height
constexpr double kSureSigmas = 4.0;
constexpr double kArmSigma_m = 0.3;  // prior of the lever arm

/// Calls `use` with the samples of each window.
template <typename Sample, typename Use>
void for_each_window(const std::vector<Sample>& samples, const Use& use) {
  for (std::size_t begin = 0; begin < samples.size();) {
    std::size_t end = begin;
    while (end < samples.size() && samples[end].t - samples[begin].t < kWindow) ++end;
    if (end - begin >= kFewestSamples) use(std::span(samples).subspan(begin, end - begin));
    begin = end;
  }
}

/// The columns of A minus their projection on those of C.
MatrixXd unexplained(const MatrixXd& A, const MatrixXd& C) { return A - C * C.householderQr().solve(A); }

/// Normal equations of the shared unknowns of a sensor and the IMU. The unknowns of each window are eliminated.
struct Equations {
  explicit Equations(Eigen::Index unknowns) : N(MatrixXd::Zero(unknowns, unknowns)), b(VectorXd::Zero(unknowns)) {}

  void add(const MatrixXd& A, const VectorXd& y, const MatrixXd& own) {
    const MatrixXd A_left = unexplained(A, own);
    const VectorXd y_left = unexplained(y, own);
    N += A_left.transpose() * A_left;
    b += A_left.transpose() * y_left;
    squares += y_left.squaredNorm();
    rows += static_cast<double>(y.size() - own.cols());
  }
  double variance(const VectorXd& x) const {
    return std::max(0.0, squares - 2.0 * x.dot(b) + x.dot(N * x)) / std::max(1.0, rows);
  }

  MatrixXd N;
  VectorXd b;
  double squares = 0.0, rows = 0.0;
};

void add_heights(std::span<const HeightSample> window, const GyroIntegral& gyro, Equations& equations) {
  const Timestamp begin = window.front().t, first = std::max(gyro.first(), begin - kForGravity),
                  last = std::min(gyro.last(), window.back().t + kForGravity);
  const auto held = gyro.velocity_change(first, last - Duration(1));
  if (!held || held->norm() == 0.0) return;
  const Vector3d up = held->normalized();
  const auto n = static_cast<Eigen::Index>(window.size());
  MatrixXd climbed(n, 1), own(n, 3);
  VectorXd height(n);
  double speed = 0.0, climb = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const HeightSample& sample = window[static_cast<std::size_t>(i)];
    const double t = to_seconds(sample.t - begin);
    const auto velocity = gyro.velocity_change(begin, sample.t);
    if (!velocity) return;
    const double now = up.dot(*velocity);
    if (i > 0) climb += 0.5 * (speed + now) * (t - own(i - 1, 1));
    speed = now;
    climbed(i, 0) = climb;
    own.row(i) << 1.0, t, t * t;
    height[i] = sample.height_m;
  }
  equations.add(climbed, height, own);
}

/// Unknowns: the columns of v_B over v_S, and the lever arm l: R (M u - omega x l) = v_0 + g t + velocity.
void add_velocities(std::span<const VelocitySample> window, const GyroIntegral& gyro, double noise,
                    Equations& equations) {
  const Timestamp begin = window.front().t;
  const auto n = static_cast<Eigen::Index>(window.size());
  MatrixXd A(3 * n, 12), own(3 * n, 6);
  VectorXd y(3 * n);
  Vector3d measured = Vector3d::Zero();  // number of measurements of each axis
  for (Eigen::Index i = 0; i < n; ++i) {
    const VelocitySample& sample = window[static_cast<std::size_t>(i)];
    const auto attitude = gyro.attitude_at(sample.t);
    const auto velocity = gyro.velocity_change(begin, sample.t);
    const auto turned = gyro.between(sample.t - kForRate, sample.t + kForRate);
    if (!attitude || !velocity || !turned) return;
    const Matrix3d R = attitude->toRotationMatrix();
    const Vector3d omega = *turned / to_seconds(2 * kForRate);
    for (int axis = 0; axis < 3; ++axis) {
      const bool known = std::isfinite(sample.sigma[axis]);
      A.block<3, 3>(3 * i, 3 * axis) = (known ? sample.v_S[axis] : 0.0) * R;
      measured[axis] += known ? 1.0 : 0.0;
    }
    A.block<3, 3>(3 * i, 9) = -R * skew(omega);
    own.block<3, 6>(3 * i, 0) << Matrix3d::Identity(), to_seconds(sample.t - begin) * Matrix3d::Identity();
    y.segment<3>(3 * i) = *velocity;
  }
  equations.add(A, y, own);
  // Noise increases the squares of the columns, so it would bias their length.
  for (int axis = 0; axis < 3; ++axis) {
    if (measured[axis] > 2.0)
      equations.N.diagonal().segment<3>(3 * axis).array() -= noise * noise * (measured[axis] - 2.0);
  }
}

/// The rotation nearest to weighted columns, and its scale.
struct RotationFit {
  Matrix3d R;
  double scale, misfit;  ///< misfit: mean squared residual of a column
};

RotationFit nearest_rotation(const Matrix3d& M, const Vector3d& weight) {
  const Eigen::JacobiSVD<Matrix3d> svd(M * weight.asDiagonal(), Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double handed = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  RotationFit turned;
  turned.R = svd.matrixU() * Vector3d(1.0, 1.0, handed).asDiagonal() * svd.matrixV().transpose();
  turned.scale = M.cwiseProduct(turned.R).colwise().sum().dot(weight) / weight.sum();
  turned.misfit = (M - turned.scale * turned.R).colwise().squaredNorm().dot(weight) / weight.sum();
  return turned;
}

double angle_of(const Matrix3d& R) { return so3::log(Eigen::Quaterniond(R)).norm(); }

/// The axis with the wrong sign, or all axes, if no rotation fits. The signs with the smallest rotation are chosen.
void look_for_mirror(const Matrix3d& M, const Vector3d& weight, RotationFit& best, VelocityAgreement& agreement) {
  constexpr double kBad = 0.1, kFarBetter = 0.2;
  const double without = best.misfit;
  if (without < kBad) return;
  for (const Vector3d& signs : {Vector3d(-1, -1, -1), Vector3d(-1, 1, 1), Vector3d(1, -1, 1), Vector3d(1, 1, -1)}) {
    const RotationFit found = nearest_rotation(M * signs.asDiagonal(), weight);
    if (found.misfit > kFarBetter * without) continue;
    if (agreement.left_handed && angle_of(found.R) >= angle_of(best.R)) continue;
    best = found;
    agreement.left_handed = true;
    agreement.signs = signs;
  }
}

/// Name of the unit whose factor is nearest to the scale; empty if none is near.
std::string unit_of(double scale, bool velocity) {
  constexpr double kNear = 1.15;
  constexpr std::array<std::pair<double, const char*>, 4> lengths{
      {{1e3, "mm"}, {100.0, "cm"}, {3.2808, "ft"}, {1e-3, "km"}}};
  constexpr std::array<std::pair<double, const char*>, 5> velocities{
      {{1e3, "mm/s"}, {100.0, "cm/s"}, {3.2808, "ft/s"}, {3.6, "km/h"}, {1.9438, "kn"}}};
  const std::span<const std::pair<double, const char*>> units =
      velocity ? std::span<const std::pair<double, const char*>>(velocities) : lengths;
  const auto off = [scale](const auto& unit) { return std::abs(std::log(scale / unit.first)); };
  const auto nearest = std::ranges::min_element(units, {}, off);
  return scale > 0.0 && off(*nearest) < std::log(kNear) ? nearest->second : "";
}

std::string unit_remedy(const std::string& unit, const std::string& column, const std::string& otherwise) {
  return unit.empty() ? otherwise : fmt::format("name its unit in the first line of the file: {}[{}]", column, unit);
}

void judge_heights(const HeightAgreement& found, Findings& out) {
  constexpr double kOff = 0.3;
  const double sigma = found.scale_sigma;
  if (found.scale + kSureSigmas * sigma < 0.0)
    out.error("height: its sign contradicts the accelerometer",
              "heights are positive upwards: negate them in the file (a depth is not a height)");
  else if (std::abs(found.scale - 1.0) > std::max(kOff, kSureSigmas * sigma))
    out.warn(
        fmt::format("height: its changes are {:.2g} +- {:.2g} times those of the accelerometer", found.scale, sigma),
        unit_remedy(unit_of(found.scale, false), "height",
                    "check its scale; a frozen or slow filter in the sensor does the same"));
  else
    out.good(fmt::format("height: sign and scale agree with the accelerometer ({:.2f} +- {:.2f})", found.scale, sigma));
}

/// Roll, pitch and yaw [deg] as in velocity.rotation_deg, near multiples of 90 deg rounded to them.
std::string rotation_text(const Matrix3d& R) {
  constexpr double kNear_deg = 12.0;
  std::array<double, 3> angles = {std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)),
                                  std::atan2(R(1, 0), R(0, 0))};
  bool right = true;
  for (double& angle : angles) {
    angle *= kDegreesPerRadian;
    right = right && std::abs(angle - 90.0 * std::round(angle / 90.0)) < kNear_deg;
  }
  for (double& angle : angles) angle = (right ? 90.0 * std::round(angle / 90.0) : std::round(angle)) + 0.0;
  return fmt::format("{:.0f} {:.0f} {:.0f}", angles[0], angles[1], angles[2]);
}

void judge_mirrored(const VelocityAgreement& found, Findings& out) {
  std::string turned;
  const std::array<const char*, 3> columns = {"vx", "vy", "vz"};
  for (int axis = 0; axis < 3; ++axis) {
    if (found.signs[axis] < 0.0)
      turned += (turned.empty() ? "" : ", ") + std::string(columns[static_cast<std::size_t>(axis)]);
  }
  out.error(fmt::format("velocity: the sign of {} contradicts the IMU", turned),
            "negate it in the file: axes are right-handed, and the velocity is that of the body over the ground");
}

void judge_velocities(const VelocityAgreement& found, Findings& out) {
  constexpr double kOff_deg = 20.0, kOff = 0.15;
  const double angle_deg = kDegreesPerRadian * angle_of(found.T_B_S.R()), sigma_deg = kDegreesPerRadian * found.sigma;
  const double ratio = 1.0 / found.scale;  // measured over true velocity
  if (found.left_handed) return judge_mirrored(found, out);
  const bool turned = angle_deg > std::max(kOff_deg, kSureSigmas * sigma_deg);
  const bool scaled = std::abs(found.scale - 1.0) > std::max(kOff, kSureSigmas * found.sigma);
  if (turned)
    out.warn(fmt::format("velocity: its axes are rotated by {:.0f} +- {:.0f} deg relative to those of the IMU",
                         angle_deg, sigma_deg),
             fmt::format("run it with --set velocity.rotation_deg=\"{}\"", rotation_text(found.T_B_S.R())));
  if (scaled)
    out.warn(fmt::format("velocity: {:.2g} times that of the IMU (+- {:.0f} %)", ratio, 100.0 * found.sigma),
             unit_remedy(unit_of(ratio, true), "vx", "scale it in the file, or give it a larger velocity.scale_sigma"));
  if (!turned && !scaled)
    out.good(fmt::format("velocity: axes and scale agree with the IMU (rotated {:.0f} deg, scale {:.2f}, +- {:.2f})",
                         angle_deg, ratio, found.sigma));
}

}  // namespace

std::optional<HeightAgreement> compare_heights(const std::vector<HeightSample>& samples, const GyroIntegral& gyro) {
  if (gyro.empty()) return std::nullopt;
  Equations equations(1);
  for_each_window(samples, [&](const auto& window) { add_heights(window, gyro, equations); });
  const double information = equations.N(0, 0);
  if (!(information > 0.0)) return std::nullopt;
  HeightAgreement found;
  found.scale = equations.b[0] / information;
  found.scale_sigma = kCorrelated * std::sqrt(equations.variance(VectorXd::Constant(1, found.scale)) / information);
  return found.scale_sigma < kKnownHeight * std::max(1.0, std::abs(found.scale)) ? std::optional(found) : std::nullopt;
}

std::optional<VelocityAgreement> compare_velocities(const std::vector<VelocitySample>& samples,
                                                    const GyroIntegral& gyro, double noise) {
  constexpr double kLeastNoise = 0.02;  // [m/s]
  if (gyro.empty()) return std::nullopt;
  Equations equations(12);
  for_each_window(samples, [&](const auto& window) { add_velocities(window, gyro, noise, equations); });
  // The prior determines what the data do not: axes of the IMU, and a sensor close to it.
  const double variance = std::pow(std::max(noise, kLeastNoise), 2);
  Eigen::Matrix<double, 12, 1> expected;
  expected << Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ(), Vector3d::Zero();
  Eigen::Matrix<double, 12, 1> prior = Eigen::Matrix<double, 12, 1>::Constant(variance);
  prior.tail<3>() /= kArmSigma_m * kArmSigma_m;
  const MatrixXd information = equations.N + MatrixXd(prior.asDiagonal());
  const Eigen::LDLT<MatrixXd> solver(information);
  if (!solver.isPositive()) return std::nullopt;
  const VectorXd x = solver.solve(equations.b + prior.cwiseProduct(expected));
  const MatrixXd P =
      kCorrelated * kCorrelated * (variance + equations.variance(x)) * solver.solve(MatrixXd::Identity(12, 12));
  Vector3d weight;
  for (int axis = 0; axis < 3; ++axis) weight[axis] = 3.0 / P.diagonal().segment<3>(3 * axis).sum();
  const double best_sigma = 1.0 / std::sqrt(weight.maxCoeff());
  if (!(best_sigma < kKnown)) return std::nullopt;
  const Matrix3d M = Eigen::Map<const Matrix3d>(x.data());
  VelocityAgreement found;
  found.sigma = best_sigma;
  RotationFit turned = nearest_rotation(M, weight);
  if (1.0 / std::sqrt(weight.minCoeff()) < kKnown) look_for_mirror(M, weight, turned, found);
  found.scale = turned.scale;
  found.T_B_S = SE3(Eigen::Quaterniond(turned.R), x.tail<3>());
  return found;
}

void ExternalCheck::add(const ExternalSample& sample) {
  const auto keep = [&sample]<typename T>(std::vector<T>& kept) {
    if (const T* one = std::get_if<T>(&sample); one && kept.size() < kMostSamples) kept.push_back(*one);
  };
  keep(heights_);
  keep(velocities_);
}

void ExternalCheck::judge(const GyroIntegral& gyro, const ExternalStatisticsByName& statistics,
                          std::vector<Finding>& out) const {
  Findings own;
  if (const auto found = compare_heights(heights_, gyro)) judge_heights(*found, own);
  if (const auto velocity = statistics.find("velocity"); velocity != statistics.end()) {
    const double sigma = velocity->second.sigma, noise = velocity->second.noise;
    const auto found = compare_velocities(velocities_, gyro, sigma > 0.0 ? std::min(sigma, noise) : noise);
    if (found) judge_velocities(*found, own);
  }
  std::ranges::move(own.list, std::back_inserter(out));
}

}  // namespace edged
