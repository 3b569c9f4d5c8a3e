// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/core/camera_names.hpp"

#include <gmock/gmock.h>

#include "edged/core/check.hpp"

namespace edged {
namespace {

using testing::AllOf;
using testing::HasSubstr;

RigCamera named(const std::string& name, Modality modality) {
  return {name, modality, CameraModel(240, 180, 200, 200, 120, 90, DistortionModel::None, {}), SE3(), Duration(0)};
}

DatasetInfo recording() {
  DatasetInfo info;
  info.name = "flight.bag";
  info.has_events = info.has_frames = info.has_imu = true;
  return info;
}

std::string refusal(Rig rig, Modality modality) {
  try {
    match_camera(rig, recording(), modality);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(MatchCamera, KeepsWhatIsCalledAsInTheRecording) {
  Rig rig{"head", {named("events", Modality::Events), named("frames", Modality::Frames)}};
  EXPECT_EQ(match_camera(rig, recording(), Modality::Events), "");
  EXPECT_EQ(match_camera(rig, recording(), Modality::Frames), "");
  EXPECT_EQ(rig.cameras[0].name, "events");
}

TEST(MatchCamera, TakesTheOnlyOneOfAKindAndSaysSo) {
  Rig rig{"chain", {named("cam0", Modality::Frames), named("cam1", Modality::Events)}};
  EXPECT_THAT(match_camera(rig, recording(), Modality::Events), AllOf(HasSubstr("'cam1'"), HasSubstr("'events'")));
  EXPECT_THAT(match_camera(rig, recording(), Modality::Frames), AllOf(HasSubstr("'cam0'"), HasSubstr("'frames'")));
  EXPECT_EQ(rig.find(Modality::Events)->name, "events");
  EXPECT_EQ(rig.find(Modality::Frames)->name, "frames");
}

TEST(MatchCamera, PutsTheOneOfTheRecordingBeforeOthersOfItsKind) {
  Rig rig{"stereo", {named("right", Modality::Events), named("events", Modality::Events)}};
  EXPECT_EQ(match_camera(rig, recording(), Modality::Events), "");
  EXPECT_EQ(rig.find(Modality::Events)->name, "events");
  EXPECT_EQ(rig.cameras[1].name, "right");
}

TEST(MatchCamera, RefusesToGuessWithBothLists) {
  const Rig two{"chain", {named("cam0", Modality::Frames), named("cam1", Modality::Frames)}};
  EXPECT_THAT(refusal(two, Modality::Frames), AllOf(HasSubstr("events (events), frames (frames)"),
                                                    HasSubstr("cam0 (frames), cam1 (frames)"), HasSubstr("several")));
  EXPECT_THAT(refusal(two, Modality::Events), AllOf(HasSubstr("none is of events"), HasSubstr("--mode frames")));
  const Rig other{"chain", {named("frames", Modality::Events), named("cam1", Modality::Frames)}};
  EXPECT_THAT(refusal(other, Modality::Frames), HasSubstr("'frames' is not of frames"));
}

}  // namespace
}  // namespace edged
