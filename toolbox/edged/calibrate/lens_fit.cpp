// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/calibrate/lens_fit.hpp"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <opencv2/calib3d.hpp>
#include <span>

#include "edged/calibrate/reprojection.hpp"
#include "edged/calibrate/solve_silently.hpp"
#include "edged/camera/lens_table.hpp"
#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"
#include "edged/estimator/factors/blocks.hpp"

namespace edged {
namespace {

constexpr std::size_t kFewestCorners = 8;  // of a view
constexpr std::size_t kFewestViews = 8;
constexpr std::size_t kTrialViews = 12;
constexpr double kRoughSigma_px = 2.0, kLeastSigma_px = 0.005;
constexpr double kWorstFit_px = 2.0;  // a lens that fits worse is none
constexpr double kFarOff = 5.6;       // tangent of 80 degrees: points further out tell nothing of a pose

/// A view with its pose, which the optimization changes.
struct PosedView {
  std::size_t index;
  std::vector<CornerPair> corners;
  PoseBlock T_C_T;
};

double cost_of(const FreeLens& lens, const SE3& T_C_T, const std::vector<CornerPair>& corners, double sigma_px) {
  double sum = 0.0;
  for (const CornerPair& corner : corners) {
    const auto pixel = project_free(lens, T_C_T * corner.p_T, nullptr, nullptr);
    sum += pixel ? std::log1p((*pixel - corner.pixel).squaredNorm() / (sigma_px * sigma_px)) : 20.0;
  }
  return sum / static_cast<double>(corners.size());
}

/// The pose of a plane by its homography to the unit plane, the better of the two that explain it.
std::optional<SE3> plane_pose(const CameraModel& model, const std::vector<CornerPair>& corners) {
  std::vector<cv::Point3d> plane;
  std::vector<cv::Point2d> points;
  for (const CornerPair& corner : corners) {
    const Eigen::Vector2d point = model.pixel_to_point(corner.pixel);
    if (!point.allFinite() || point.norm() > kFarOff) continue;
    plane.emplace_back(corner.p_T.x(), corner.p_T.y(), 0.0);
    points.emplace_back(point.x(), point.y());
  }
  if (points.size() < 6) return std::nullopt;
  cv::Vec3d turn, shift;
  try {
    if (!cv::solvePnP(plane, points, cv::Matx33d::eye(), cv::noArray(), turn, shift, false, cv::SOLVEPNP_IPPE))
      return std::nullopt;
  } catch (const cv::Exception&) {  // corners on a line
    return std::nullopt;
  }
  const SE3 T(so3::exp({turn[0], turn[1], turn[2]}), {shift[0], shift[1], shift[2]});
  if (!T.translation().allFinite() || !(T.translation().z() > 0.0)) return std::nullopt;
  return T;
}

/// Gauss-Newton steps on the robust cost of one view.
SE3 refined_pose(const FreeLens& lens, const SE3& start, const std::vector<CornerPair>& corners, double sigma_px) {
  const PlainReprojection cost(corners, lens.distortion, sigma_px);
  PoseBlock pose = to_block(start);
  Eigen::VectorXd r(cost.num_residuals());
  Eigen::Matrix<double, Eigen::Dynamic, 7, Eigen::RowMajor> J(cost.num_residuals(), 7);
  double damping = 1e-6, best = std::numeric_limits<double>::infinity();
  PoseBlock kept = pose;
  for (int step = 0; step < 20; ++step) {
    const double* blocks[] = {pose.data(), lens.values.data()};
    double* jacobians[] = {J.data(), nullptr};
    cost.Evaluate(blocks, r.data(), jacobians);
    const bool better = r.squaredNorm() < best;
    damping = better ? 0.2 * damping : 20.0 * damping;
    if (better) {
      if (best - r.squaredNorm() < 1e-9 * best) return pose_of(pose.data());
      best = r.squaredNorm(), kept = pose;
    } else if (damping > 1e6) {
      break;
    } else {
      cost.Evaluate((blocks[0] = kept.data(), blocks), r.data(), jacobians);
    }
    Matrix6d H = J.leftCols<6>().transpose() * J.leftCols<6>();
    H.diagonal() *= 1.0 + damping;
    const Vector6d d = -H.ldlt().solve(J.leftCols<6>().transpose() * r);
    if (!d.allFinite()) break;
    pose = kept;
    plus(BlockKind::Pose, pose.data(), d.data());
  }
  return pose_of(kept.data());
}

std::optional<CameraModel> checked_model(const FreeLens& lens, int width, int height) {
  try {
    return lens.model(width, height);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::optional<SE3> pose_with(const FreeLens& lens, const CameraModel& model, const std::vector<CornerPair>& corners,
                             double sigma_px) {
  const std::optional<SE3> start = plane_pose(model, corners);
  if (!start) return std::nullopt;
  return refined_pose(lens, *start, corners, sigma_px);
}

/// The views with their poses in front of this lens, and what is left over, over all.
struct Trial {
  FreeLens lens;
  std::vector<PosedView> views;
  double cost = std::numeric_limits<double>::infinity();
};

Trial posed(const FreeLens& lens, const TargetViews& camera, const TargetLayout& layout,
            std::span<const std::size_t> indices, double sigma_px) {
  Trial out{lens, {}};
  const auto model = checked_model(lens, camera.width, camera.height);
  if (!model) return out;
  double sum = 0.0;
  for (const std::size_t index : indices) {
    std::vector<CornerPair> corners = pairs_of(camera.views[index], layout);
    const std::optional<SE3> T = pose_with(lens, *model, corners, sigma_px);
    sum += T ? cost_of(lens, *T, corners, sigma_px) : 20.0;
    if (T) out.views.push_back({index, std::move(corners), to_block(*T)});
  }
  if (out.views.size() * 2 > indices.size()) out.cost = sum / static_cast<double>(indices.size());
  return out;
}

/// Which parameters of the lens are free: few first, all in the end. Most: up to the fourth coefficient, as a few views
/// do not determine eight.
enum class Free { Focal, Shape, Most, All };
constexpr int kMostOfStart = 8;

void optimize(Trial& trial, Free free, double sigma_px, int most_steps) {
  ceres::Problem::Options ownership;
  ownership.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  PoseBlockManifold pose_manifold;
  std::vector<int> fixed;
  const int last = free == Free::Focal ? 2
                   : free == Free::All ? trial.lens.count()
                                       : std::min(kMostOfStart, trial.lens.count());
  for (int i = 0; i < kLensParameters; ++i)
    if (i >= last || (free == Free::Shape && (i == 2 || i == 3))) fixed.push_back(i);
  ceres::SubsetManifold lens_manifold(kLensParameters, fixed);
  ceres::Problem problem(ownership);
  double* lens = trial.lens.values.data();
  problem.AddParameterBlock(lens, kLensParameters, fixed.empty() ? nullptr : &lens_manifold);
  problem.SetParameterLowerBound(lens, 0, 1.0);
  problem.SetParameterLowerBound(lens, 1, 1.0);
  for (PosedView& view : trial.views) {
    problem.AddParameterBlock(view.T_C_T.data(), 7, &pose_manifold);
    problem.AddResidualBlock(new PlainReprojection(view.corners, trial.lens.distortion, sigma_px), nullptr,
                             view.T_C_T.data(), lens);
  }
  solve_silently(problem, ceres::DENSE_SCHUR, most_steps, 1e-9);
  trial.cost = 0.0;
  for (const PosedView& view : trial.views)
    trial.cost += cost_of(trial.lens, pose_of(view.T_C_T.data()), view.corners, sigma_px);
  trial.cost /= static_cast<double>(trial.views.size());
}

std::vector<double> residuals_of(const Trial& trial) {
  std::vector<double> out;
  for (const PosedView& view : trial.views)
    for (const CornerPair& corner : view.corners)
      if (const auto pixel = project_free(trial.lens, pose_of(view.T_C_T.data()) * corner.p_T, nullptr, nullptr)) {
        out.push_back(pixel->x() - corner.pixel.x());
        out.push_back(pixel->y() - corner.pixel.y());
      }
  return out;
}

double rms_of(const std::vector<double>& residuals) {
  double squares = 0.0;
  for (const double r : residuals) squares += r * r;
  return std::sqrt(2.0 * squares / std::max<double>(1.0, static_cast<double>(residuals.size())));
}

double sigma_of(const Trial& trial) { return std::max(kLeastSigma_px, robust_deviation(residuals_of(trial), 0.0)); }

/// Keeps the result unless it is no lens: a few views without corners at the border of the image leave the distortion
/// there open.
bool improve(Trial& trial, Free free, const TargetViews& camera, double sigma_px) {
  Trial next = trial;
  optimize(next, free, sigma_px, 60);
  if (!checked_model(next.lens, camera.width, camera.height)) return false;
  trial = std::move(next);
  return true;
}

/// Coefficients to start from, where nothing is known of a lens; a model with distortion starts without.
std::vector<LensCoefficients> shapes(DistortionModel distortion) {
  switch (distortion) {
    case DistortionModel::FieldOfView:
      return {{0.3}, {0.9}};
    case DistortionModel::Omni:
      return {{0.1}, {1.0}};
    case DistortionModel::DoubleSphere:
      return {{0.0, 0.3}, {0.0, 0.6}};
    case DistortionModel::ExtendedUnified:
      return {{0.3, 1.0}, {0.6, 1.0}};
    default:
      return {{}};
  }
}

/// Focal lengths from a quarter to three times the width, each with shapes that the model may have.
std::vector<FreeLens> lenses_to_try(DistortionModel distortion, int width, int height) {
  std::vector<FreeLens> out;
  const LensModel& model = lens_model(distortion);
  for (const LensCoefficients& k : shapes(distortion)) {
    const double slope = model.radius_of_angle != nullptr ? model.radius_of_angle(k, 0.0).slope : 1.0;
    for (double share = 0.25; share < 3.0; share *= 1.35) {
      const double focal = share * width / slope;
      FreeLens lens{distortion, {focal, focal, 0.5 * (width - 1), 0.5 * (height - 1)}};
      std::ranges::copy(k, lens.values.begin() + 4);
      out.push_back(lens);
    }
  }
  return out;
}

/// The first that fits best, from focal lengths and shapes that are tried.
Trial best_start(const TargetViews& camera, const TargetLayout& layout, DistortionModel distortion,
                 std::span<const std::size_t> indices) {
  std::vector<Trial> trials;
  for (const FreeLens& lens : lenses_to_try(distortion, camera.width, camera.height))
    trials.push_back(posed(lens, camera, layout, indices, kRoughSigma_px));
  std::ranges::stable_sort(trials, {}, &Trial::cost);
  trials.resize(std::min<std::size_t>(trials.size(), 4));
  for (Trial& trial : trials) {
    if (!std::isfinite(trial.cost)) continue;
    improve(trial, Free::Focal, camera, kRoughSigma_px) && improve(trial, Free::Shape, camera, kRoughSigma_px) &&
        improve(trial, Free::Most, camera, kRoughSigma_px);
  }
  return *std::ranges::min_element(trials, {}, &Trial::cost);
}

/// Information on the lens, with the poses of the views unknown as well: the Schur complement of the normal equations.
LensParameters sigmas_of(const Trial& trial, double sigma_px) {
  const int n = trial.lens.count();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (const PosedView& view : trial.views) {
    const PlainReprojection cost(view.corners, trial.lens.distortion, sigma_px);
    Eigen::VectorXd r(cost.num_residuals());
    Eigen::Matrix<double, Eigen::Dynamic, 7, Eigen::RowMajor> by_pose(cost.num_residuals(), 7);
    Eigen::Matrix<double, Eigen::Dynamic, kLensParameters, Eigen::RowMajor> by_lens(cost.num_residuals(),
                                                                                    kLensParameters);
    const double* blocks[] = {view.T_C_T.data(), trial.lens.values.data()};
    double* jacobians[] = {by_pose.data(), by_lens.data()};
    cost.Evaluate(blocks, r.data(), jacobians);
    const Eigen::MatrixXd A = by_lens.leftCols(n), P = by_pose.leftCols<6>();
    const Eigen::MatrixXd PA = P.transpose() * A;
    information += A.transpose() * A - PA.transpose() * (P.transpose() * P).ldlt().solve(PA);
  }
  LensParameters out{};
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd covariance =
      scale.asDiagonal() * (scale.asDiagonal() * information * scale.asDiagonal()).inverse() * scale.asDiagonal();
  for (int i = 0; i < n; ++i) out.at(static_cast<std::size_t>(i)) = std::sqrt(std::max(0.0, covariance(i, i)));
  return out;
}

std::vector<std::size_t> usable_views(const TargetViews& camera) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < camera.views.size(); ++i)
    if (camera.views[i].corners.size() >= kFewestCorners) out.push_back(i);
  if (out.size() < kFewestViews)
    throw InputError::format(
        "camera {}: the target is in {} of {} pictures with {} corners or more, {} are needed; check --target and its "
        "rows and columns, the light and the focus, and keep it in view",
        camera.name, out.size(), camera.pictures, kFewestCorners, kFewestViews);
  return out;
}

}  // namespace

LensFit fit_lens(const TargetViews& camera, const TargetLayout& layout, DistortionModel distortion,
                 std::size_t most_views) {
  const std::vector<std::size_t> usable = usable_views(camera);
  Trial start = best_start(camera, layout, distortion, evenly(usable, kTrialViews));
  const auto refuse = [&camera](double off_px) {
    return InputError::format(
        "camera {}: no lens of this model explains the views (off by {:.1f} px); choose another --lens, check rows, "
        "columns and --ratio, and tilt the target",
        camera.name, off_px);
  };
  if (!std::isfinite(start.cost) || sigma_of(start) > kWorstFit_px)
    throw refuse(std::isfinite(start.cost) ? sigma_of(start) : 99.0);
  Trial all = posed(start.lens, camera, layout, evenly(usable, most_views), kRoughSigma_px);
  if (all.views.size() < kFewestViews) throw refuse(99.0);
  improve(all, Free::Shape, camera, kRoughSigma_px) && improve(all, Free::Most, camera, kRoughSigma_px);
  for (int round = 0; round < 2; ++round)
    if (!improve(all, Free::All, camera, sigma_of(all)))
      throw InputError::format(
          "camera {}: the views do not determine the distortion near the border of the image; bring the target to all "
          "corners "
          "of the image, or choose a --lens with fewer coefficients",
          camera.name);
  LensFit out{all.lens, sigma_of(all), rms_of(residuals_of(all)), {}, {}};
  if (out.sigma_px > kWorstFit_px) throw refuse(out.sigma_px);
  out.sigmas = sigmas_of(all, out.sigma_px);
  const CameraModel model = all.lens.model(camera.width, camera.height);
  out.T_C_T.resize(camera.views.size());
  for (const std::size_t index : usable)
    out.T_C_T[index] = pose_with(all.lens, model, pairs_of(camera.views[index], layout), 3.0 * out.sigma_px);
  return out;
}

LensFit fit_best_lens(const TargetViews& camera, const TargetLayout& layout) {
  constexpr double kBetter = 0.8;
  std::optional<LensFit> best;
  std::optional<InputError> refused;
  for (const DistortionModel distortion : {DistortionModel::RadTan, DistortionModel::Equidistant}) {
    try {
      LensFit fit = fit_lens(camera, layout, distortion);
      if (!best || fit.rms_px < kBetter * best->rms_px) best = std::move(fit);
    } catch (const InputError& e) {
      if (!refused) refused = e;
    }
  }
  if (!best) throw *refused;
  return *best;
}

}  // namespace edged
