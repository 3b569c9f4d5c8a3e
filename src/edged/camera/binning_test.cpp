// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/binning.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace edged {
namespace {

TEST(Binning, APixelLooksWhereItsFourDid) {
  const CameraModel fine(641, 480, 530.0, 532.0, 356.0, 304.0, DistortionModel::RadTan, {-0.3, 0.1, 1e-4, -2e-4});
  const CameraModel coarse = binned(fine, 2);
  EXPECT_EQ(coarse.width(), 320) << "the last column does not fill one";
  EXPECT_EQ(coarse.height(), 240);
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(0, 0), Eigen::Vector2d(160, 120), Eigen::Vector2d(319, 239)}) {
    const Eigen::Vector2d middle = 2.0 * pixel + Eigen::Vector2d(0.5, 0.5);
    EXPECT_NEAR((coarse.pixel_to_point(pixel) - fine.pixel_to_point(middle)).norm(), 0.0, 1e-9);
  }
  EXPECT_EQ(binned(fine, 1), fine);
}

TEST(Binning, AMaskedPixelMasksAll) {
  std::vector<std::uint8_t> used(64 * 48, 1);
  used[10 * 64 + 21] = 0;
  const CameraModel coarse = binned(CameraModel(64, 48, 50.0, 50.0, 31.5, 23.5).masked(used), 4);
  EXPECT_FALSE(coarse.uses(5, 2));
  EXPECT_TRUE(coarse.uses(4, 2));
  EXPECT_TRUE(coarse.uses(5, 3));
}

TEST(Binning, ByPowersOfTwoUntilItIsNarrowEnough) {
  EXPECT_EQ(bin_for(346, 400), 1);
  EXPECT_EQ(bin_for(640, 400), 2);
  EXPECT_EQ(bin_for(1280, 400), 4);
  EXPECT_EQ(bin_for(1280, 640), 2);
}

}  // namespace
}  // namespace edged
