// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Formats of other programs: direction of transforms, sign of time offsets, modality of cameras.
#include "edged/io/calib/calib_test_support.hpp"
#include "edged/io/calib/calibration_readers.hpp"

namespace edged {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// All have a camera 10 cm in front of the IMU (along x of the body), with its axis along x.
constexpr const char* kInline = R"(%YAML:1.0
---
imu_topic: "/davis_left/imu"
event_topic: "/davis_left/events"
model_type: PINHOLE
camera_name: camera
image_width: 346
image_height: 260
distortion_parameters:
   k1: -0.37
   k2: 0.15
   p1: 0.001
   p2: -0.002
projection_parameters:
   fx: 250.0
   fy: 249.0
   cx: 177.0
   cy: 129.0
extrinsicRotation: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   # a comment between the lines
   data: [0, 0, 1,
          -1, 0, 0,
          0, -1, 0]
extrinsicTranslation: !!opencv-matrix
   rows: 3
   cols: 1
   dt: d
   data: [0.1, 0, 0]
acc_n: 0.2
td: 0.0077
)";

constexpr const char* kIntrinsics = R"(%YAML:1.0
---
model_type: PINHOLE
camera_name: camera
image_width: 640
image_height: 480
distortion_parameters: {k1: -0.03, k2: 0.04, p1: 0, p2: 0}
projection_parameters: {fx: 327, fy: 327, cx: 305, cy: 235}
)";

constexpr const char* kUslam = R"(label: "HEAD"
id: 1234
cameras:
- camera:
    label: dvs
    id: 0
    line-delay-nanoseconds: 0
    image_height: 260
    image_width: 346
    type: pinhole
    intrinsics:
      cols: 1
      rows: 4
      data: [250.0, 249.0, 177.0, 129.0]
    distortion:
      type: radial-tangential
      parameters:
        cols: 1
        rows: 4
        data: [-0.37, 0.15, 0.001, -0.002]
  T_B_C:
    cols: 4
    rows: 4
    data: [0, 0, 1, 0.1,
           -1, 0, 0, 0,
           0, -1, 0, 0,
           0, 0, 0, 1]
- camera:
    label: standard
    image_height: 260
    image_width: 346
    type: pinhole
    intrinsics: {cols: 1, rows: 4, data: [250.0, 249.0, 177.0, 129.0]}
    distortion: {type: none}
  T_B_C: {cols: 4, rows: 4, data: [0, 0, 1, 0.1, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 1]}
)";

constexpr const char* kBasalt = R"({
    "value0": {
        "T_imu_cam": [
            {"px": 0.1, "py": 0, "pz": 0.0, "qx": -0.5, "qy": 0.5, "qz": -0.5, "qw": 0.5}
        ],
        "intrinsics": [
            {"camera_type": "kb4",
             "intrinsics": {"fx": 250.0, "fy": 249.0, "cx": 177.0, "cy": 129.0,
                            "k1": 0.02, "k2": 0.002, "k3": 0.002, "k4": -0.001}}
        ],
        "resolution": [[346, 260]],
        "vignette": [],
        "imu_update_rate": 200.0,
        "accel_noise_std": [0.016, 0.017, 0.016],
        "gyro_noise_std": [0.00028, 0.00028, 0.00029],
        "accel_bias_std": [0.001, 0.001, 0.001],
        "gyro_bias_std": [0.0001, 0.0001, 0.0001],
        "cam_time_offset_ns": -2500000
    }
}
)";

constexpr const char* kCameraInfo = R"(image_width: 640
image_height: 480
camera_name: Prophesee_left
camera_matrix:
  rows: 3
  cols: 3
  data: [327.0, 0, 305.0, 0, 328.0, 235.0, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.03, 0.04, -0.0005, -0.001, 0.0]
rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}
)";

class CalibrationFormats : public CalibrationFiles {};

TEST_F(CalibrationFormats, VinsMapsTheCameraToTheImuAndADavisSeesBoth) {
  const Calibration c = load(kInline);
  EXPECT_THAT(names_and_kinds(c), ElementsAre("events:events", "frames:frames"));
  expect_forward_at_10_cm(c.rig.cameras[0]);
  EXPECT_EQ(c.rig.cameras[0].time_offset, Duration(7'700'000));
  EXPECT_EQ(c.rig.cameras[0].model.distortion(), DistortionModel::RadTan);
  EXPECT_DOUBLE_EQ(c.rig.cameras[0].model.coefficients()[3], -0.002);
  EXPECT_FALSE(c.has_imu_noise);
  EXPECT_THAT(c.warnings, ElementsAre(HasSubstr("is not a density")));
}

