// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Calibration formats, the directions of their transforms, and refusals.
#include "edged/io/calibration.hpp"

#include "edged/io/calib/calib_test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

constexpr const char* kOwn = R"(edged_rig: 1
name: own
imu:
  gyro_noise: 5e-4
  accel_noise: 1e-2
cameras:
  - name: events
    modality: events
    resolution: [240, 180]
    intrinsics: [200, 201, 120, 90]
    distortion: radtan
    coefficients: [-0.1, 0.01, 0, 0]
    T_B_C:
      - [0, 0, 1, 0.1]
      - [-1, 0, 0, 0.2]
      - [0, -1, 0, 0.3]
      - [0, 0, 0, 1]
    time_offset: 0.0024
  - name: frames
    modality: frames
    same_as: events
)";

// A camera 10 cm in front of the IMU (along x of the body), with its axis along x: T_B_C has t = (0.1, 0, 0), its
// inverse t = (0, 0, -0.1).
constexpr const char* kKalibr = R"(cam0:
  T_cam_imu:
  - [0.0, -1.0, 0.0, 0.0]
  - [0.0, 0.0, -1.0, 0.0]
  - [1.0, 0.0, 0.0, -0.1]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: []
  camera_model: pinhole
  distortion_coeffs: [-0.05, 0.01, 0.0, 0.0]
  distortion_model: equidistant
  intrinsics: [226.0, 226.0, 173.0, 133.0]
  resolution: [346, 260]
  rostopic: /camera/left/image_mono
  timeshift_cam_imu: -0.0031
)";

constexpr const char* kImu = R"(accelerometer_noise_density: 0.01
accelerometer_random_walk: 0.0002
gyroscope_noise_density: 0.0005
gyroscope_random_walk: 4.0e-06
rostopic: /imu
update_rate: 1000.0
)";

TEST(Calibration, OwnYamlIsReadAndSharesALens) {
  TempFolder folder;
  const Calibration c = load_calibration(folder.write("own.yaml", kOwn));
  ASSERT_EQ(c.rig.cameras.size(), 2u);
  const RigCamera& frames = c.rig.camera("frames");
  EXPECT_EQ(frames.modality, Modality::Frames);
  EXPECT_EQ(frames.model, c.rig.camera("events").model);
  EXPECT_EQ(frames.time_offset, Duration(2'400'000));
  EXPECT_TRUE((frames.T_B_C * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d(1.1, 0.2, 0.3)));
  EXPECT_DOUBLE_EQ(c.imu.gyro_noise, 5e-4);
}

TEST(Calibration, OwnYamlTakesEitherDirection) {
  TempFolder folder;
  const SE3 forward = load_calibration(folder.write("a.yaml", kOwn)).rig.cameras[0].T_B_C;
  const SE3 inverse = load_calibration(folder.write("b.yaml", replaced(kOwn, "T_B_C", "T_C_B"))).rig.cameras[0].T_B_C;
  EXPECT_TRUE((forward * inverse).matrix().isIdentity(1e-12));
}

TEST(Calibration, KalibrTransformIsTheInverseOfOurs) {
  TempFolder folder;
  const auto file = folder.write("camchain-imucam.yaml", kKalibr);
  const Calibration c = load_calibration(file, {.imu_file = folder.write("imu.yaml", kImu)});
  const RigCamera& camera = c.rig.camera("cam0");
  EXPECT_TRUE(camera.T_B_C.translation().isApprox(Eigen::Vector3d(0.1, 0, 0)));
  EXPECT_TRUE((camera.T_B_C * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d(1.1, 0, 0)));
  EXPECT_EQ(camera.time_offset, Duration(-3'100'000));
  EXPECT_EQ(camera.model.distortion(), DistortionModel::Equidistant);
  EXPECT_DOUBLE_EQ(c.imu.accel_walk, 2e-4);
  EXPECT_TRUE(c.has_imu_noise);
  EXPECT_TRUE(load_calibration(folder.path()).has_imu_noise);  // the folder holds both files
  EXPECT_FALSE(load_calibration(file).has_imu_noise);
}

