// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/pictures.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace edged {
namespace {

TEST(ContactSheet, HoldsEveryImageOfEveryRow) {
  const cv::Mat grey(180, 240, CV_8UC1, cv::Scalar(77)), wide(100, 800, CV_8UC1, cv::Scalar(78));
  const cv::Mat sheet = draw_contact_sheet({"title"}, {{{"a", grey}, {"none", {}}, {"b", wide}}, {{"c", grey}}});
  ASSERT_EQ(sheet.type(), CV_8UC3);
  cv::Mat found;
  cv::inRange(sheet, cv::Scalar::all(77), cv::Scalar::all(77), found);
  EXPECT_EQ(cv::countNonZero(found), 2 * 400 * 300);
  cv::inRange(sheet, cv::Scalar::all(78), cv::Scalar::all(78), found);
  EXPECT_EQ(cv::countNonZero(found), 400 * 50);
}

TEST(ContactSheet, IsDrawnWithoutAnyImage) { EXPECT_FALSE(draw_contact_sheet({}, {}).empty()); }

}  // namespace
}  // namespace edged