TEST_F(CalibrationFormats, VinsTurnsItRoundWhereTheFlagSaysSo) {
  std::string text = replaced(kInline, "data: [0, 0, 1,\n          -1, 0, 0,\n          0, -1, 0]",
                              "data: [0, -1, 0, 0, 0, -1, 1, 0, 0]");
  text = replaced(text, "data: [0.1, 0, 0]", "data: [0, 0, -0.1]");
  expect_forward_at_10_cm(load(text + "T_camera_imu: 1\n").rig.cameras[0]);
  EXPECT_FALSE(
      load(text + "T_camera_imu: 0\n").rig.cameras[0].T_B_C.translation().isApprox(Eigen::Vector3d(0.1, 0, 0)));
}

TEST_F(CalibrationFormats, EsvioNamesTheFilesOfItsCamerasAndHasAFlagForEach) {
  folder_.write("event0.yaml", kIntrinsics);
  folder_.write("cam1.yaml", replaced(kIntrinsics, "640", "612"));
  const std::string pose = R"(event_left_calib: "event0.yaml"
cam_right_calib: "cam1.yaml"
extrinsicRotation_event: !!opencv-matrix {rows: 3, cols: 3, dt: d, data: [0, -1, 0, 0, 0, -1, 1, 0, 0]}
extrinsicTranslation_event: !!opencv-matrix {rows: 3, cols: 1, dt: d, data: [0, 0, -0.1]}
T_event_imu: 1
body_T_cam1: !!opencv-matrix {rows: 4, cols: 4, dt: d, data: [0, 0, 1, 0.1, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 1]}
)";
  const Calibration c = load("%YAML:1.0\n\n" + pose);
  EXPECT_THAT(names_and_kinds(c), ElementsAre("events:events", "frames_right:frames"));
  EXPECT_TRUE(c.has_extrinsics);
  for (const RigCamera& camera : c.rig.cameras) expect_forward_at_10_cm(camera);
  EXPECT_EQ(c.rig.cameras[1].model.width(), 612);
  EXPECT_THAT(complaint(replaced(pose, "event0", "event9")), HasSubstr("event9.yaml: cannot be opened"));
}

TEST_F(CalibrationFormats, VinsFusionTakesPosesOfTheBody) {
  folder_.write("left.yaml", kIntrinsics);
  const Calibration c = load(
      "%YAML:1.0\nimage0_topic: \"/cam0/image_raw\"\ncam0_calib: \"left.yaml\"\nbody_T_cam0: !!opencv-matrix\n   rows: "
      "4\n"
      "   cols: 4\n   dt: d\n   data: [0, 0, 1, 0.1, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 1]\n");
  EXPECT_THAT(names_and_kinds(c), ElementsAre("cam0:frames"));
  expect_forward_at_10_cm(c.rig.cameras[0]);
}

