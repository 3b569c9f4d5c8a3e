// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/output_frame.hpp"

#include <gtest/gtest.h>

#include "edged/camera/field_of_view.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

Rig rig_with_one_camera() {
  RigCamera camera;
  camera.name = "events";
  camera.modality = Modality::Events;
  camera.T_B_C = SE3(so3::exp({0.1, 0.2, 0.3}), Eigen::Vector3d(0.01, 0.02, 0.03));
  camera.time_offset = Duration(2'400'000);
  return {"test", {camera}};
}

const StampedPose kBody{timestamp_from_seconds(5.0), SE3(so3::exp({-1.0, 0.5, 2.0}), Eigen::Vector3d(1, 2, 3))};

TEST(OutputFrame, OfTheBodyChangesNothing) {
  const StampedPose pose = OutputFrame(rig_with_one_camera(), "body")(kBody);
  EXPECT_EQ(pose.t, kBody.t);
  EXPECT_EQ(pose.T.matrix(), kBody.T.matrix());
}

TEST(OutputFrame, OfACameraGivesItsPoseOnItsOwnClock) {
  const Rig rig = rig_with_one_camera();
  const OutputFrame frame(rig, "events");
  const StampedPose pose = frame(kBody);
  EXPECT_EQ(pose.t + rig.cameras[0].time_offset, kBody.t);
  EXPECT_LT((pose.T.matrix() - kBody.T.matrix() * rig.cameras[0].T_B_C.matrix()).norm(), 1e-14);
  EXPECT_NE(frame.describe().find("'events'"), std::string::npos);
}

TEST(OutputFrame, OfAnUnknownCameraIsRefused) { EXPECT_THROW(OutputFrame(rig_with_one_camera(), "left"), InputError); }

TEST(WithEstimated, GivesAllCamerasBehindALensItsCalibration) {
  const RigCamera events{"events", Modality::Events, CameraModel(240, 180, 200, 200, 120, 90), SE3()};
  RigCamera frames = events, other = events;
  frames.name = "frames", frames.modality = Modality::Frames;
  other.name = "other", other.T_B_C.translation().x() = 0.1;
  const Rig given{"head", {events, frames, other}};
  Rig found;
  found.cameras = {frames};
  found.cameras[0].model = CameraModel(240, 180, 201, 202, 121, 91);
  found.cameras[0].T_B_C.translation().z() = 0.02;
  found.cameras[0].time_offset = std::chrono::milliseconds(3);
  const Rig rig = with_estimated(given, found);
  EXPECT_TRUE(is_same_lens(rig.camera("events"), found.cameras[0]));
  EXPECT_TRUE(is_same_lens(rig.camera("frames"), found.cameras[0]));
  EXPECT_TRUE(is_same_lens(rig.camera("other"), other));
  EXPECT_EQ(rig.camera("events").time_offset, Duration(0));
  EXPECT_EQ(rig.camera("frames").time_offset, std::chrono::milliseconds(3));
  found.cameras = {events};
  found.cameras[0].time_offset = std::chrono::milliseconds(4);
  EXPECT_EQ(with_estimated(given, found).camera("events").time_offset, std::chrono::milliseconds(4));
  EXPECT_EQ(rig_for_poses(given, found).camera("events").time_offset, Duration(0)) << "latency of its pixels";
}

}  // namespace
}  // namespace edged
