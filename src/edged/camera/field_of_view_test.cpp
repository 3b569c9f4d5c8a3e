// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/field_of_view.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "edged/core/angles.hpp"

namespace edged {
namespace {

TEST(FieldOfView, OfAPinholeFollowsFromItsFocalLength) {
  const FieldOfView view = field_of_view({201, 101, 100, 50, 100, 50});
  EXPECT_NEAR(view.horizontal, 90 * kDegree, 1e-12);
  EXPECT_NEAR(view.vertical, 90 * kDegree, 1e-12);
  EXPECT_NEAR(view.diagonal, 2 * std::atan(std::sqrt(2.0)), 1e-12);
}

TEST(FieldOfView, OfAnIdealFisheyeIsProportionalToTheRadius) {
  const FieldOfView view = field_of_view({201, 201, 100, 100, 100, 100, DistortionModel::Equidistant});
  EXPECT_NEAR(view.horizontal, 2.0, 1e-9);
  EXPECT_NEAR(view.diagonal, 2.0 * std::sqrt(2.0), 1e-9);
}

TEST(FieldOfView, OfALensThatSeesBehindItselfIsMoreThanHalfTheSphere) {
  const FieldOfView view = field_of_view({257, 257, 90, 90, 128, 128, DistortionModel::Equidistant});
  EXPECT_NEAR(view.horizontal, 2.0 * 128 / 90, 1e-9);
  EXPECT_NEAR(view.diagonal, 2.0 * std::sqrt(2.0) * 128 / 90, 1e-9);
}

TEST(FieldOfView, BarrelDistortionWidensIt) {
  const FieldOfView plain = field_of_view({240, 180, 200, 200, 120, 90});
  const FieldOfView barrel = field_of_view({240, 180, 200, 200, 120, 90, DistortionModel::RadTan, {-0.38, 0.19}});
  EXPECT_GT(barrel.horizontal, plain.horizontal);
  EXPECT_GT(barrel.diagonal, plain.diagonal);
}

TEST(SharedView, OfCamerasBesideEachOtherIsWhatTheBaselineLeaves) {
  const CameraModel lens(200, 200, 100, 100, 99.5, 99.5);
  const RigCamera left{"left", Modality::Frames, lens, SE3()};
  const RigCamera right{"right", Modality::Frames, lens, SE3(Eigen::Quaterniond::Identity(), {0.1, 0, 0})};
  EXPECT_NEAR(shared_view(left, left, 3.0), 1.0, 1e-12);
  EXPECT_NEAR(shared_view(left, right, 3.0), 0.95, 0.051);
  EXPECT_LT(shared_view(left, right, 0.1), 0.65);
}

TEST(SharedView, OfCamerasInOppositeDirectionsIsNothing) {
  const CameraModel lens(200, 200, 100, 100, 99.5, 99.5);
  const RigCamera front{"front", Modality::Frames, lens, SE3()};
  const RigCamera rear{"rear", Modality::Frames, lens, SE3(Eigen::Quaterniond(0, 0, 1, 0), Eigen::Vector3d::Zero())};
  EXPECT_EQ(shared_view(front, rear, 3.0), 0.0);
}

}  // namespace
}  // namespace edged