TEST(Calibration, KalibrOfADavisGivesBothCameras) {
  TempFolder folder;
  const Calibration c = load_calibration(folder.write("k.yaml", std::string(kKalibr) + "  modality: both\n"));
  EXPECT_EQ(c.rig.camera("events").model, c.rig.camera("frames").model);
  EXPECT_EQ(c.rig.camera("events").modality, Modality::Events);
}

TEST(Calibration, EurocTransformIsOurs) {
  const auto mav0 = data_folder() / "euroc_mh01" / "mav0";
  if (!std::filesystem::exists(mav0)) GTEST_SKIP() << "no data";
  const Calibration c = load_calibration(mav0);
  const RigCamera& camera = c.rig.camera("cam0");
  EXPECT_TRUE(
      camera.T_B_C.translation().isApprox(Eigen::Vector3d(-0.0216401454975, -0.064676986768, 0.00981073058949)));
  EXPECT_EQ(camera.model.width(), 752);
  EXPECT_DOUBLE_EQ(c.imu.gyro_noise, 1.6968e-4);
  EXPECT_DOUBLE_EQ(c.imu.accel_walk, 3e-3);
  EXPECT_EQ(load_calibration(mav0 / "cam0" / "sensor.yaml").rig.name, "euroc_mh01");
  EXPECT_EQ(load_calibration(mav0.parent_path()).rig.cameras.size(), 1u);
}

TEST(Calibration, CalibTxtHasIntrinsicsOnly) {
  TempFolder folder;
  const Calibration nine =
      load_calibration(folder.write("calib.txt", "199 198 132 110 -0.368 0.15 -0.0003 -0.00076 0.0\n"));
  EXPECT_FALSE(nine.has_extrinsics);
  EXPECT_EQ(nine.rig.camera("events").model.width(), 240);
  EXPECT_EQ(nine.rig.camera("frames").model.distortion(), DistortionModel::RadTan);
  const Calibration four = load_calibration(folder.write("calib.txt", "200\n200\n120\n90\n"));
  EXPECT_EQ(four.rig.camera("events").model.distortion(), DistortionModel::None);
  folder.write("images.txt", "0.0 images/a.png\n");
  folder.write_image("images/a.png", 346, 260);
  EXPECT_EQ(load_calibration(folder.path() / "calib.txt").rig.camera("events").model.width(), 346);
  EXPECT_THAT(input_error([&] { load_calibration(folder.write("calib.txt", "1 2 3")); }), HasSubstr("has 3 numbers"));
}

TEST(Calibration, TheDavisRigMatchesItsSources) {
  const Calibration c = load_rig("davis240c_ecd");
  const RigCamera& camera = c.rig.camera("events");
  EXPECT_NEAR(camera.model.fx(), 199.37143, 1e-5);
  EXPECT_TRUE(camera.T_B_C.translation().isApprox(Eigen::Vector3d(0.006746964, 0.000727922, 0.034257361)));
  EXPECT_EQ(camera.time_offset, Duration(2'400'000));
  EXPECT_EQ(c.rig.camera("frames").T_B_C.matrix(), camera.T_B_C.matrix());
  EXPECT_NEAR(c.imu.gyro_saturation, 17.4, 1e-12);
  EXPECT_THAT(input_error([] { load_rig("davis"); }), HasSubstr("davis240c_ecd"));
}

TEST(Calibration, RigsAreFoundInTheFolderOfTheEnvironment) {
  TempFolder folder;
  folder.write("mine.yaml", kOwn);
  ::setenv("EDGED_RIGS", folder.path().c_str(), 1);
  EXPECT_EQ(load_rig("mine").rig.cameras.size(), 2u);
  EXPECT_THAT(known_rigs(), ::testing::Contains("mine"));
  ::unsetenv("EDGED_RIGS");
  EXPECT_EQ(load_rig((folder.path() / "mine.yaml").string()).rig.cameras.size(), 2u);
}

