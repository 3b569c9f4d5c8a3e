// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/detector.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <set>

#include "edged/frontend/test_scene.hpp"

namespace edged {
namespace {

using Pixels = std::vector<Eigen::Vector2d>;

// A white square on black has its corners where they can be counted.
cv::Mat squares(const std::vector<cv::Point>& top_left) {
  cv::Mat image(180, 240, CV_8UC1, cv::Scalar(30));
  for (const cv::Point& p : top_left) cv::rectangle(image, cv::Rect(p, cv::Size(12, 12)), cv::Scalar(200), cv::FILLED);
  return image;
}

int cell_of(const Eigen::Vector2d& p) { return static_cast<int>(p.y() / 20) * 12 + static_cast<int>(p.x() / 20); }

class Detector : public testing::TestWithParam<CornerKind> {
 protected:
  Detector() { config_.corners = GetParam(); }
  DetectorConfig config_;
};

INSTANTIATE_TEST_SUITE_P(EveryKind, Detector,
                         testing::Values(CornerKind::FastHarris, CornerKind::Fast, CornerKind::ShiTomasi),
                         [](const auto& kind) {
                           return kind.param == CornerKind::FastHarris ? "FastHarris"
                                  : kind.param == CornerKind::Fast     ? "Fast"
                                                                       : "ShiTomasi";
                         });

TEST_P(Detector, FindsTheCornersOfASquare) {
  const cv::Mat image = squares({{94, 74}});  // its corners lie in four cells
  const auto corners = detect_corners(image, {}, 100, config_);
  ASSERT_EQ(corners.size(), 4U);
  // FAST's own score is the same at all pixels around a perfect corner.
  const double tolerance = GetParam() == CornerKind::Fast ? 2.1 : 1.6;
  for (const Corner& c : corners) {
    EXPECT_NEAR(std::abs(c.pixel.x() - 99.5), 5.5, tolerance);
    EXPECT_NEAR(std::abs(c.pixel.y() - 79.5), 5.5, tolerance);
  }
}

TEST_P(Detector, GivesOneCornerPerCellStrongestFirstAndApart) {
  const auto corners = detect_corners(random_texture(240, 180), {}, 1000, config_);
  EXPECT_GT(corners.size(), 70U);
  EXPECT_LE(corners.size(), 108U);
  std::set<int> cells;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    EXPECT_TRUE(cells.insert(cell_of(corners[i].pixel)).second);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE(corners[j].response, corners[i].response);
      EXPECT_GT((corners[i].pixel - corners[j].pixel).norm(), config_.separation_px);
    }
  }
}

TEST_P(Detector, LeavesCellsAndNeighbourhoodsOfLiveTracksAlone) {
  const cv::Mat image = random_texture(240, 180);
  Pixels occupied;
  for (int y = 10; y < 180; y += 20) {
    for (int x = 10; x < 120; x += 20) occupied.emplace_back(x, y);  // the left half
  }
  occupied.emplace_back(121.0, 90.0);
  const auto corners = detect_corners(image, occupied, 1000, config_);
  EXPECT_GT(corners.size(), 30U);
  for (const Corner& c : corners) {
    EXPECT_GE(c.pixel.x(), 120.0);
    for (const auto& p : occupied) EXPECT_GT((c.pixel - p).norm(), config_.separation_px - 1.0);
  }
  EXPECT_TRUE(
      detect_corners(squares({{94, 74}}), Pixels{{90, 70}, {110, 70}, {90, 90}, {110, 90}}, 100, config_).empty());
}

TEST_P(Detector, KeepsTheStrongestOverTheWholeGridUnderALimit) {
  const cv::Mat image = random_texture(240, 180);
  const auto all = detect_corners(image, {}, 1000, config_);
  const auto few = detect_corners(image, {}, 10, config_);
  ASSERT_EQ(few.size(), 10U);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i].pixel, all[i].pixel);
  EXPECT_TRUE(detect_corners(image, {}, 0, config_).empty());
  EXPECT_TRUE(detect_corners(image, {}, -3, config_).empty());
}

TEST_P(Detector, StaysOffTheBorder) {
  config_.border_px = 25;
  for (const Corner& c : detect_corners(random_texture(240, 180), {}, 1000, config_)) {
    EXPECT_GE(c.pixel.minCoeff(), 25.0);
    EXPECT_LT(c.pixel.x(), 215.0);
    EXPECT_LT(c.pixel.y(), 155.0);
  }
}

