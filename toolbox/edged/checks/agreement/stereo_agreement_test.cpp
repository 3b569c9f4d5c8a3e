// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/agreement/stereo_agreement.hpp"

#include <gtest/gtest.h>

#include "edged/frontend/test_scene.hpp"

namespace edged {
namespace {

/// What is said of a second of two cameras 11 cm apart, whose images have these names.
std::vector<std::string> exchanged(const std::string& left, const std::string& right) {
  const PlaneScene scene(davis_like_pinhole(), 2.0);
  const SE3 T_W_right(so3::exp(Eigen::Vector3d(0.01, -0.015, 0.02)), Eigen::Vector3d(0.11, 0.004, -0.01));
  const std::vector<RigCamera> cameras{{"left", Modality::Frames, scene.camera(), SE3()},
                                       {"right", Modality::Frames, scene.camera(), T_W_right}};
  StereoAgreement stereo(cameras);
  for (const int second : {1, 2}) {
    const Timestamp t = timestamp_from_seconds(second);
    const Frame of_left{t, left, scene.image(SE3())}, of_right{t, right, scene.image(T_W_right)};
    stereo.add(left == "left" ? of_left : of_right);
    stereo.add(left == "left" ? of_right : of_left);
  }
  return stereo.exchanged();
}

TEST(StereoAgreement, NamesCamerasThatAreExchanged) {
  EXPECT_EQ(exchanged("right", "left"), std::vector<std::string>{"left and right"});
}

TEST(StereoAgreement, SaysNothingOfTwoCamerasAsCalibrated) { EXPECT_TRUE(exchanged("left", "right").empty()); }

}  // namespace
}  // namespace edged
