// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/calibrate/coverage.hpp"

#include <gtest/gtest.h>

#include "edged/calibrate/test_views.hpp"

namespace edged {
namespace {

struct Judged {
  ViewCoverage coverage;
  MissingViews missing;
};

Judged judged(const TargetViews& camera, const TargetLayout& layout) {
  const LensFit fit = fit_lens(camera, layout, DistortionModel::None);
  const ViewCoverage coverage = coverage_of(camera, fit, layout);
  return {coverage, missing_views(camera, fit, coverage)};
}

TEST(Coverage, IsCompleteWithViewsAllOver) {
  const TargetLayout layout = layout_of(usual_target(TargetKind::AprilGrid));
  const Judged all = judged(views_through(lenses_of_the_tests()[0], layout, 60, 0.05, 3), layout);
  EXPECT_GT(all.coverage.cells.share(), 0.95);
  EXPECT_TRUE(all.missing.needed.empty());
  EXPECT_TRUE(all.missing.advised.empty());
}

TEST(Coverage, NamesThePartsOfTheImageWithoutCorners) {
  const TargetLayout layout = layout_of(usual_target(TargetKind::AprilGrid));
  TargetViews camera = views_through(lenses_of_the_tests()[0], layout, 80, 0.05, 3);
  camera.name = "cam1";
  for (TargetView& view : camera.views)
    std::erase_if(view.corners, [](const TargetCorner& c) { return c.pixel.x() > 0.35 * kTestWidth; });
  const MissingViews missing = judged(camera, layout).missing;
  ASSERT_FALSE(missing.needed.empty());
  EXPECT_NE(missing.needed[0].find("camera cam1: corners of the target in 3"), std::string::npos) << missing.needed[0];
  EXPECT_NE(missing.needed[0].find("upper right"), std::string::npos) << missing.needed[0];
}

TEST(Coverage, NamesNoPartOnceMostOfItsCellsHaveCorners) {
  CornerCells cells;
  EXPECT_EQ(cells.empty_parts(), "upper left, top, upper right, left, middle, right, lower left, bottom, lower right");
  TargetView left;
  for (int y = 0; y < 60; y += 5)
    for (int x = 0; x < 50; x += 5) left.corners.push_back({0, {x, y}});
  cells.add(left, 80, 60);
  EXPECT_EQ(cells.share(), 0.625);
  EXPECT_EQ(cells.empty_parts(), "upper right, right, lower right");
}

}  // namespace
}  // namespace edged
