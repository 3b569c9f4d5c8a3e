// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/intrinsics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "edged/camera/lens_table.hpp"
#include "edged/camera/undistort.hpp"
#include "edged/core/angles.hpp"

namespace edged {
namespace {

std::vector<CameraModel> corrected_cameras() {
  return {CameraModel(240, 180, 200, 190, 119.5, 91.0),
          CameraModel(240, 180, 199.1, 198.8, 132.2, 110.7, DistortionModel::RadTan, {-0.37, 0.15, -3e-4, -7e-4, 0.0}),
          CameraModel(640, 480, 400, 410, 320, 240, DistortionModel::RadTan, {-0.28, 0.07, 2e-4, 2e-5, 0.01}),
          CameraModel(346, 260, 172.9, 173.1, 163.3, 134.9, DistortionModel::Equidistant,
                      {-0.027, -0.006, -0.003, 0.0002, 0.0})};
}

TEST(Intrinsics, DerivativeOfDistortionByItsCoefficientsMatchesDifferences) {
  for (const CameraModel& camera : corrected_cameras()) {
    const LensModel& lens = lens_model(camera.distortion());
    if (lens.model == DistortionModel::None) continue;
    for (const Eigen::Vector2d& point : {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.3, -0.2)}) {
      const ByCoefficients by = lens.by_coefficients(camera.coefficients(), point);
      for (std::size_t i = 0; i < lens.max_coefficients; ++i) {
        constexpr double kStep = 1e-5;
        LensCoefficients more = camera.coefficients(), less = more;
        more[i] += kStep, less[i] -= kStep;
        const auto pixel = [&](const LensCoefficients& k) {
          return CameraModel(240, 180, 400, 400, 119.5, 89.5, lens.model, k).distort_to_pixel(point);
        };
        const Eigen::Vector2d numeric = (pixel(more) - pixel(less)) / (2.0 * kStep * 400.0);
        EXPECT_LT((by.col(static_cast<int>(i)) - numeric).norm(), 1e-8) << lens.name << " " << i;
      }
    }
  }
}

TEST(Intrinsics, DerivativeOfAPointByCorrectionsMatchesDifferences) {
  for (const CameraModel& camera : corrected_cameras()) {
    for (const Eigen::Vector2d& pixel :
         {Eigen::Vector2d(5, 7), Eigen::Vector2d(100, 60), Eigen::Vector2d(235, 170), Eigen::Vector2d(210, 9)}) {
      const ByIntrinsics by = point_by_intrinsics(camera, camera, camera.pixel_to_point(pixel));
      const int known = kCoefficientsAt + corrected_coefficients(camera);
      for (int i = 0; i < known; ++i) {
        const IntrinsicsCorrection step = 1e-5 * IntrinsicsCorrection::Unit(i);
        const Eigen::Vector2d numeric = (corrected_model(camera, step)->pixel_to_point(pixel) -
                                         corrected_model(camera, -step)->pixel_to_point(pixel)) /
                                        2e-5;
        EXPECT_LT((by.col(i) - numeric).norm(), 1e-6 * (1.0 + numeric.norm())) << i;
      }
    }
  }
}

TEST(Intrinsics, DerivativeAtACorrectedModelMatchesDifferences) {
  const IntrinsicsCorrection off(0.01, -0.01, 0.01, -0.01, 0.022, -0.015);
  for (const CameraModel& camera : corrected_cameras()) {
    const Eigen::Vector2d pixel(200, 150);
    const CameraModel model = *corrected_model(camera, off);
    const ByIntrinsics by = point_by_intrinsics(camera, model, model.pixel_to_point(pixel));
    for (int i = 0; i < kCoefficientsAt + corrected_coefficients(camera); ++i) {
      const IntrinsicsCorrection step = 1e-5 * IntrinsicsCorrection::Unit(i);
      const Eigen::Vector2d numeric = (corrected_model(camera, off + step)->pixel_to_point(pixel) -
                                       corrected_model(camera, off - step)->pixel_to_point(pixel)) /
                                      2e-5;
      EXPECT_LT((by.col(i) - numeric).norm(), 1e-6 * (1.0 + numeric.norm())) << i;
    }
  }
}

TEST(Intrinsics, PointsOfCorrectedModelsAreThoseOfTheirDerivativeToFirstOrder) {
  const IntrinsicsCorrection off(1e-3, -1e-3, 1e-3, -1e-3, 2e-3, -1e-3);
  for (const CameraModel& camera : corrected_cameras()) {
    const CameraModel corrected = *corrected_model(camera, off);
    for (const Eigen::Vector2d& pixel :
         {Eigen::Vector2d(20, 20), Eigen::Vector2d(100, 60), Eigen::Vector2d(200, 150)}) {
      const Eigen::Vector2d given = camera.pixel_to_point(pixel);
      const Eigen::Vector2d first_order = given + point_by_intrinsics(camera, camera, given) * off;
      EXPECT_LT((first_order - corrected.pixel_to_point(pixel)).norm(), 0.1 / camera.fx());
    }
  }
}

TEST(Intrinsics, PointsByACorrectedModelAreThoseOfTheirPixels) {
  const IntrinsicsCorrection off(0.01, -0.01, 0.01, -0.01, 0.022, -0.015);
  for (const CameraModel& camera : corrected_cameras()) {
    const CameraModel model = *corrected_model(camera, off);
    for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(20, 20), Eigen::Vector2d(100, 60), Eigen::Vector2d(235, 170)})
      EXPECT_LT((point_by(model, camera, camera.pixel_to_point(pixel)) - model.pixel_to_point(pixel)).norm(), 1e-6);
  }
}

TEST(Intrinsics, TheModelOfAnUndistortedImageFollowsItsLens) {
  const IntrinsicsCorrection off(0.01, -0.01, 0.01, -0.01, 0.022, -0.015);
  for (const CameraModel& camera : corrected_cameras()) {
    const CameraModel ideal = ideal_pinhole(camera), image = *corrected_image_model(ideal, camera, off),
                      lens = *corrected_model(camera, off);
    for (const Eigen::Vector2d& pixel :
         {Eigen::Vector2d(20, 20), Eigen::Vector2d(100, 60), Eigen::Vector2d(200, 150)}) {
      const Eigen::Vector2d truth = lens.pixel_to_point(camera.distort_to_pixel(ideal.pixel_to_point(pixel)));
      EXPECT_LT((image.pixel_to_point(pixel) - truth).norm(), 1.0 / camera.fx());
    }
  }
}

TEST(Intrinsics, CorrectedModelKeepsMaskAndViewLimit) {
  const CameraModel camera = corrected_cameras()[3].within(40.0 * kDegree);
  std::vector<std::uint8_t> used(346 * 260, 1);
  used[5] = 0;
  const CameraModel corrected = *corrected_model(camera.masked(used), IntrinsicsCorrection::Constant(1e-3));
  EXPECT_NEAR(*corrected.view_limit(), 40.0 * kDegree, 1e-12);
  EXPECT_FALSE(corrected.uses(5, 0));
  EXPECT_TRUE(corrected.uses(6, 0));
}

TEST(Intrinsics, ACorrectionThatNoLensHasIsNotApplied) {
  const CameraModel camera = corrected_cameras()[1];
  IntrinsicsCorrection off = IntrinsicsCorrection::Zero();
  off[kCoefficientsAt] = -1.5;  // turns back within the image
  EXPECT_FALSE(corrected_model(camera, off));
  EXPECT_EQ(corrected_model(camera, IntrinsicsCorrection::Zero()), camera);
}

}  // namespace
}  // namespace edged
