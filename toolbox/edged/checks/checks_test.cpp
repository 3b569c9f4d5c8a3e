// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Each problem is reported with its remedy, and a good recording has none.
#include "edged/checks/checks.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "edged/checks/checks_test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;
using enum Severity;

TEST(Checks, NamesATruthThatContradictsItselfAndItsTime) {
  RecordingStatistics s = healthy();
  s.truth.emplace();
  s.truth->stream = stream(100, 0, 10);
  s.truth->jumps = 2, s.truth->first_jump = {timestamp_from_seconds(3), 1.5, 0.7};
  EXPECT_THAT(remedy_of(s, {}, Warning, "2 jumps, the first at 3.000 s by 1.50 m and 40 deg"), HasSubstr("remove"));
  EXPECT_TRUE(is_unusable(Unusable::Truth, check_recording({s})));
  s.truth->frozen = std::chrono::seconds(1), s.truth->frozen_since = timestamp_from_seconds(2);
  EXPECT_THAT(remedy_of(s, {}, Warning, "the same pose for 1.000 s from 2.000 s on"), HasSubstr("remove"));
}

TEST(Checks, NamesACauseAndNotTheTimeOffsetThatFollows) {
  RecordingStatistics s = healthy();
  CheckInput input{s, true, {agreeing()}};
  input.cameras[0].agreement->time_offset = std::chrono::milliseconds(12);
  const auto remedy = [&](Severity of, const char* text) { return remedy_of(check_recording(input), of, text); };
  EXPECT_NE(remedy(Warning, "t_imu"), "NO SUCH FINDING");
  input.cameras[0].lens = "a focal length near 200 px fits";
  EXPECT_THAT(remedy(Error, "another lens: a focal length near 200 px fits"), HasSubstr("calibration of this lens"));
  EXPECT_EQ(remedy(Warning, "t_imu"), "NO SUCH FINDING");
  s.repeated_share = 0.67;
  EXPECT_THAT(remedy(Warning, "67 % of the frames repeat the image before"), HasSubstr("driver"));
  s.repeated_share = 0.0, input.exchanged = {"left and right"};
  EXPECT_THAT(remedy(Error, "cameras left and right: their images match only"), HasSubstr("exchange"));
  EXPECT_EQ(remedy(Error, "another lens"), "NO SUCH FINDING");
}

TEST(Checks, NamesEventsThatLieElsewhereAndNoMountingThatFollows) {
  const RecordingStatistics s = healthy();
  CheckInput input{s, true, {agreeing()}};
  input.cameras[0].agreement->unexplained = 0.7;
  input.cameras[0].gross_deg = 170.0;
  EXPECT_THAT(remedy_of(check_recording(input), Error, "camera cam: rotates as if mounted about 170 deg off"),
              HasSubstr("T_B_C"));
  input.flipped = "mirrored left to right";
  EXPECT_THAT(remedy_of(check_recording(input), Error, "the edges of the frames only if mirrored left to right"),
              HasSubstr("driver"));
  EXPECT_EQ(remedy_of(check_recording(input), Error, "rotates as if mounted"), "NO SUCH FINDING");
}

TEST(Checks, NamesALeverArmInMillimetresOnceForEachLens) {
  CameraCheck frames = agreeing(), events = agreeing(), other = agreeing();
  frames.camera.T_B_C = events.camera.T_B_C = SE3(Eigen::Quaterniond::Identity(), {60, 0, 0});
  other.camera.T_B_C = SE3(Eigen::Quaterniond::Identity(), {90, 0, 0});
  const auto findings = check_recording({healthy(), true, {frames, events, other}});
  EXPECT_EQ(std::ranges::count_if(findings, [](const Finding& f) { return f.text.find("in millimetres") < 200; }), 2);
}

TEST(Checks, NameFramesThatTheRunDroppedAsItsOwn) {
  RecordingStatistics s = healthy();
  s.frames.gaps = 1, s.frames.longest = {{timestamp_from_seconds(3), std::chrono::milliseconds(300)}};
  EXPECT_THAT(remedy_of(s, {}, Warning, "1 gaps of the frames"), HasSubstr("overloaded bus"));
  EXPECT_THAT(remedy_of(check_recording({s, true, {}, true}), Warning, "1 gaps of the frames"),
              HasSubstr("this run dropped"));
}

TEST(Checks, OfAHealthyRecordingIsGoodAllOver) {
  for (const Finding& f : check_recording({healthy(), true, {agreeing()}})) EXPECT_EQ(f.severity, Good) << f.text;
}

