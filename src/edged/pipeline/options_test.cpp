// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/options.hpp"

#include <gtest/gtest.h>

#include <string>

#include "edged/core/check.hpp"

namespace edged {
namespace {

TEST(OdometryConfig, ContradictsItselfInNoDefault) { EXPECT_NO_THROW(OdometryConfig().validate()); }

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
    EXPECT_NE(std::string(e.what()).find("enhance.erosion_px"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace edged