TEST(Calibration, MistakesAreNamedByFileLineAndKey) {
  TempFolder folder;
  const auto complaint = [&](const std::string& text) {
    return input_error([&] { load_calibration(folder.write("c.yaml", text)); });
  };
  EXPECT_THAT(complaint(replaced(kOwn, "[0, 0, 1, 0.1]", "[0, 0, 1.1, 0.1]")),
              ::testing::AllOf(HasSubstr("c.yaml:14: cameras[0].T_B_C"), HasSubstr("differs from 1 by 0.21")));
  EXPECT_THAT(complaint(replaced(kOwn, "[0, 0, 1, 0.1]", "[0, 0, -1, 0.1]")), HasSubstr("mirrored"));
  EXPECT_THAT(complaint(replaced(kOwn, "[200, 201", "[-200, 201")), HasSubstr("c.yaml:10: cameras[0].intrinsics"));
  EXPECT_THAT(complaint(replaced(kOwn, "[240, 180]", "[240]")), HasSubstr("[width, height]"));
  EXPECT_THAT(complaint(replaced(kOwn, "gyro_noise", "gyro_nose")), HasSubstr("imu.gyro_nose: unknown key"));
  EXPECT_THAT(complaint(replaced(kOwn, "5e-4", "nan")), HasSubstr("imu.gyro_noise: must be a finite number"));
  EXPECT_THAT(complaint(replaced(kOwn, "same_as: events", "same_as: event")), HasSubstr("same_as"));
  EXPECT_THAT(complaint(replaced(kOwn, "name: frames", "name: events")), HasSubstr("taken"));
  EXPECT_THAT(complaint(replaced(kOwn, "radtan", "fisheye9")), HasSubstr("fisheye9"));
  EXPECT_THAT(complaint(replaced(kKalibr, "pinhole", "omni")), HasSubstr("omni"));
  EXPECT_THAT(complaint("{"), HasSubstr("not readable as yaml"));
  EXPECT_THAT(complaint("a: 1\n"), HasSubstr("no known calibration"));
  EXPECT_THAT(complaint(""), HasSubstr("no known calibration"));
  EXPECT_THAT(input_error([&] { load_calibration(folder.path() / "none.yaml"); }), HasSubstr("no such calibration"));
}

TEST(Calibration, DescriptionShowsBothDirectionsAndTheOffset) {
  TempFolder folder;
  const std::string text = describe(load_calibration(folder.write("k.yaml", kKalibr)));
  EXPECT_THAT(text, HasSubstr("[ 0.000000000  0.000000000  1.000000000 |  0.100000000]\n  T_B_C = [-1"));
  EXPECT_THAT(text, HasSubstr("T_C_B = [ 0"));
  EXPECT_THAT(text, HasSubstr("[ 1.000000000  0.000000000  0.000000000 | -0.100000000]"));
  EXPECT_THAT(text, HasSubstr("t_imu = t_cam -3.100 ms"));
}

TEST(Calibration, WrittenYamlReadsBack) {
  TempFolder folder;
  const Calibration a = load_rig("davis240c_ecd");
  const Calibration b = load_calibration(folder.write("b.yaml", to_yaml(a)));
  ASSERT_EQ(b.rig.cameras.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(a.rig.cameras[i].name, b.rig.cameras[i].name);
    EXPECT_EQ(a.rig.cameras[i].model, b.rig.cameras[i].model);
    EXPECT_EQ(a.rig.cameras[i].time_offset, b.rig.cameras[i].time_offset);
    EXPECT_EQ(a.rig.cameras[i].T_B_C.translation(), b.rig.cameras[i].T_B_C.translation());
    EXPECT_TRUE(a.rig.cameras[i].T_B_C.matrix().isApprox(b.rig.cameras[i].T_B_C.matrix(), 1e-15));
  }
  EXPECT_EQ(a.imu.accel_saturation, b.imu.accel_saturation);
  EXPECT_EQ(a.imu.gyro_walk, b.imu.gyro_walk);
}

}  // namespace
}  // namespace edged
