// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Views of a target for the tests of this folder, and derivatives by differences.
#pragma once

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "edged/calibrate/target_view.hpp"
#include "edged/camera/lens_table.hpp"
#include "edged/estimator/factors/blocks.hpp"

namespace edged {

inline constexpr int kTestWidth = 346, kTestHeight = 260;

/// One of every model.
inline std::vector<FreeLens> lenses_of_the_tests() {
  return {{DistortionModel::None, {300, 301, 170, 131}},
          {DistortionModel::RadTan, {250, 251, 174, 126, -0.35, 0.15, 0.001, -0.0005, 0.0}},
          {DistortionModel::Equidistant, {160, 160.5, 171, 128, -0.01, 0.004, -0.002, 0.0005}},
          {DistortionModel::Rational, {260, 260.5, 171, 133, 0.05, -0.02, 0.0005, 0.0002, 0.002, 0.2, 0.01, 0.001}},
          {DistortionModel::FieldOfView, {230, 231, 168, 130, 0.9}},
          {DistortionModel::Omni, {420, 421, 171, 129, 0.9, -0.1, 0.05, 0.0004, 0.0003}},
          {DistortionModel::DoubleSphere, {150, 150.5, 171, 129, -0.2, 0.57}},
          {DistortionModel::ExtendedUnified, {190, 190.5, 173, 132, 0.6, 1.1}}};
}

/// Hand-held views: the target anywhere in the image, tilted up to 45 degrees, nearer and farther. poses: gets T_C_T
/// of each view.
inline TargetViews views_through(const FreeLens& lens, const TargetLayout& layout, int count, double noise_px,
                                 std::uint32_t seed, std::vector<SE3>* poses = nullptr) {
  std::mt19937 generator(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(generator()) / 4294967296.0;
  };
  const auto normal = [&] {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform(0.0, 1.0);
    return sum;
  };
  TargetViews out{.name = "frames", .width = kTestWidth, .height = kTestHeight, .views = {}};
  const double slope = lens_model(lens.distortion).radius_of_angle != nullptr
                           ? lens_model(lens.distortion).radius_of_angle(lens.coefficients(), 0.0).slope
                           : 1.0;
  const double depth = 0.8 * lens.values[0] * slope * layout.width / kTestHeight;
  const Eigen::Vector3d middle(0.5 * layout.width, 0.5 * layout.height, 0.0);
  for (int i = 0; i < count; ++i) {
    // x to the right and y down: the target's y is up, its z towards the camera.
    const Eigen::Quaterniond facing(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
    double tilt[3];
    for (double& a : tilt) a = uniform(-0.75, 0.75);
    const Eigen::Quaterniond R = so3::exp({tilt[0], tilt[1], tilt[2]}) * facing;
    double at[3];
    for (double& a : at) a = uniform(-0.5, 0.5);
    const Eigen::Vector3d p(at[0] * depth, at[1] * depth, depth * (1.0 + 0.6 * at[2]));
    const SE3 T_C_T(R, p - R * middle);
    TargetView view{timestamp_from_seconds(0.1 * i), {}};
    for (std::size_t id = 0; id < layout.corners.size(); ++id) {
      const Eigen::Vector2d& c = layout.corners[id];
      const auto pixel = project_free(lens, T_C_T * Eigen::Vector3d(c.x(), c.y(), 0.0), nullptr, nullptr);
      const double dx = noise_px * normal(), dy = noise_px * normal();
      if (pixel && pixel->x() > 3 && pixel->y() > 3 && pixel->x() < kTestWidth - 4 && pixel->y() < kTestHeight - 4)
        view.corners.push_back({static_cast<int>(id), *pixel + Eigen::Vector2d(dx, dy)});
    }
    ++out.pictures;
    if (view.corners.size() < 12) continue;
    out.views.push_back(std::move(view));
    if (poses) poses->push_back(T_C_T);
  }
  return out;
}

/// How far apart the pixels of two lenses are at most, over directions within the image.
inline double largest_difference_px(const FreeLens& a, const FreeLens& b) {
  double largest = 0.0;
  const CameraModel model = a.model(kTestWidth, kTestHeight);
  for (int x = 10; x < kTestWidth; x += 15)
    for (int y = 10; y < kTestHeight; y += 15) {
      const Eigen::Vector2d pixel(x, y);
      const auto other = project_free(b, model.pixel_to_point(pixel).homogeneous(), nullptr, nullptr);
      largest = std::max(largest, other ? (*other - pixel).norm() : 1e3);
    }
  return largest;
}

/// Derivatives by the tangent of each block against central differences. kinds: of the first blocks, the others are
/// plain; last_size: of the last block so many are tried.
inline void check_cost(const ceres::CostFunction& cost, std::vector<double*> blocks,
                       const std::vector<BlockKind>& kinds, int last_size) {
  const auto& sizes = cost.parameter_block_sizes();
  const int n = cost.num_residuals();
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<RowMajor> J;
  std::vector<double*> J_data;
  for (const int size : sizes) J.emplace_back(RowMajor::Zero(n, size));
  for (RowMajor& j : J) J_data.push_back(j.data());
  Eigen::VectorXd r(n), more(n), less(n);
  ASSERT_TRUE(cost.Evaluate(blocks.data(), r.data(), J_data.data()));
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const bool pose = b < kinds.size() && kinds[b] == BlockKind::Pose;
    const int size = pose ? 6 : b + 1 == blocks.size() ? last_size : sizes[b];
    const std::vector<double> kept(blocks[b], blocks[b] + sizes[b]);
    for (int i = 0; i < size; ++i) {
      const double step = 1e-6 * std::max(1.0, std::abs(kept[static_cast<std::size_t>(pose ? 0 : i)]));
      const auto shifted = [&](double by, Eigen::VectorXd& out) {
        std::copy(kept.begin(), kept.end(), blocks[b]);
        if (pose) {
          Vector6d d = by * Vector6d::Unit(i);
          plus(BlockKind::Pose, blocks[b], d.data());
        } else {
          blocks[b][i] += by;
        }
        ASSERT_TRUE(cost.Evaluate(blocks.data(), out.data(), nullptr));
      };
      shifted(step, more), shifted(-step, less);
      const Eigen::VectorXd numeric = (more - less) / (2.0 * step);
      EXPECT_LT((numeric - J[b].col(i)).norm(), 2e-3 * std::max(1.0, numeric.norm()))
          << "block " << b << " column " << i;
    }
    std::copy(kept.begin(), kept.end(), blocks[b]);
  }
}

}  // namespace edged
