// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Formats of other programs are written so that they read back the same.
#include <gmock/gmock.h>

#include "edged/camera/lens_table.hpp"
#include "edged/io/calib/calibration_readers.hpp"
#include "edged/io/calibration.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

RigCamera camera_of(DistortionModel model, const LensCoefficients& k) {
  const SE3 T_B_C(so3::exp({0.1, -0.7, 0.3}), Eigen::Vector3d(0.05, -0.02, 0.01));
  return {"frames", Modality::Frames, CameraModel(346, 260, 250, 251, 170, 130, model, k), T_B_C, Duration(2'400'000)};
}

TEST(CalibrationWriters, KalibrsCamchainReadsBackTheSame) {
  Calibration calibration;
  calibration.rig.cameras = {camera_of(DistortionModel::RadTan, {-0.3, 0.1, 0.001, -0.002}),
                             camera_of(DistortionModel::Equidistant, {0.01, 0.002, 0.0, 0.0}),
                             camera_of(DistortionModel::Omni, {0.9, -0.1, 0.05, 0.0004, 0.0003}),
                             camera_of(DistortionModel::DoubleSphere, {-0.2, 0.57}),
                             camera_of(DistortionModel::ExtendedUnified, {0.6, 1.1}),
                             camera_of(DistortionModel::FieldOfView, {0.9}),
                             camera_of(DistortionModel::None, {})};
  for (std::size_t i = 0; i < calibration.rig.cameras.size(); ++i)
    calibration.rig.cameras[i].name = "c" + std::to_string(i);
  calibration.rig.cameras[1].modality = Modality::Events;
  calibration.rig.cameras[1].T_B_C = SE3(so3::exp({0.0, 0.2, 0.0}), Eigen::Vector3d(0.0, 0.1, 0.0));
  const TempFolder folder;
  const auto file = folder.write("camchain.yaml", to_kalibr_yaml(calibration, true));
  const Calibration read = load_calibration(file);
  ASSERT_EQ(read.rig.cameras.size(), calibration.rig.cameras.size());
  for (std::size_t i = 0; i < read.rig.cameras.size(); ++i) {
    const RigCamera &a = calibration.rig.cameras[i], &b = read.rig.cameras[i];
    EXPECT_EQ(a.model, b.model) << i;
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.modality, b.modality);
    EXPECT_LT((a.T_B_C.inverse() * b.T_B_C).log().norm(), 1e-9);
    EXPECT_EQ(a.time_offset, b.time_offset);
  }
}

TEST(CalibrationWriters, OpenCvsIntrinsicsReadBackTheSame) {
  for (const RigCamera& camera : {camera_of(DistortionModel::RadTan, {-0.3, 0.1, 0.001, -0.002, 0.01}),
                                  camera_of(DistortionModel::Rational, {0.2, 0, 0.001, 0.002, 0, 0.4, 0.01, 0}),
                                  camera_of(DistortionModel::Equidistant, {0.01, 0.002, 0.0, 0.0})}) {
    const TempFolder folder;
    const auto file = folder.write("frames.yaml", to_opencv_yaml(camera));
    EXPECT_EQ(load_calibration(file).rig.cameras.at(0).model, camera.model);
  }
}

TEST(CalibrationWriters, ALensThatTheOtherLacksIsRefused) {
  Calibration calibration;
  calibration.rig.cameras = {camera_of(DistortionModel::Rational, {0.2, 0, 0.001, 0.002, 0, 0.4, 0.01, 0})};
  try {
    to_kalibr_yaml(calibration, false);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("camera frames: Kalibr has no lens 'rational'; choose another --lens"));
  }
  try {
    to_opencv_yaml(camera_of(DistortionModel::DoubleSphere, {-0.2, 0.57}));
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("camera frames: OpenCV has no lens 'ds'"));
  }
}

}  // namespace
}  // namespace edged
