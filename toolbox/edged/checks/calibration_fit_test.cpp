// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Calibrations that fit, that do not fit, and undetermined ones, each with its reason.
#include "edged/checks/calibration_fit.hpp"

#include <gmock/gmock.h>

namespace edged {
namespace {

using ::testing::HasSubstr;

CalibrationFound found(double rotation_deg, double clock_ms, double given_ms = 0.0) {
  return {"events", rotation_deg, clock_ms, given_ms, false, 0.1, 0.3};
}

CameraFit fit_of(const CalibrationFound& c, const std::vector<Finding>& findings = {}) {
  return judge_fit({c}, findings, "").cameras.at(0);
}

TEST(CalibFit, FitsWithinWhatCalibrationsAreGoodFor) {
  const CalibrationFit fit = judge_fit({found(0.4, 1.0), found(0.4, 3.0, 2.4)}, {}, "");
  EXPECT_EQ(fit.fit, Fit::Fits);
  for (const CameraFit& camera : fit.cameras) EXPECT_EQ(camera.fit, Fit::Fits) << camera.why;
}

TEST(CalibFit, ClockThatIsOffSaysWhatToWrite) {
  const CameraFit fit = fit_of(found(0.2, 7.6, 2.4));
  EXPECT_EQ(fit.fit, Fit::DoesNotFit);
  EXPECT_EQ(fit.why, "its clock is 5.2 ms +- 0.3 ms off; write `time_offset: 0.0076`");
}

TEST(CalibFit, RotationThatIsOffSaysWhatToDo) {
  EXPECT_THAT(fit_of(found(3.0, 0.0)).why, HasSubstr("its rotation to the IMU is 3.0 deg +- 0.1 deg off; --out FILE"));
  CalibrationFound far = found(5.0, -6.0);
  far.beyond = true;
  EXPECT_THAT(fit_of(far).why, HasSubstr("write `time_offset: -0.0060`, and its rotation to the IMU is 5.0 deg"));
  EXPECT_THAT(fit_of(far).why, HasSubstr("calibrate camera and IMU again"));
}

TEST(CalibFit, RotationWhoseInverseFitsIsToBeTurnedRound) {
  CalibrationFound turned = found(2.0, 0.0);
  turned.inverse = true;
  EXPECT_THAT(fit_of(turned).why, HasSubstr("2.0 deg +- 0.1 deg off; its inverse fits"));
  EXPECT_THAT(fit_of(turned).why, HasSubstr("T_C_B"));
}

TEST(CalibFit, WhatIsNotKnownIsNotJudged) {
  CalibrationFound vague = found(1.5, 4.0);
  vague.rotation_sigma_deg = 1.8, vague.time_sigma_ms = 9.0;
  EXPECT_EQ(fit_of(vague).fit, Fit::CannotBeTold);
  EXPECT_THAT(fit_of(vague).why, HasSubstr("too little motion"));
  CalibrationFound nothing = found(0.0, 0.0);
  nothing.rotation_sigma_deg = nothing.time_sigma_ms = std::nullopt;
  const CalibrationFit fit = judge_fit({nothing}, {}, "rest (0.3 of 0.7 s)");
  EXPECT_EQ(fit.fit, Fit::CannotBeTold);
  EXPECT_EQ(fit.cameras.at(0).why, "no estimate, as it waited for rest (0.3 of 0.7 s)");
  EXPECT_THAT(fit.why, HasSubstr("turn the sensor about all axes"));
}

TEST(CalibFit, FindingsCountAgainstTheirCameraOrAgainstAll) {
  const Finding size{Severity::Error, "camera events: calibrated for 240 x 180 px, recorded 346 x 260",
                     "choose another"};
  EXPECT_EQ(fit_of(found(0.1, 0.1), {size}).why, "calibrated for 240 x 180 px, recorded 346 x 260; choose another");
  EXPECT_EQ(judge_fit({found(0.1, 0.1)}, {size}, "").why, "see events");
  const CalibrationFit unit =
      judge_fit({found(0.1, 0.1)}, {{Severity::Error, "accelerometer in g: its mean is 1.00", "multiply it"}}, "");
  EXPECT_EQ(unit.cameras.at(0).fit, Fit::Fits);
  EXPECT_EQ(unit.fit, Fit::DoesNotFit);
  EXPECT_EQ(unit.why, "accelerometer in g: its mean is 1.00; multiply it");
  EXPECT_EQ(judge_fit({found(0.1, 0.1)}, {{Severity::Warning, "IMU at 50 Hz", "record faster"}}, "").fit, Fit::Fits);
}

TEST(CalibFit, NoEstimateOfAnUnusableRecordingIsJudged) {
  const std::vector<Finding> repeated{
      {Severity::Warning, "67 % of the frames repeat", "leave them out", Unusable::Calibration}};
  const CalibrationFit fit = judge_fit({found(3.0, 10.0)}, repeated, "");
  EXPECT_EQ(fit.fit, Fit::CannotBeTold);
  EXPECT_EQ(fit.cameras.at(0).why, "67 % of the frames repeat; leave them out");
  EXPECT_EQ(fit.why, "see events");
}

}  // namespace
}  // namespace edged
