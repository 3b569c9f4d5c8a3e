// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Camchains of Kalibr: chains of cameras, a second IMU, models, modality of cameras.
#include "edged/io/calib/calib_test_support.hpp"

namespace edged {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Kalibr : public CalibrationFiles {};

constexpr const char* kChain = R"(cam0:
  T_cam_imu: [[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, -0.1], [0, 0, 0, 1]]
  camera_model: pinhole
  distortion_coeffs: [-0.05, 0.01, 0.0, 0.0]
  distortion_model: equidistant
  intrinsics: [226.0, 226.0, 173.0, 133.0]
  resolution: [346, 260]
  rostopic: /davis/left/image_raw
cam1:
  T_cn_cnm1: [[1, 0, 0, -0.2], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
  camera_model: pinhole
  distortion_model: none
  intrinsics: [226.0, 226.0, 173.0, 133.0]
  resolution: [346, 260]
  rostopic: /davis/right/image_raw
)";

TEST_F(Kalibr, AKalibrChainLeadsFromCameraToCamera) {
  const Calibration c = load(kChain);
  EXPECT_THAT(names_and_kinds(c),
              ElementsAre("events:events", "frames:frames", "cam1_events:events", "cam1_frames:frames"));
  EXPECT_TRUE((c.rig.cameras[0].T_B_C * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d(1.1, 0, 0)));
  // 20 cm to the right in the image (camera x) is 20 cm to the right of the body (-y).
  EXPECT_TRUE(c.rig.cameras[2].T_B_C.translation().isApprox(Eigen::Vector3d(0.1, -0.2, 0)));
  const std::string both =
      std::string(kChain) + "  T_cam_imu: [[0, -1, 0, -0.2], [0, 0, -1, 0], [1, 0, 0, -0.1], [0, 0, 0, 1]]\n";
  EXPECT_TRUE(load(both).warnings.empty());
  EXPECT_THAT(load(replaced(both, "-0.2], [0, 1", "-0.3], [0, 1")).warnings, ElementsAre(HasSubstr("by 0.1 m")));
}

TEST_F(Kalibr, ADavisThatWasCalibratedTwiceIsTwoCameras) {
  const auto found = [&](const std::vector<std::string>& topics, int width = 346, int height = 260) {
    return names_and_kinds(load(kalibr_chain(topics, width, height)));
  };
  const auto four = ElementsAre("cam0:events", "cam1:frames", "cam2:events", "cam3:frames");
  EXPECT_THAT(found({"/davis/left/events", "/davis/left/image_raw", "/davis/right/events", "/davis/right/image_raw"}),
              four);
  EXPECT_THAT(found({"/dvs_left/events", "/dvs_left/image_raw", "/dvs_right/events", "/dvs_right/image_raw"}), four);
  EXPECT_THAT(found({"/davis/events", "/davis2/image_raw"}),
              ElementsAre("events:events", "frames:frames", "cam1_events:events", "cam1_frames:frames"));
  EXPECT_THAT(found({"/dvs/events", "/dvs/image_raw"}, 640, 480), ElementsAre("cam0:events", "cam1:events"))
      << "rendered from events";
}

TEST_F(Kalibr, ASecondImuOfKalibrTakesItsPlaceAndClockIntoAccount) {
  const auto imu = folder_.write("imu1.yaml", R"(imu0:
  accelerometer_noise_density: 0.01
  accelerometer_random_walk: 0.0002
  gyroscope_noise_density: 0.0005
  gyroscope_random_walk: 4.0e-06
  T_i_b: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.5], [0, 0, 0, 1]]
  time_offset: 0.001
)");
  const Calibration c = load(kChain, {.imu_file = imu});
  EXPECT_TRUE(c.rig.cameras[0].T_B_C.translation().isApprox(Eigen::Vector3d(0.1, 0, 0.5)));
  EXPECT_EQ(c.rig.cameras[0].time_offset, Duration(-1'000'000));
}

TEST_F(Kalibr, MatricesOfAnImuThatAreNotAppliedAreToldOf) {
  const std::string noise =
      "imu0:\n  accelerometer_noise_density: 0.01\n  accelerometer_random_walk: 0.0002\n"
      "  gyroscope_noise_density: 0.0005\n  gyroscope_random_walk: 4.0e-06\n";
  const auto warnings = [&](const std::string& matrices) {
    return load(kChain, {.imu_file = folder_.write("imu.yaml", noise + matrices)}).warnings;
  };
  const std::string none = "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n", scaled = "[[1.04, 0, 0], [0, 1, 0], [0, 0, 1]]\n";
  EXPECT_TRUE(warnings("  Ta: " + none + "  Tg: [[0, 0, 0], [0, 0, 0], [0, 0, 0]]\n").empty());
  EXPECT_THAT(warnings("  Ta: " + scaled + "  Tw: " + none), ElementsAre(HasSubstr("Ta: is not applied")));
  EXPECT_THAT(warnings("  accelerometers:\n    M: " + scaled), ElementsAre(HasSubstr("accelerometers.M: is not")));
}

