// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/core/camera_names.hpp"

#include <gmock/gmock.h>

namespace edged {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

RigCamera camera_at(const std::string& name, Modality modality, const SE3& T_B_C) {
  return {name, modality, CameraModel(200, 200, 100, 100, 99.5, 99.5), T_B_C};
}

/// Two event cameras and a frame camera beside each other, and a frame camera that looks back.
Rig rig_with_a_rear_camera() {
  const SE3 beside(Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0});
  const SE3 back(Eigen::Quaterniond(0.0, 0.0, 1.0, 0.0), Eigen::Vector3d::Zero());
  return {"four",
          {camera_at("left", Modality::Events, SE3()), camera_at("right", Modality::Events, beside),
           camera_at("front", Modality::Frames, SE3()), camera_at("rear", Modality::Frames, back)}};
}

DatasetInfo recording_of(const std::string& events, const std::string& frames, std::vector<RecordedCamera> more) {
  DatasetInfo info;
  info.has_events = !events.empty();
  info.has_frames = !frames.empty();
  info.event_camera = events;
  info.frame_camera = frames;
  info.more_cameras = std::move(more);
  return info;
}

TEST(StereoCameras, AreThoseOfAKindWhoseViewsOverlap) {
  const DatasetInfo all = recording_of("left", "front", {{"right", Modality::Events}, {"rear", Modality::Frames}});
  EXPECT_THAT(stereo_cameras(rig_with_a_rear_camera(), all), ElementsAre("left", "right", "front"));
}

TEST(StereoCameras, AreNoneWhereNoViewsOverlapOrTheRecordingLacksTheSecond) {
  const Rig rig = rig_with_a_rear_camera();
  EXPECT_THAT(stereo_cameras(rig, recording_of("left", "front", {{"rear", Modality::Frames}})), IsEmpty());
  EXPECT_THAT(stereo_cameras(rig, recording_of("left", "front", {})), IsEmpty());
}

TEST(StereoCameras, AreOnlyCamerasOfTheRig) {
  const DatasetInfo two = recording_of("", "front", {{"frames2", Modality::Frames}});
  EXPECT_THAT(stereo_cameras(rig_with_a_rear_camera(), two), IsEmpty());
}

}  // namespace
}  // namespace edged
