// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/options.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "edged/core/check.hpp"

namespace edged {
namespace {

TEST(OdometryConfig, ContradictsItselfInNoDefault) { EXPECT_NO_THROW(OdometryConfig().validate()); }

TEST(OdometryConfig, MostOptionsAreForExpertsAndStandLast) {
  OdometryConfig config;
  const ConfigFields fields = ConfigFields::of(config);
  const auto first_expert = std::ranges::find_if(fields.all(), &ConfigField::expert);
  EXPECT_EQ(first_expert - fields.all().begin(), 50) << "a name in the list that is no option, or one declared again";
  EXPECT_TRUE(std::all_of(first_expert, fields.all().end(),
                          [](const ConfigField& field) { return field.expert && field.key.starts_with("expert."); }));
}

TEST(OdometryConfig, HasAtMost152OptionsAndOneTrackerGroup) {
  OdometryConfig config;
  ConfigFields fields = ConfigFields::of(config);
  EXPECT_LE(fields.all().size(), 152U) << "derive an option from others, or make it a constant";
  fields.set("tracker.detector.max_features=77");
  EXPECT_EQ(config.event_tracker.detector.max_features, 77);
  EXPECT_EQ(config.frame_tracker.detector.max_features, 77);
  fields.set("tracker.events.sigma_px=3");
  EXPECT_EQ(config.event_tracker.sigma_px, 3.0);
  EXPECT_EQ(config.frame_tracker.sigma_px, OdometryConfig().frame_tracker.sigma_px);
}

/// Two keys for an option of the tracker if and only if the defaults differ.
TEST(OdometryConfig, HasTrackerOptionsPerKindWhereDefaultsDiffer) {
  OdometryConfig config;
  const auto texts = [](TrackerConfig& tracker) {
    std::map<std::string, std::string> values;
    const ConfigFields fields = ConfigFields::of(tracker);
    for (const ConfigField& field : fields.all()) values[field.key] = field.get();
    return values;
  };
  const auto events = texts(config.event_tracker), frames = texts(config.frame_tracker);
  const ConfigFields fields = ConfigFields::of(config);
  for (const auto& [key, value] : events) {
    const bool separate = std::ranges::any_of(
        fields.all(), [&key = key](const ConfigField& field) { return field.key.ends_with("tracker.events." + key); });
    EXPECT_EQ(separate, value != frames.at(key)) << key;
  }
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
