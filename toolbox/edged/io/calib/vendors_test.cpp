// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Calibration formats of the makers of event cameras: DV of iniVation, Metavision of Prophesee.
#include "edged/io/calib/calib_test_support.hpp"

namespace edged {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Calibrations with a pose have a camera 10 cm in front of the IMU (along x of the body), with its axis along x.
constexpr const char* kDvJson = R"({
    "version": "2.0",
    "cameras": {
        "C0": {
            "name": "DVXplorer_DXA00001", "position": "left", "master": "true",
            "resolution": ["640", "480"], "principalPoint": ["311.5", "241.25"], "focalLength": ["530.5", "531"],
            "distortionCoefficients": ["-0.3", "0.1", "0.001", "-0.002", "0.01"], "distortionModel": "radialTangential",
            "transformationToC0": ["1", "0", "0", "0", "0", "1", "0", "0", "0", "0", "1", "0", "0", "0", "0", "1"]
        },
        "C1": {
            "name": "DAVIS346_00000002", "position": "right", "master": "false",
            "resolution": ["346", "260"], "principalPoint": ["170", "130"], "focalLength": ["250", "250"],
            "distortionCoefficients": "", "distortionModel": "none",
            "transformationToC0": ["1", "0", "0", "-0.05", "0", "1", "0", "0", "0", "0", "1", "0", "0", "0", "0", "1"]
        }
    },
    "imus": {
        "S0": {
            "name": "DVXplorer_DXA00001", "omegaMax": "34.9", "accMax": "156", "omegaNoiseDensity": "0.00018",
            "timeOffsetMicros": "2897",
            "transformationToC0": ["0", "-1", "0", "0", "0", "0", "-1", "0", "1", "0", "0", "-0.1", "0", "0", "0", "1"]
        }
    },
    "stereo": ""
}
)";

constexpr const char* kDvXml = R"(<?xml version="1.0"?>
<opencv_storage>
<DAVIS346_00000001>
  <camera_matrix type_id="opencv-matrix">
    <rows>3</rows>
    <cols>3</cols>
    <dt>d</dt>
    <data>
      2.5e+02 0. 1.77e+02 0. 2.49e+02
      1.29e+02 0. 0. 1.</data></camera_matrix>
  <distortion_coefficients type_id="opencv-matrix">
    <rows>1</rows>
    <cols>4</cols>
    <dt>d</dt>
    <data>
      0.02 0.002 0.002 -0.001</data></distortion_coefficients>
  <image_width>346</image_width>
  <image_height>260</image_height></DAVIS346_00000001>
<use_fisheye_model>0</use_fisheye_model>
<type>camera</type>
<distortion_model>Equidistant</distortion_model>
<calibration_error>"N/A"</calibration_error>
<calibration_time>"Mi 08 Sep 2021 10:54:37"</calibration_time>
<time_offset_cam_imu__t_imu_equals_t_cam_plus_shift>2.5e-03</time_offset_cam_imu__t_imu_equals_t_cam_plus_shift>
<transformation_cam_imu type_id="opencv-matrix">
  <rows>4</rows>
  <cols>4</cols>
  <dt>d</dt>
  <data>
    0. -1. 0. 0. 0. 0. -1. 0. 1. 0. 0. -0.1 0. 0. 0. 1.</data></transformation_cam_imu>
</opencv_storage>
)";

constexpr const char* kFirstDvXml = R"(<?xml version="1.0"?>
<opencv_storage>
<calibration_time>"Mon Nov  1 14:32:23 2021"</calibration_time>
<image_width>640</image_width>
<image_height>480</image_height>
<use_fisheye_model>1</use_fisheye_model>
<camera_matrix type_id="opencv-matrix">
  <rows>3</rows><cols>3</cols><dt>d</dt>
  <data>327. 0. 305. 0. 328. 235. 0. 0. 1.</data></camera_matrix>
<distortion_coefficients type_id="opencv-matrix">
  <rows>4</rows><cols>1</cols><dt>d</dt>
  <data>0.02 0.002 0.002 -0.001</data></distortion_coefficients>
</opencv_storage>
)";

constexpr const char* kMetavision = R"({
    "type": "pinhole", "width": 1280, "height": 720,
    "K": [1040.5, 0.0, 641.25, 0.0, 1041.0, 357.75, 0.0, 0.0, 1.0],
    "D": [-0.1, 0.08, 0.0005, -0.0006, 0.01]
}
)";

constexpr const char* kMetavision4 = R"({
    "n_kept_views": 12,
    "image_size": [1280, 720],
    "pattern": {"n_rows": 6, "n_cols": 9, "square_height": 0.025, "square_width": 0.025},
    "camera_matrix": {"type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d",
                      "data": [1040.5, 0.0, 641.25, 0.0, 1041.0, 357.75, 0.0, 0.0, 1.0]},
    "distortion_coefficients": {"type_id": "opencv-matrix", "rows": 1, "cols": 5, "dt": "d",
                                "data": [-0.1, 0.08, 0.0005, -0.0006, 0.01]},
    "selected_views": [1, 1, 0]
}
)";

class VendorsCalibrations : public CalibrationFiles {};

