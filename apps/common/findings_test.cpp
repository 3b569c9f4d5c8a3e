// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/findings.hpp"

#include <gmock/gmock.h>

namespace edged {
namespace {

using ::testing::HasSubstr;

TEST(SurveyText, TextAndJsonOfACalibrationSayTheSame) {
  const CalibrationFit fit = judge_fit({{"events", 0.2, 7.6, 2.4, false, 0.1, 0.3}}, {}, "");
  EXPECT_THAT(to_text(fit), HasSubstr("events      does not fit: its clock"));
  EXPECT_THAT(to_text(fit), HasSubstr("calibration does not fit: see events\n"));
  const nlohmann::ordered_json json = to_json(fit);
  EXPECT_EQ(json.at("verdict"), "does not fit");
  EXPECT_EQ(json.at("cameras").at(0).at("verdict"), "does not fit");
  EXPECT_EQ(json.at("cameras").at(0).at("time_offset_ms"), 7.6);
}

}  // namespace
}  // namespace edged
