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

}  // namespace
}  // namespace edged