TEST_F(VendorsCalibrations, ThePoseOfDvsImuIsTurnedRoundAndItsOffsetIsOurs) {
  const Calibration c = load(kDvJson, {}, "calibration.json");
  ASSERT_EQ(c.rig.cameras.size(), 3u);
  const RigCamera& left = c.rig.cameras[0];
  EXPECT_EQ(left.name, "DVXplorer_DXA00001");
  EXPECT_EQ(left.modality, Modality::Events);
  EXPECT_EQ(left.model.distortion(), DistortionModel::RadTan);
  EXPECT_DOUBLE_EQ(left.model.coefficients()[4], 0.01);
  EXPECT_DOUBLE_EQ(left.model.cy(), 241.25);
  expect_forward_at_10_cm(left);
  EXPECT_EQ(left.time_offset, Duration(2'897'000));
  EXPECT_FALSE(c.has_imu_noise);
  EXPECT_THAT(c.warnings, ElementsAre(HasSubstr("imus.S0: noise densities in DV's files")));
}

TEST_F(VendorsCalibrations, TheSecondCameraOfDvStandsWhereTheFirstSeesIt) {
  const RigCamera right = load(kDvJson, {}, "calibration.json").rig.cameras[1];
  EXPECT_EQ(right.name, "events");  // a DAVIS has events and frames
  // 5 cm to the right in the image of the first camera, which is -y of the body.
  EXPECT_TRUE(right.T_B_C.translation().isApprox(Eigen::Vector3d(0.1, -0.05, 0), 1e-12));
}

TEST_F(VendorsCalibrations, DvsXmlIsReadAsTheYamlThatOpenCvWouldHaveWritten) {
  const Calibration c = load(kDvXml, {}, "camera_imu_calibration.xml");
  ASSERT_EQ(c.rig.cameras.size(), 2u);
  const RigCamera& events = c.rig.camera("events");
  EXPECT_EQ(events.model.distortion(), DistortionModel::Equidistant) << "not what use_fisheye_model says";
  EXPECT_DOUBLE_EQ(events.model.fy(), 249.0);
  expect_forward_at_10_cm(events);
  EXPECT_EQ(events.time_offset, Duration(2'500'000));
  const Calibration first = load(kFirstDvXml, {}, "dvs.xml");
  EXPECT_FALSE(first.has_extrinsics);
  EXPECT_EQ(first.rig.cameras[0].model.distortion(), DistortionModel::Equidistant);
}

TEST_F(VendorsCalibrations, MetavisionsLensIsOfEventsInBothItsFormats) {
  for (const char* text : {kMetavision, kMetavision4}) {
    const Calibration c = load(text, {}, "intrinsics.json");
    EXPECT_FALSE(c.has_extrinsics);
    ASSERT_EQ(c.rig.cameras.size(), 1u);
    EXPECT_EQ(c.rig.cameras[0].modality, Modality::Events);
    EXPECT_EQ(c.rig.cameras[0].model, CameraModel(1280, 720, 1040.5, 1041.0, 641.25, 357.75, DistortionModel::RadTan,
                                                  {-0.1, 0.08, 0.0005, -0.0006, 0.01}));
  }
  EXPECT_EQ(load_calibration(folder_.path()).rig.cameras.size(), 1u) << "found in a folder by its name";
}

TEST_F(VendorsCalibrations, ALensAloneIsWrittenWithItsPoseToFillIn) {
  const std::string text = to_yaml(load(kMetavision, {}, "intrinsics.json"));
  EXPECT_THAT(text, HasSubstr("intrinsics: [1040.5, 1041, 641.25, 357.75]"));
  EXPECT_THAT(complaint(text, {}, "head.yaml"),
              HasSubstr("head.yaml:13: 3 lines read FILL_IN: 13, 14, 15; write your numbers there"));
}

TEST_F(VendorsCalibrations, WhatCannotBeUsedIsRefusedByItsKey) {
  EXPECT_THAT(complaint(replaced(kMetavision, "pinhole", "ocam")),
              HasSubstr("type: camera type ocam is not supported"));
  EXPECT_THAT(complaint(replaced(kMetavision, "1041.0", "-1041.0")), HasSubstr("focal lengths"));
  EXPECT_THAT(complaint(R"({"T_slave_master": [{"rvec": [0, 0, 0], "tvec": [0.1, 0, 0]}]})"),
              HasSubstr("two cameras to each other"));
  EXPECT_THAT(complaint(replaced(kDvJson, "\"640\", \"480\"", "\"640\"")),
              HasSubstr("cameras.C0.resolution: must be [width"));
  EXPECT_THAT(complaint(replaced(kDvJson, "\"2897\"", "\"28970000\"")),
              HasSubstr("timeOffsetMicros: a clock off by 28.97 s"));
  EXPECT_THAT(complaint(replaced(kDvXml, "Equidistant", "FOV"), {}, "c.xml"),
              HasSubstr("distortion fov has 1 coefficient, here are 4"));
  EXPECT_THAT(complaint(replaced(kDvXml, "</rows>", ""), {}, "c.xml"),
              HasSubstr("c.xml: not readable as xml from line"));
  EXPECT_THAT(complaint("<svg></svg>", {}, "c.xml"), HasSubstr("no element opencv_storage"));
}

TEST_F(VendorsCalibrations, DamagedOnesAreReadOrRefusedButNothingElse) {
  for (const char* text : {kDvJson, kDvXml, kFirstDvXml, kMetavision, kMetavision4})
    EXPECT_GT(load_damaged(text, {.otherwise = Sees::Events}), 0u);
}

}  // namespace
}  // namespace edged