TEST(Checks, NamesTheFrequencyOfALampAndWhatItTakes) {
  RecordingStatistics s = healthy();
  s.event_details.flicker = FlickerStatistics{.hz = 100.2, .time_share = 1.0, .event_share = 0.7, .image_share = 0.4};
  const std::string text =
      "a lamp flickers at 100 Hz: about 70 % of the events, in 40 % of the image, 100 % of the time";
  EXPECT_THAT(remedy_of(s, {}, Warning, text), HasSubstr("direct current"));
  s.event_details.flicker->event_share = 0.02;
  EXPECT_EQ(remedy_of(s, {}, Note, "a lamp flickers at 100 Hz"), "");
}

TEST(Checks, NamesClocksThatDoNotOverlap) {
  RecordingStatistics s = healthy();
  s.imu = stream(2000, 1000, 1010);
  EXPECT_THAT(remedy_of(s, {}, Error, "IMU 1000.000 to 1010.000 s"), HasSubstr("one clock"));
  s.imu = stream(2000, 5, 15);
  EXPECT_THAT(remedy_of(s, {}, Warning, "cover 5.0 s only"), HasSubstr("is not used"));
}

TEST(Checks, TellsAShortRecordingFromOneOfWhichSensorsAreMissing) {
  RecordingStatistics s = healthy();
  s.imu = stream(100, 0, 0.5), s.events = stream(1000, 0, 0.5), s.frames = stream(10, 0, 0.5);
  EXPECT_THAT(remedy_of(s, {}, Warning, "cover 0.50 s"), HasSubstr("record more"));
  s = healthy();
  s.imu = {}, s.frames = stream(200, 50, 60);
  EXPECT_THAT(remedy_of(s, {}, Error, "do not overlap: events 0.000"), HasSubstr("one clock"));
}

TEST(Checks, NamesWrongUnits) {
  RecordingStatistics s = healthy();
  s.imu_details.mean_accel = 1.0;
  s.imu_details.calm = ImuCalm{.begin = {}, .gyro = {0, 0, 0}, .accel = {0, 0, 1}};
  EXPECT_THAT(remedy_of(s, {}, Error, "accelerometer in g"), HasSubstr("9.80665"));
  s.imu_details.mean_accel = 9806;
  EXPECT_THAT(remedy_of(s, {}, Error, "mm/s^2"), HasSubstr("1000"));
  s.imu_details.mean_accel = 0.9;
  s.imu_details.calm = ImuCalm{.begin = {}, .gyro = {0, 0, 0}, .accel = {0.1, 0, 0}};
  EXPECT_THAT(remedy_of(s, {}, Error, "without gravity"), HasSubstr("specific force"));
  s = healthy();
  CameraCheck check = agreeing();
  check.agreement->gyro_scale = 57.0;
  EXPECT_THAT(remedy_of(s, {check}, Error, "gyro in deg/s"), HasSubstr("pi / 180"));
  s.imu_details.mean_gyro = 20;
  EXPECT_THAT(remedy_of(s, {}, Error, "probably in deg/s"), HasSubstr("pi / 180"));
}

TEST(Checks, NamesACalibrationThatContradictsTheGyro) {
  CameraCheck check = agreeing();
  check.agreement->time_offset = std::chrono::milliseconds(12);
  EXPECT_THAT(remedy_of(healthy(), {check}, Warning, "+12.0 ms"), HasSubstr("0.0120"));
  check.agreement->time_t = 2.0;
  EXPECT_EQ(remedy_of(healthy(), {check}, Note, "offset cannot be determined from its rotation rate (+- 12.0 ms)"), "")
      << "the parts of the recording do not agree on it";
  check = agreeing();
  check.agreement->R_B_C = so3::exp({0, 0, 1.5}).toRotationMatrix();
  EXPECT_THAT(remedy_of(healthy(), {check}, Error, "contradicts the gyro by 85.9 deg +- 0.1 deg"),
              HasSubstr("85.9 deg about the camera's axis (0.00, 0.00, 1.00)"));
  check.camera.T_B_C = SE3(so3::exp({0, 0, -1.5}), {0, 0, 0});
  EXPECT_THAT(remedy_of(healthy(), {check}, Error, "the inverse fits"), HasSubstr("other way"));
  check = agreeing();
  check.agreement->gyro_scale = 0.5;
  EXPECT_THAT(remedy_of(healthy(), {check}, Warning, "0.50 times"), HasSubstr("focal length"));
  check.agreement->unexplained = 0.4;
  EXPECT_EQ(remedy_of(healthy(), {check}, Warning, "0.50 times"), "NO SUCH FINDING");
}

