// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/target/target.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "edged/input_error.hpp"
#include "edged/target/print.hpp"

namespace edged {
namespace {

std::string refusal(const TargetSpec& spec) {
  try {
    spec.validate();
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

TEST(Target, AprilGridNumbersItsTagsFromTheLowerLeft) {
  const TargetLayout layout =
      layout_of({.kind = TargetKind::AprilGrid, .rows = 2, .columns = 3, .size_m = 0.1, .ratio = 0.25});
  ASSERT_EQ(layout.tags.size(), 6u);
  EXPECT_NEAR(layout.width, 3 * 0.125 + 0.025, 1e-12);
  EXPECT_NEAR(layout.height, 2 * 0.125 + 0.025, 1e-12);
  EXPECT_TRUE(layout.tags[0].corners[3].isApprox(Eigen::Vector2d(0.025, 0.025)));
  EXPECT_TRUE(layout.tags[5].corners[1].isApprox(Eigen::Vector2d(0.375, 0.25)));
  EXPECT_EQ(layout.corners.size(), 24u);
}

TEST(Target, EveryCornerHasDarkAcross) {
  for (const TargetKind kind : {TargetKind::Checkerboard, TargetKind::AprilGrid, TargetKind::Charuco}) {
    const TargetSpec spec = usual_target(kind);
    const TargetLayout layout = layout_of(spec);
    const auto dark = [&](const Eigen::Vector2d& p) {
      return std::ranges::any_of(layout.dark, [&](const TargetPatch& patch) {
        return (p.array() > patch.low.array()).all() && (p.array() < patch.high.array()).all();
      });
    };
    const double step = 0.02 * spec.size_m;
    for (const Eigen::Vector2d& corner : layout.corners) {
      const bool a = dark(corner + Eigen::Vector2d(step, step)), b = dark(corner + Eigen::Vector2d(-step, step));
      EXPECT_NE(a, b);
      EXPECT_EQ(a, dark(corner - Eigen::Vector2d(step, step)));
      EXPECT_EQ(b, dark(corner - Eigen::Vector2d(-step, step)));
    }
  }
}

TEST(Target, RefusesWhatCannotBeDetectedOrPrinted) {
  EXPECT_NE(refusal({.kind = TargetKind::Checkerboard, .rows = 6, .columns = 8}).find("180 degrees"),
            std::string::npos);
  EXPECT_NE(refusal({.kind = TargetKind::AprilGrid, .rows = 30, .columns = 30}).find("its family has 587"),
            std::string::npos);
  EXPECT_NE(refusal({.size_m = 0.0}).find("above 0"), std::string::npos);
  EXPECT_NE(refusal({.ratio = 1.5}).find("between 0 and 1"), std::string::npos);
  EXPECT_NE(refusal({.rows = 0}).find("1 to 40"), std::string::npos);
}

TEST(Target, PrintsInTrueSize) {
  const TargetSpec spec{.kind = TargetKind::Checkerboard, .rows = 4, .columns = 5, .size_m = 0.02, .ratio = 0.0};
  const std::string svg = target_svg(spec);  // 6 + 2 squares wide
  EXPECT_NE(svg.find("width=\"160.0000mm\""), std::string::npos);
  EXPECT_NE(svg.find("height=\"152.0000mm\""), std::string::npos);
  EXPECT_EQ(std::ranges::count(svg, 'Z'), 15);  // dark squares of 5 x 6
  const std::string pdf = target_pdf(spec);
  EXPECT_NE(pdf.find("/MediaBox [0 0 453.5433 430.8661]"), std::string::npos);
  const std::size_t table = pdf.find("xref\n");
  EXPECT_EQ(std::stoul(pdf.substr(pdf.find("startxref\n") + 10)), table);
  EXPECT_EQ(pdf.substr(std::stoul(pdf.substr(table + 29, 10)), 7), "1 0 obj");
}

}  // namespace
}  // namespace edged
