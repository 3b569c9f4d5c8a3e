// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/mode.hpp"

#include <gtest/gtest.h>

#include "edged/core/check.hpp"
#include "edged/core/dataset.hpp"

namespace edged {
namespace {

DatasetInfo recording_with(bool events, bool frames, bool imu) {
  DatasetInfo info;
  info.has_events = events, info.has_frames = frames, info.has_imu = imu;
  return info;
}

TEST(ModeChoice, TakesAllThatTheRecordingHolds) {
  EXPECT_EQ(choose_mode("auto", recording_with(true, true, true)), Mode::Fused);
  EXPECT_EQ(choose_mode("auto", recording_with(true, false, true)), Mode::Events);
  EXPECT_EQ(choose_mode("auto", recording_with(false, true, true)), Mode::Frames);
  EXPECT_EQ(choose_mode("events", recording_with(true, true, true)), Mode::Events);
}

TEST(ModeChoice, RefusesWhatTheRecordingLacksAndNamesThatThereAreNot) {
  EXPECT_THROW(choose_mode("auto", recording_with(true, true, false)), InputError);
  EXPECT_THROW(choose_mode("fused", recording_with(true, false, true)), InputError);
  EXPECT_THROW(choose_mode("events", recording_with(false, true, true)), InputError);
  EXPECT_THROW(choose_mode("sonar", recording_with(true, true, true)), InputError);
}

TEST(ModeChoice, NamesReadBack) {
  for (const Mode mode : {Mode::Events, Mode::Frames, Mode::Fused}) EXPECT_EQ(parse_mode(mode_name(mode)), mode);
}

}  // namespace
}  // namespace edged