TEST_F(CalibrationFormats, KannalaBrandtOfVinsIsEquidistantAndMeiIsOmni) {
  const std::string head = "%YAML:1.0\nmodel_type: KANNALA_BRANDT\nimage_width: 752\nimage_height: 480\n";
  const CalibrationOptions frames{.sees = {{"cam0", Sees::Frames}}};
  const Calibration c = load(
      head + "projection_parameters: {k2: 0.01, k3: 0.02, k4: 0, k5: 0, mu: 460, mv: 461, u0: 370, v0: 240}\n", frames);
  EXPECT_EQ(c.rig.cameras[0].model.distortion(), DistortionModel::Equidistant);
  EXPECT_DOUBLE_EQ(c.rig.cameras[0].model.fy(), 461);
  EXPECT_FALSE(c.has_extrinsics);
  const std::string mei =
      "%YAML:1.0\nmodel_type: MEI\nimage_width: 752\nimage_height: 480\nmirror_parameters: {xi: 3.06}\n"
      "distortion_parameters: {k1: 0.67, k2: 7.05, p1: -0.0007, p2: 0.000004}\n"
      "projection_parameters: {gamma1: 1877.3, gamma2: 1871.4, u0: 361.5, v0: 248.3}\n";
  EXPECT_EQ(load(mei, frames).rig.cameras[0].model,
            CameraModel(752, 480, 1877.3, 1871.4, 361.5, 248.3, DistortionModel::Omni,
                        {3.06, 0.67, 7.05, -0.0007, 0.000004}));
  const std::string full =
      "%YAML:1.0\nmodel_type: PINHOLE_FULL\nimage_width: 752\nimage_height: 480\n"
      "distortion_parameters: {k1: 0.2, k2: 0, k3: 0, k4: 0.4, k5: 0.01, k6: 0, p1: 0.001, p2: 0.002}\n"
      "projection_parameters: {fx: 460, fy: 461, cx: 370, cy: 240}\n";
  EXPECT_EQ(
      load(full, frames).rig.cameras[0].model,
      CameraModel(752, 480, 460, 461, 370, 240, DistortionModel::Rational, {0.2, 0, 1e-3, 2e-3, 0, 0.4, 0.01, 0}));
  EXPECT_THAT(complaint(replaced(kInline, "PINHOLE", "MEI")), HasSubstr("mirror_parameters is missing"));
  EXPECT_THAT(complaint(replaced(kInline, "PINHOLE", "SCARAMUZZA")), HasSubstr("model SCARAMUZZA is not supported"));
}

TEST_F(CalibrationFormats, UslamsPoseIsOurs) {
  const Calibration c = load(kUslam);
  EXPECT_EQ(c.rig.name, "HEAD");
  EXPECT_THAT(names_and_kinds(c), ElementsAre("dvs:events", "standard:frames"));
  for (const RigCamera& camera : c.rig.cameras) expect_forward_at_10_cm(camera);
  EXPECT_EQ(c.rig.cameras[1].model.distortion(), DistortionModel::None);
}

TEST_F(CalibrationFormats, TheRowsOfAUslamPoseInFourListsAreRefusedWithAHint) {
  const std::string text = replaced(kUslam, R"(    data: [0, 0, 1, 0.1,
           -1, 0, 0, 0,
           0, -1, 0, 0,
           0, 0, 0, 1]
)",
                                    R"(    data: [0, 0, 1, -1.97]
  [-1, 0, 0, -8.98]
  [0, -1, 0, -26.0]
  [0.0, 0.0, 0.0, 1.0]
)");
  EXPECT_THAT(complaint(text),
              ::testing::AllOf(HasSubstr("c.yaml:25: not readable"), HasSubstr("one pair of brackets")));
  EXPECT_THAT(complaint(replaced(kUslam, "data: [0, 0, 1, 0.1,", "data: [1]\n    more: [0, 0, 1, 0.1,")),
              HasSubstr("4 rows of 4 need more than the 1 numbers"));
}

TEST_F(CalibrationFormats, AUslamRigInMillimetresWithAWrongWidthIsReadAndNamed) {
  std::string text = replaced(kUslam, "data: [0, 0, 1, 0.1,\n", "data: [0, 0, 1, -26.0,\n");
  text = replaced(text, "label: standard\n    image_height: 260\n    image_width: 346",
                  "label: standard\n    image_height: 260\n    image_width: 240");
  EXPECT_THAT(load(text).warnings,
              ElementsAre(HasSubstr("camera dvs: 26 m away from the IMU"),
                          HasSubstr("camera standard: has the lens of camera dvs but 240 x 260"),
                          HasSubstr("camera standard: the principal point (177, 129) is 24 % off")));
}

TEST_F(CalibrationFormats, BasaltsPoseOffsetAndDensitiesAreOurs) {
  const Calibration c = load(kBasalt, {.sees = {{"cam0", Sees::Events}}}, "c.json");
  EXPECT_THAT(names_and_kinds(c), ElementsAre("cam0:events"));
  expect_forward_at_10_cm(c.rig.cameras[0]);
  EXPECT_EQ(c.rig.cameras[0].time_offset, Duration(-2'500'000));
  EXPECT_EQ(c.rig.cameras[0].model.distortion(), DistortionModel::Equidistant);
  EXPECT_DOUBLE_EQ(c.imu.accel_noise, 0.017);
  EXPECT_DOUBLE_EQ(c.imu.gyro_noise, 0.00029);
  EXPECT_DOUBLE_EQ(c.imu.gyro_walk, 0.0001);
  EXPECT_THAT(complaint(replaced(kBasalt, "kb4", "ds9")), HasSubstr("camera type ds9 is not supported"));
  EXPECT_THAT(complaint(replaced(kBasalt, "kb4", "ds")), HasSubstr("the key xi is missing"));
  EXPECT_THAT(complaint(replaced(kBasalt, "\"qw\": 0.5", "\"qw\": 1.5")), HasSubstr("norm of 1.732"));
  EXPECT_THAT(complaint(kBasalt), HasSubstr("--camera cam0=events --out"));
}