TEST(Checks, NamesAGyroWhoseScaleIsOffAndAnAccelerometerThatPointsTheOtherWay) {
  CameraCheck check = agreeing();
  check.agreement->gyro_scale = 1.1;
  check.agreement->scale_sigma = 0.005;
  check.agreement->scale_unexplained = 0.02;
  EXPECT_THAT(remedy_of(healthy(), {check}, Warning, "reads 10.0 % +- 0.5 % too much"),
              HasSubstr("divide the gyro by 1.100"));
  check.agreement->gyro_scale = 1.02;
  EXPECT_EQ(remedy_of(healthy(), {check}, Good, "scale agrees with it to 2.0 %"), "");
  const RecordingStatistics s = healthy();
  CheckInput input{s, true, {check}};
  input.accel_axes = "(y, -x, z)";
  EXPECT_THAT(remedy_of(check_recording(input), Error, "gravity does not rotate in its axes"), HasSubstr("(y, -x, z)"));
  check.agreement->accel = {100, -0.7};
  EXPECT_THAT(remedy_of(healthy(), {check}, Error, "moves opposite to it"), HasSubstr("multiply it by -1"));
}

TEST(Checks, NamesACauseAndNotWhatFollowsFromIt) {
  CameraCheck check = agreeing();
  check.agreement->accel = {100, -0.7};
  check.agreement->time_offset = std::chrono::milliseconds(60);
  std::vector<Finding> findings = check_recording({healthy(), true, {check}});
  EXPECT_THAT(remedy_of(findings, Error, "+60.0 ms"), HasSubstr("0.0600")) << "more than a run corrects";
  EXPECT_EQ(std::ranges::count(findings, Error, &Finding::severity), 1);
  check.agreement->time_offset = Duration(0);
  check.agreement->R_B_C = so3::exp({0, 3.1, 0}).toRotationMatrix();
  findings = check_recording({healthy(), true, {check}});
  EXPECT_NE(remedy_of(findings, Error, "as if its image were reflected"), "NO SUCH FINDING");
  EXPECT_EQ(remedy_of(findings, Error, "accelerometer"), "NO SUCH FINDING");
}

TEST(Checks, GuessesTheRotationOfACameraThatHasNone) {
  CameraCheck check = agreeing();
  check.has_extrinsics = false;
  check.agreement->R_B_C << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  EXPECT_THAT(remedy_of(healthy(), {check}, Note, "0.000 1.000; -1.000"), HasSubstr("edged calib --target"));
}

TEST(Checks, NamesWhatIsMissingOrOfAnotherSize) {
  RecordingStatistics s = healthy();
  s.events = s.frames = {};
  EXPECT_THAT(remedy_of(s, {}, Error, "neither events nor frames"), HasSubstr("--topic"));
  s = healthy();
  s.image_size = cv::Size(346, 260);
  EXPECT_THAT(remedy_of(s, {agreeing()}, Error, "recorded 346 x 260"), HasSubstr("resolution"));
  EXPECT_THAT(remedy_of(healthy(), {}, Note, "no calibration"), HasSubstr("--rig"));
  EXPECT_EQ(remedy_of(check_recording({healthy(), true, {}}), Note, "no camera that could be compared"), "");
}

TEST(Checks, NamesEventsOfAPartOfTheCalibratedSensor) {
  RecordingStatistics s = healthy();
  CameraCheck check = agreeing();
  check.camera.modality = Modality::Events;
  check.camera.model = CameraModel(240, 180, 200, 200, 120, 90);
  s.event_details.extent = {240, 180};
  EXPECT_EQ(remedy_of(s, {check}, Error, "recorded"), "NO SUCH FINDING");
  s.event_details.extent = {120, 90}, s.event_details.active_share = 0.1;
  EXPECT_EQ(remedy_of(s, {check}, Error, "recorded"), "NO SUCH FINDING") << "few events";
  s.event_details.active_share = 0.9;
  EXPECT_THAT(remedy_of(s, {check}, Error, "calibrated for 240 x 180 px, recorded 120 x 90 only"),
              HasSubstr("resolution"));
}

TEST(Checks, GivesNoNumberForAShiftBeyondItsSearch) {
  CameraCheck check = agreeing();
  check.agreement->at_bound = true;
  EXPECT_THAT(remedy_of(healthy(), {check}, Warning, "100 ms or more off"), HasSubstr("clocks"));
}

TEST(Checks, JudgesNoCalibrationByMotionThatSaysNothing) {
  CameraCheck check = agreeing();
  check.agreement->R_B_C = so3::exp({0, 0, 1.5}).toRotationMatrix();
  check.agreement->unexplained = 0.8;
  EXPECT_EQ(remedy_of(healthy(), {check}, Note, "80 % of its rotation unexplained"), "");
}