TEST_P(Detector, MeetsTheSameRulesOnSeveralScales) {
  config_.levels = 4;
  const auto corners = detect_corners(random_texture(240, 180), {}, 1000, config_);
  EXPECT_GT(corners.size(), 70U);
  std::set<int> cells;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    EXPECT_TRUE(cells.insert(cell_of(corners[i].pixel)).second);
    for (std::size_t j = 0; j < i; ++j) EXPECT_GT((corners[i].pixel - corners[j].pixel).norm(), config_.separation_px);
  }
  EXPECT_NO_THROW(detect_corners(random_texture(14, 12), {}, 100, config_));
}

TEST(DetectorLevels, FindBlurredCornersNearTheirPlace) {
  cv::Mat image = squares({{94, 74}});
  cv::GaussianBlur(image, image, cv::Size(), 3.0);
  DetectorConfig config;
  config.fast_threshold = config.fast_threshold_low = 40;
  EXPECT_TRUE(detect_corners(image, {}, 100, config).empty());  // too smooth for a circle of 3 px
  config.levels = 6;
  const auto corners = detect_corners(image, {}, 100, config);
  EXPECT_GE(corners.size(), 2U);
  for (const Corner& c : corners) EXPECT_LT((c.pixel - Eigen::Vector2d(99.5, 79.5)).cwiseAbs().maxCoeff(), 9.0);
}

TEST_P(Detector, ScalesTheGridWithTheWidth) {
  const auto corners = detect_corners(random_texture(752, 480), {}, 1000, config_);
  EXPECT_GT(corners.size(), 60U);
  EXPECT_LE(corners.size(), 96U);  // 12 x 8 cells
}

TEST_P(Detector, FindsNothingInFlatEmptyOrTinyImages) {
  EXPECT_TRUE(detect_corners(cv::Mat(), {}, 100, config_).empty());
  EXPECT_TRUE(detect_corners(cv::Mat(180, 240, CV_8UC1, cv::Scalar(128)), {}, 100, config_).empty());
  EXPECT_TRUE(detect_corners(random_texture(240, 12), {}, 100, config_).empty());
  EXPECT_TRUE(detect_corners(random_texture(3, 3), {}, 100, config_).empty());
  EXPECT_NO_THROW(detect_corners(random_texture(20, 20), {}, 100, config_));
}

TEST_P(Detector, MovesToTheSaddlePointWhenAsked) {
  // A square whose corners lie at half pixels, blurred.
  cv::Mat large(720, 960, CV_8UC1, cv::Scalar(30)), image;
  cv::rectangle(large, cv::Rect(382, 302, 80, 80), cv::Scalar(200), cv::FILLED);
  cv::GaussianBlur(large, large, cv::Size(), 4.0);
  cv::resize(large, image, cv::Size(240, 180), 0, 0, cv::INTER_AREA);
  config_.subpixel = true;
  const auto corners = detect_corners(image, {}, 100, config_);
  ASSERT_EQ(corners.size(), 4U);
  for (const Corner& c : corners) {
    EXPECT_NEAR(std::abs(c.pixel.x() - 105.0), 10.0, 0.3);
    EXPECT_NEAR(std::abs(c.pixel.y() - 85.0), 10.0, 0.3);
  }
}

TEST(FastHarrisDetector, LowersTheThresholdOnlyWhereACellStaysEmpty) {
  cv::Mat image = squares({{94, 74}});
  cv::rectangle(image, cv::Rect(154, 74, 12, 12), cv::Scalar(45),
                cv::FILLED);  // 15 grey levels: too faint for the first try
  DetectorConfig config;
  EXPECT_EQ(detect_corners(image, {}, 100, config).size(), 8U);
  config.fast_threshold_low = config.fast_threshold;
  EXPECT_EQ(detect_corners(image, {}, 100, config).size(), 4U);
}

TEST(DetectorConfig, HasDocumentedFieldsThatBindToTheStruct) {
  DetectorConfig config;
  ConfigFields fields = ConfigFields::of(config);
  fields.set("corners=shi_tomasi");
  fields.set("cell_px=30");
  EXPECT_EQ(config.corners, CornerKind::ShiTomasi);
  EXPECT_EQ(config.cell_px, 30.0);
  for (const ConfigField& field : fields.all()) EXPECT_FALSE(field.effect.empty()) << field.key;
}

}  // namespace
}  // namespace edged