TEST_F(CalibrationFormats, TheFourCamerasOfTumVieAreKnownByTheirSizes) {
  std::string pose, camera, size;
  for (int i = 0; i < 4; ++i) {
    const char* comma = i < 3 ? ", " : "";
    pose += std::string(R"({"px": 0, "py": 0, "pz": 0, "qx": 0, "qy": 0, "qz": 0, "qw": 1})") + comma;
    camera += std::string(R"({"camera_type": "pinhole", "intrinsics": {"fx": 900, "fy": 900, "cx": 600, "cy": 400}})") +
              comma;
    size += std::string(i < 2 ? "[1024, 1024]" : "[1280, 720]") + comma;
  }
  const Calibration c = load(R"({"value0": {"T_imu_cam": [)" + pose + R"(], "intrinsics": [)" + camera +
                                 R"(], "resolution": [)" + size + "]}}",
                             {}, "camera-calibrationA.json");
  EXPECT_THAT(names_and_kinds(c),
              ElementsAre("frames:frames", "frames_right:frames", "events:events", "events_right:events"));
  folder_.write("mocap-imu-calibrationA.json", "{}");
  EXPECT_EQ(load_calibration(folder_.path()).rig.cameras.size(), 4u);
}

TEST_F(CalibrationFormats, CameraInfoHasIntrinsicsOnly) {
  const Calibration c = load(kCameraInfo);
  EXPECT_FALSE(c.has_extrinsics);
  EXPECT_THAT(names_and_kinds(c), ElementsAre("Prophesee_left:events"));
  EXPECT_DOUBLE_EQ(c.rig.cameras[0].model.cx(), 305);
  EXPECT_DOUBLE_EQ(c.rig.cameras[0].model.fy(), 328);
  const std::string rational = replaced(kCameraInfo, "plumb_bob", "rational_polynomial");
  EXPECT_EQ(load(replaced(rational, "-0.001, 0.0]", "-0.001, 0.0, 0, 0, 0]")).rig.cameras[0].model.distortion(),
            DistortionModel::RadTan);
  EXPECT_EQ(load(replaced(rational, "-0.001, 0.0]", "-0.001, 0.0, 0.1, 0, 0]")).rig.cameras[0].model.distortion(),
            DistortionModel::Rational);
  EXPECT_THAT(complaint(replaced(rational, "-0.001, 0.0]", "-0.001, 0.0, 0, 0, 0, 0, 0.1, 0, 0]")),
              HasSubstr("s2 = 0.1 is not supported"));
  EXPECT_THAT(complaint(replaced(kCameraInfo, "[327.0, 0, 305.0", "[327.0, 2, 305.0")), HasSubstr("camera_matrix"));
}

TEST_F(CalibrationFormats, CameraInfoMayBeAMessageAsRosPrintsIt) {
  const std::string ros2 =
      "header:\n  frame_id: cam0\nheight: 180\nwidth: 240\ndistortion_model: equidistant\nd: [0.01, 0.02, 0.0, 0.0]\n"
      "k: [200.0, 0.0, 120.0, 0.0, 201.0, 90.0, 0.0, 0.0, 1.0]\nr: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
      "p: [200.0, 0.0, 120.0, 0, 0.0, 201.0, 90.0, 0, 0.0, 0.0, 1.0, 0]\n---\n";
  const std::string ros1 = replaced(replaced(ros2, "\nd:", "\nD:"), "\nk:", "\nK:");
  for (const std::string& text : {ros2, ros1}) {
    const Calibration c = load(text, {.otherwise = Sees::Events});
    EXPECT_EQ(c.rig.cameras.at(0).model.fy(), 201.0);
    EXPECT_EQ(c.rig.cameras.at(0).model.distortion(), DistortionModel::Equidistant);
  }
}

