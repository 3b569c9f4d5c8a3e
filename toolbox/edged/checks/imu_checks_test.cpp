// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Findings about the IMU and its clock.
#include <gmock/gmock.h>

#include "edged/checks/checks.hpp"
#include "edged/checks/checks_test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;
using enum Severity;

TEST(Checks, NamesNoiseFarFromThatAtRestWithBothValues) {
  RecordingStatistics s = healthy();
  s.imu_details.rest = ImuRest{timestamp_from_seconds(1), std::chrono::seconds(2), 1e-4, 2e-3};
  const auto said = [&s](double gyro, double accel) {
    CheckInput input{s, false};
    input.noise.emplace();
    input.noise->gyro_noise = gyro, input.noise->accel_noise = accel;
    return check_recording(input);
  };
  EXPECT_THAT(remedy_of(said(0.1, 2e-3), Error, "gyro: calibrated noise of 0.1 rad/s/sqrt(Hz), but 0.0001 at rest"),
              HasSubstr("density"));
  EXPECT_NE(remedy_of(said(1e-4, 0.1), Warning, "accelerometer: calibrated noise of 0.1 m/s^2"), "NO SUCH FINDING");
  EXPECT_NE(remedy_of(said(1e-7, 2e-6), Warning, "accelerometer: calibrated noise of 2e-06"), "NO SUCH FINDING");
  for (const Finding& f : said(1e-3, 4e-4)) EXPECT_LE(f.severity, Note) << f.text;
}

TEST(Checks, NamesAnAccelerometerThatDoesNotReadGravityAtRest) {
  RecordingStatistics s = healthy();
  s.imu_details.rest = ImuRest{timestamp_from_seconds(1), std::chrono::seconds(2),        1e-4, 2e-3,
                               Eigen::Vector3d::Zero(),   Eigen::Vector3d(0.1, 0.0, 10.2)};
  EXPECT_THAT(remedy_of(s, {}, Warning, "accelerometer: it reads 10.20 m/s^2 at rest, for 2.0 s from 1.000 s on"),
              HasSubstr("a scale 4.0 % too large"));
  s.imu_details.rest->accel.z() = 9.7;
  EXPECT_EQ(remedy_of(s, {}, Warning, "accelerometer: it reads"), "NO SUCH FINDING");
}

TEST(Checks, NamesAnImuThatEndsBeforeTheCameras) {
  RecordingStatistics s = healthy();
  EXPECT_EQ(remedy_of(s, {}, Warning, "all sensors together cover"), "NO SUCH FINDING");
  s.imu.end = *s.imu.end - std::chrono::seconds(2);
  EXPECT_THAT(remedy_of(s, {}, Warning, "all sensors together cover"), HasSubstr("not used"));
}

TEST(Checks, NamesAMissingSlowOrHolyImu) {
  RecordingStatistics s = healthy();
  s.imu = {};
  EXPECT_THAT(remedy_of(s, {}, Error, "no IMU samples"), HasSubstr("--topic imu"));
  s = healthy();
  s.imu = stream(300, 0, 10);
  EXPECT_THAT(remedy_of(s, {}, Warning, "IMU at 30 Hz"), HasSubstr("200 Hz"));
  s = healthy();
  s.imu.gaps = 2, s.imu.missing = std::chrono::milliseconds(700);
  s.imu.longest = {{timestamp_from_seconds(3), std::chrono::milliseconds(600)}};
  EXPECT_THAT(remedy_of(s, {}, Error, "longest 0.600 s at 3.000 s"), HasSubstr("USB"));
}

