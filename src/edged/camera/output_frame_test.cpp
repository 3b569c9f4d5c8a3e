// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/output_frame.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace edged
