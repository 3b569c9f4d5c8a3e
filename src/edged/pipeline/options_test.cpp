// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/options.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "edged/core/check.hpp"

namespace edged {
namespace {

TEST(OdometryConfig, ContradictsItselfInNoDefault) { EXPECT_NO_THROW(OdometryConfig().validate()); }

TEST(OdometryConfig, MostOptionsAreForExpertsAndStandLast) {
  OdometryConfig config;
  const ConfigFields fields = ConfigFields::of(config);
  const auto first_expert = std::ranges::find_if(fields.all(), &ConfigField::expert);
  EXPECT_EQ(first_expert - fields.all().begin(), 42) << "a name in the list that is no option, or one declared anew";
  EXPECT_TRUE(std::all_of(first_expert, fields.all().end(),
                          [](const ConfigField& field) { return field.expert && field.key.starts_with("expert."); }));
}

TEST(OdometryConfig, RefusesAnEnhancementThatNothingUses) {
  OdometryConfig config;
  ConfigFields fields = ConfigFields::of(config);
  fields.set("enhance.method=sobel");
  EXPECT_NO_THROW(config.validate());
  fields.set("enhance.detect=false");
  EXPECT_THROW(config.validate(), InputError);
  fields.set("enhance.track=true");
  EXPECT_NO_THROW(config.validate());
}

TEST(OdometryConfig, NamesTheKeyOfAContradictionInsideAPart) {
  OdometryConfig config;
  config.enhance.method = EdgeMethod::Canny;
  config.enhance.erosion_px = 3;
  try {
    config.validate();
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("expert.enhance.erosion_px with enhance.method"), std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace edged
