// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/mode.hpp"

#include <gtest/gtest.h>

#include "edged/core/check.hpp"
#include "edged/dataset.hpp"

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

Rig stereo_of_both() {
  Rig rig{"pairs", {}};
  for (const char* name : {"cam0", "dvs0", "cam1", "dvs1"}) {
    const bool events = name[0] == 'd';
    rig.cameras.push_back({name, events ? Modality::Events : Modality::Frames, CameraModel(), SE3()});
  }
  return rig;
}

std::string used(Mode mode, const std::string& wanted) {
  std::string names;
  for (const RigCamera& camera : used_cameras(stereo_of_both(), mode, wanted).cameras) names += camera.name + " ";
  return names;
}

TEST(UsedCameras, AreTheFirstOfEachKindUnlessNamed) {
  EXPECT_EQ(used(Mode::Fused, ""), "dvs0 cam0 ");
  EXPECT_EQ(used(Mode::Frames, ""), "cam0 ");
  EXPECT_EQ(used(Mode::Fused, "first"), "dvs0 cam0 ");
  EXPECT_EQ(used(Mode::Fused, "cam1, cam0,dvs1"), "dvs1 cam0 cam1 ");
  EXPECT_EQ(used(Mode::Events, "cam1,dvs1,dvs0"), "dvs0 dvs1 ");
}

TEST(UsedCameras, AreRefusedWithTheNamesThereAre) {
  for (const char* wrong : {"cam0,dvs2", "cam0,dvs0,cam0", "cam0,cam1", "cam0,,dvs0", ","}) {
    try {
      used(Mode::Fused, wrong);
      ADD_FAILURE() << wrong << " was accepted";
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("cam0 (frames), dvs0 (events), cam1 (frames), dvs1 (events)"),
                std::string::npos)
          << e.what();
    }
  }
  EXPECT_THROW(used_cameras({"blind", {}}, Mode::Events), InputError);
}

}  // namespace
}  // namespace edged