TEST(Checks, JudgesNoCalibrationByAShortTurning) {
  CameraCheck check = agreeing();
  check.least_turning = std::chrono::seconds(3);
  check.agreement->R_B_C = so3::exp({0, 0, 1.5}).toRotationMatrix();
  EXPECT_NE(remedy_of(healthy(), {check}, Error, "contradicts the gyro"), "NO SUCH FINDING");
  check.agreement->turning = std::chrono::milliseconds(1800);
  const std::vector<Finding> findings = check_recording({healthy(), true, {check}});
  EXPECT_THAT(remedy_of(findings, Note, "turns for 1.8 s only"), HasSubstr("record more"));
  EXPECT_EQ(std::ranges::count(findings, Error, &Finding::severity), 0);
  check.agreement->R_B_C.setIdentity();
  for (const Finding& f : check_recording({healthy(), true, {check}})) EXPECT_EQ(f.severity, Good) << f.text;
}

TEST(Checks, JudgesARotationBySizeAndSigma) {
  const auto said = [](double degrees, double sigma_deg) {
    CameraCheck check = agreeing();
    check.camera.T_B_C = SE3(so3::exp(Eigen::Vector3d(0.6, 0, -0.8) * degrees * std::numbers::pi / 180), {0, 0, 0});
    check.agreement->rotation_covariance =
        std::pow(sigma_deg * std::numbers::pi / 180, 2) * Eigen::Matrix3d::Identity();
    Severity worst = Good;
    for (const Finding& f : check_recording({healthy(), true, {check}})) worst = std::max(worst, f.severity);
    return worst;
  };
  EXPECT_EQ(said(1, 0.1), Good);
  EXPECT_EQ(said(5, 0.3), Warning);
  EXPECT_EQ(said(5, 3.0), Note) << "neither right nor wrong";
  EXPECT_EQ(said(10, 0.3), Error);
  EXPECT_EQ(said(90, 3.0), Error);
}

TEST(Checks, NeverBlamesTheDirectionOfASmallRotation) {
  for (const double angle : {0.1, -0.1}) {
    CameraCheck check = agreeing();
    check.camera.T_B_C = SE3(so3::exp({0.01, 0, angle}), {0, 0, 0});
    EXPECT_THAT(remedy_of(healthy(), {check}, Warning, "contradicts the gyro by 5.8 deg"),
                HasSubstr("calibrate again"));
  }
}

TEST(Checks, JudgesWhatIsKnownOfARotationAboutOneAxis) {
  CameraCheck check = agreeing();
  check.agreement->rotation_covariance(2, 2) = 0.5;
  check.agreement->R_B_C = so3::exp({0, 0, 1.5}).toRotationMatrix();
  std::vector<Finding> findings = check_recording({healthy(), true, {check}});
  EXPECT_EQ(remedy_of(findings, Note, "about one axis only, (0.00, 0.00, 1.00)"), "");
  EXPECT_EQ(remedy_of(findings, Good, "its rotation agrees with the gyro to 0.0 deg"), "");
  check.agreement->R_B_C = so3::exp({0.2, 0, 0}).toRotationMatrix();
  EXPECT_NE(remedy_of(healthy(), {check}, Error, "contradicts the gyro by 11.5 deg"), "");
}

TEST(Checks, NamesSwappedColumnsAndMirroredAxesAsSuch) {
  RecordingStatistics s = healthy();
  s.imu_details.mean_gyro = 9.9, s.imu_details.max_gyro = 14.0, s.imu_details.mean_accel = 0.4;
  s.imu_details.calm = ImuCalm{.begin = {}, .gyro = {0.3, -0.2, 9.8}, .accel = {0.01, 0, 0}};
  const std::vector<Finding> findings = check_recording({s, false, {}});
  EXPECT_THAT(remedy_of(findings, Error, "gyro and accelerometer are swapped"), HasSubstr("t ax ay az gx gy gz"));
  EXPECT_EQ(std::ranges::count(findings, Error, &Finding::severity), 1) << "no unit is reported beside it";
  CameraCheck check = agreeing();
  check.agreement->mirrored = true;
  EXPECT_THAT(remedy_of(healthy(), {check}, Error, "rotates the other way"), HasSubstr("sign"));
}

TEST(Checks, NamesHotPixelsMissingPolaritiesDarkFramesAndForeignTruth) {
  RecordingStatistics s = healthy();
  s.event_details.hot_share = 0.2, s.event_details.hottest = {{3, 4, 1000}};
  s.event_details.positive_share = 1.0;
  s.mean_brightness = 4;
  s.truth = TruthStatistics{stream(100, 500, 510), "body", 3.0};
  const std::vector<Finding> findings = check_recording({s, false, {}});
  EXPECT_THAT(remedy_of(findings, Warning, "most at (3, 4)"), HasSubstr("mask"));
  EXPECT_THAT(remedy_of(findings, Warning, "100.0 % of the events are positive"), HasSubstr("polarities"));
  EXPECT_THAT(remedy_of(findings, Note, "frames are dark"), HasSubstr("expose"));
  EXPECT_THAT(remedy_of(findings, Warning, "ground truth does not overlap"), HasSubstr("clock"));
}

}  // namespace
}  // namespace edged