TEST_F(CalibrationFormats, VectorIsReadFromItsFolder) {
  folder_.write("left_event_camera_intrinsic_results.yaml", kCameraInfo);
  folder_.write("left_regular_camera_intrinsic_results.yaml", replaced(kCameraInfo, "Prophesee_left", "left"));
  const auto joint = folder_.write("small_scale_joint_camera_extrinsic_results.yaml",
                                   "camera_number: 3\ncam0: {camera_name: a}\ncam2:\n  camera_name: b\n"
                                   "  T_cam0_cam2: [1, 0, 0, 0, 0, 1, 0, -0.04, 0, 0, 1, 0, 0, 0, 0, 1]\n");
  folder_.write("small_scale_camera_imu_extrinsic_results1.yaml",
                "cam0:\n  T_cam_imu: [0, -1, 0, 0, 0, 0, -1, 0, 1, 0, 0, -0.1, 0, 0, 0, 1]\n");
  const Calibration c = load_calibration(folder_.path());
  EXPECT_EQ(c.rig.name, "vector_small_scale");
  EXPECT_THAT(names_and_kinds(c), ElementsAre("frames:frames", "events:events"));
  expect_forward_at_10_cm(c.rig.cameras[0]);
  // 4 cm up in the image (camera -y) is 4 cm up on the body.
  EXPECT_TRUE(c.rig.cameras[1].T_B_C.translation().isApprox(Eigen::Vector3d(0.1, 0, 0.04)));
  folder_.write("large_scale_joint_camera_extrinsic_results.yaml", "cam0: {}\n");
  EXPECT_THAT(input_error([&] { load_calibration(folder_.path()); }), HasSubstr("several calibrations"));
  EXPECT_EQ(load_calibration(joint).rig.cameras.size(), 2u);
}

TEST_F(CalibrationFormats, WordsAndSizesTellWhatACameraSees) {
  EXPECT_EQ(guess_sees("/davis/left/image_raw", 346, 260), Sees::Both);
  EXPECT_EQ(guess_sees("/dvs/image_raw", 240, 180), Sees::Both);
  EXPECT_EQ(guess_sees("/dvs/image_raw", 640, 480), Sees::Events);  // no DAVIS: an image rendered from events
  EXPECT_EQ(guess_sees("/davis/left/events", 640, 480), Sees::Events);
  EXPECT_EQ(guess_sees("dvs", 346, 260), Sees::Events);
  EXPECT_EQ(guess_sees("Prophesee_Gen3", 640, 480), Sees::Events);
  EXPECT_EQ(guess_sees("/camera/left/image_mono", 1224, 1024), Sees::Frames);
  EXPECT_EQ(guess_sees("standard", 346, 260), Sees::Frames);
  EXPECT_EQ(guess_sees("cam0", 346, 260), std::nullopt);
}

TEST_F(CalibrationFormats, AClockIsNotBelievedToBeMinutesOff) {
  EXPECT_THAT(complaint(replaced(kInline, "td: 0.0077", "td: 777")), HasSubstr("td: a clock off by 777 s"));
}

TEST_F(CalibrationFormats, AnyFormatBecomesOurs) {
  for (const char* text : {kInline, kUslam}) {
    const Calibration a = load(text), b = load(to_yaml(a), {}, "own.yaml");
    ASSERT_EQ(names_and_kinds(a), names_and_kinds(b));
    for (std::size_t i = 0; i < a.rig.cameras.size(); ++i) {
      EXPECT_EQ(a.rig.cameras[i].model, b.rig.cameras[i].model);
      EXPECT_EQ(a.rig.cameras[i].time_offset, b.rig.cameras[i].time_offset);
      EXPECT_TRUE(a.rig.cameras[i].T_B_C.matrix().isApprox(b.rig.cameras[i].T_B_C.matrix(), 1e-15));
    }
  }
}

TEST_F(CalibrationFormats, DamagedFilesAreReadOrRefusedButNothingElse) {
  std::size_t read = 0;
  for (const char* text : {kInline, kUslam, kBasalt, kCameraInfo}) read += load_damaged(text);
  EXPECT_GT(read, 3u);  // at least the complete ones, except basalt, which has no names
}

}  // namespace
}  // namespace edged