/// The chain with the second camera of this model; distortion: its lines, without the indentation of the first.
std::string with_model(const std::string& model, const std::string& intrinsics, const std::string& distortion) {
  const std::string text = replaced(kChain, "camera_model: pinhole\n  distortion_model: none",
                                    "camera_model: " + model + "\n  " + distortion);
  return replaced(text, "[226.0, 226.0, 173.0, 133.0]\n  resolution: [346, 260]\n  rostopic: /davis/right",
                  "[" + intrinsics + "]\n  resolution: [346, 260]\n  rostopic: /davis/right");
}

TEST_F(Kalibr, CameraModelsHaveTheirCoefficientsBeforeTheFocalLengths) {
  const std::string radtan = "distortion_model: radtan\n  distortion_coeffs: [0.1, 0.2, 0.003, 0.004]";
  const auto second = [&](const std::string& text) { return load(text).rig.cameras.back().model; };
  EXPECT_EQ(second(with_model("omni", "1.2, 500, 501, 173, 133", radtan)),
            CameraModel(346, 260, 500, 501, 173, 133, DistortionModel::Omni, {1.2, 0.1, 0.2, 0.003, 0.004}));
  EXPECT_EQ(second(with_model("omni", "1.2, 500, 501, 173, 133", "distortion_model: none")),
            CameraModel(346, 260, 500, 501, 173, 133, DistortionModel::Omni, {1.2}));
  EXPECT_EQ(second(with_model("ds", "-0.2, 0.6, 226, 227, 173, 133", "distortion_model: none")),
            CameraModel(346, 260, 226, 227, 173, 133, DistortionModel::DoubleSphere, {-0.2, 0.6}));
  EXPECT_EQ(
      second(with_model("eucm", "0.6, 1.1, 226, 227, 173, 133", "distortion_model: none\n  distortion_coeffs: []")),
      CameraModel(346, 260, 226, 227, 173, 133, DistortionModel::ExtendedUnified, {0.6, 1.1}));
  EXPECT_EQ(second(with_model("pinhole", "226, 227, 173, 133", "distortion_model: fov\n  distortion_coeffs: [0.9]")),
            CameraModel(346, 260, 226, 227, 173, 133, DistortionModel::FieldOfView, {0.9}));
  EXPECT_THAT(complaint(with_model("ds", "-0.2, 0.6, 226, 227, 173, 133", radtan)),
              HasSubstr("camera model ds with distortion radtan is not supported; with none it is"));
  EXPECT_EQ(second(with_model("omni", "1.2, 500, 501, 173, 133",
                              "distortion_model: equidistant\n  distortion_coeffs: [0.05, 0, 0, 0]")),
            CameraModel(346, 260, 500, 501, 173, 133, DistortionModel::OmniEquidistant, {1.2, 0.05}));
  EXPECT_THAT(
      complaint(with_model("omni", "1.2, 500, 501, 173, 133", "distortion_model: fov\n  distortion_coeffs: [0.9]")),
      HasSubstr("with radtan (k1 k2 p1 p2), equidistant and none it is"));
}

TEST_F(Kalibr, ModelsWithoutSupportAreRefusedByName) {
  for (const char* model : {"omni", "ds", "eucm"})
    EXPECT_THAT(complaint(replaced(kChain, "camera_model: pinhole", std::string("camera_model: ") + model)),
                HasSubstr(std::string("numbers for camera model ") + model));
  for (const char* model : {"cahvor", "radtan"})
    EXPECT_THAT(complaint(replaced(kChain, "camera_model: pinhole", std::string("camera_model: ") + model)),
                HasSubstr(std::string("camera model ") + model + " is not supported; these are: omni, ds, eucm, and "));
  EXPECT_THAT(complaint(replaced(kChain, "distortion_model: equidistant", "distortion_model: fov9")),
              HasSubstr("fov9"));
  EXPECT_THAT(complaint(replaced(kChain, "distortion_model: equidistant", "distortion_model: fov")), HasSubstr("fov"));
}

TEST_F(Kalibr, WhatACameraSeesIsAskedForWhereNothingTells) {
  const std::string mute =
      replaced(replaced(kChain, "  rostopic: /davis/left/image_raw\n", ""), "  rostopic: /davis/right/image_raw\n", "");
  EXPECT_THAT(complaint(mute), HasSubstr("camera cam0: its names do not show"));
  EXPECT_THAT(complaint(mute, {.sees = {{"cam7", Sees::Events}}}), HasSubstr("has no camera cam7; it has: cam0, cam1"));
  EXPECT_THAT(names_and_kinds(load(mute, {.sees = {{"cam0", Sees::Events}, {"cam1", Sees::Both}}})),
              ElementsAre("cam0:events", "events:events", "frames:frames"));
}

}  // namespace
}  // namespace edged