TEST(Checks, NamesRefusedImuSamplesAndNotTheGapTheyLeave) {
  RecordingStatistics s = healthy();
  s.imu.gaps = 1, s.imu.missing = std::chrono::milliseconds(600);
  s.imu.longest = {{timestamp_from_seconds(3), s.imu.missing}};
  s.imu_faults[ImuFault::Repeated] = {120, timestamp_from_seconds(3), std::chrono::milliseconds(595), 0b111};
  const std::vector<Finding> findings = check_recording({s, false});
  EXPECT_THAT(remedy_of(findings, Error, "120 IMU samples that repeat a reading: gyro for 0.595 s from 3.000 s"),
              HasSubstr("driver repeats"));
  EXPECT_EQ(remedy_of(findings, Error, "IMU gaps"), "NO SUCH FINDING");
  s.imu.missing += std::chrono::seconds(1);
  EXPECT_THAT(remedy_of(s, {}, Error, "IMU gaps"), HasSubstr("USB"));
}

TEST(Checks, NamesAnImuWhoseClockRunsAtAnotherRateAndNoCalibration) {
  CameraCheck check = agreeing();
  check.camera.T_B_C = SE3(so3::exp({0, 0, -1.5}), {0, 0, 0});
  check.clock = ClockRate{2.0, 0.99};
  RecordingStatistics s = healthy();
  s.imu = stream(2000, 0, 20);
  const std::vector<Finding> findings = check_recording({s, true, {check}});
  EXPECT_THAT(
      remedy_of(findings, Error, "the IMU covers 20.0 s, the other sensors 10.0 s: its clock runs at 2.00 times"),
      HasSubstr("--imu-clock-rate 2.000"));
  EXPECT_EQ(std::ranges::count(findings, Error, &Finding::severity), 1) << "no camera is blamed beside it";
  check.clock = ClockRate{1.02, 0.99};
  s.imu = stream(2000, 0, 10.2);
  EXPECT_THAT(remedy_of(s, {check}, Error, "the IMU's clock runs at 1.020 times"), HasSubstr("--imu-clock-rate 1.020"));
}

TEST(Checks, BelievesNoOtherClockWhereACameraTurnsAsCalibrated) {
  CameraCheck short_one = agreeing();
  short_one.clock = ClockRate{2.11, 0.95};
  for (const Finding& f : check_recording({healthy(), true, {agreeing(), short_one}}))
    EXPECT_EQ(f.severity, Good) << f.text;
}

TEST(Checks, NamesAnotherClockOrUnitByTheLengthsWhereNoCameraTells) {
  RecordingStatistics s = healthy();
  s.imu = stream(2000, 0, 5);
  EXPECT_THAT(remedy_of(s, {}, Error, "its clock runs at 0.5 times theirs"), HasSubstr("--imu-clock-rate 0.5"));
  s.imu = stream(2000, 0, 10'000);
  EXPECT_THAT(remedy_of(s, {}, Error, "its stamps are in another unit"), HasSubstr("unit"));
  s.imu = stream(2000, 5, 25);
  EXPECT_EQ(remedy_of(s, {}, Error, "clock"), "NO SUCH FINDING") << "it began later";
}

TEST(Checks, NamesADeadGyroAndNoCamera) {
  RecordingStatistics s = healthy();
  CameraCheck check = agreeing();
  check.camera.T_B_C = SE3(so3::exp({0, 0, -1.5}), {0, 0, 0});
  FrozenReadings& gyro = s.imu_details.gyro_frozen;
  gyro.covered = gyro.longest = std::chrono::seconds(10);
  gyro.axes.fill(gyro.covered);
  EXPECT_THAT(remedy_of(s, {check}, Error, "gyro is constant zero"), HasSubstr("topic"));
  EXPECT_EQ(remedy_of(s, {check}, Error, "camera"), "NO SUCH FINDING");
  gyro.value = {0.1, 0, 0};
  EXPECT_THAT(remedy_of(s, {}, Error, "gyro does not change: it is (0.1, 0, 0) rad/s"), HasSubstr("driver"));
  gyro.longest = std::chrono::seconds(3), gyro.axes = {Duration(3), Duration(3), gyro.covered};
  EXPECT_THAT(remedy_of(s, {}, Error, "gyro: its z axis does not change"), HasSubstr("columns"));
  EXPECT_THAT(remedy_of(s, {}, Error, "gyro does not change for 3.0 s"), HasSubstr("gap"));
}

}  // namespace
}  // namespace edged
