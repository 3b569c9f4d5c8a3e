// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A verdict lists causes, and not what follows from them.
#include "run/verdict.hpp"

#include <gmock/gmock.h>

namespace edged {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Lost once, with a wrong bias, a rotation that the run has corrected, and an estimate that contradicts the truth.
RunSummary doubtful_run() {
  RunSummary run;
  run.run.folder = "runs/1";
  Step step;
  step.state.bias_accel = {2.0, 0.0, 0.0};
  for (const int second : {1, 2, 3}) {
    step.t = timestamp_from_seconds(second);
    step.status = second == 2 ? TrackingStatus::Lost : TrackingStatus::Good;
    run.statistics.add_visual(step.t, step.t);
    run.statistics.add(step);
  }
  run.calibration = {{"frames", 3.0, 0.0, 0.0, false, 0.1, 0.3}};
  run.truth.evaluation.emplace();
  run.truth.evaluation->duration_s = 10.0;
  run.truth.consistency.emplace();
  run.truth.consistency->silent = {{timestamp_from_seconds(1), timestamp_from_seconds(3)}};
  return run;
}

/// The verdict on it, after these findings of the recording.
Verdict verdict_after(std::vector<Finding> findings) {
  RunSummary run = doubtful_run();
  run.verdict.findings = std::move(findings);
  judge_run(run, SourceOptions(), Ending::Complete);
  return run.verdict;
}

std::vector<std::string> texts(const Verdict& verdict) {
  std::vector<std::string> texts;
  for (const Finding& finding : verdict.findings) texts.push_back(finding.text);
  return texts;
}

TEST(Verdict, ListsWhatTheEstimateShows) {
  const Verdict verdict = verdict_after({});
  EXPECT_THAT(texts(verdict),
              ElementsAre(StartsWith("camera frames: its rotation"), StartsWith("lost for 1.0 s"),
                          StartsWith("accelerometer: a bias"), StartsWith("ground truth: the estimate")));
  EXPECT_EQ(verdict.status, "not to be trusted");
}

TEST(Verdict, ListsNothingEstimatedWhereTheRecordingIsWrong) {
  const Verdict verdict = verdict_after({{Severity::Error, "gyro in deg/s", "multiply it"}});
  EXPECT_THAT(texts(verdict), ElementsAre("gyro in deg/s", StartsWith("lost for 1.0 s")));
  EXPECT_EQ(verdict.text, "the result is not to be trusted: gyro in deg/s");
}

TEST(Verdict, JudgesNoCalibrationWhereNothingCanBeCompared) {
  const Verdict verdict = verdict_after({{Severity::Warning, "images repeat", "", Unusable::Calibration}});
  EXPECT_THAT(texts(verdict), ElementsAre("images repeat", StartsWith("lost"), StartsWith("accelerometer: a bias"),
                                          StartsWith("ground truth: the estimate")));
  EXPECT_FALSE(verdict.trusted);
}

TEST(Verdict, JudgesNoEstimateByATruthThatContradictsItself) {
  EXPECT_THAT(texts(verdict_after({{Severity::Warning, "ground truth: 2 jumps", "", Unusable::Truth}})),
              ElementsAre("ground truth: 2 jumps", StartsWith("camera frames"), StartsWith("lost"),
                          StartsWith("accelerometer: a bias")));
}

TEST(Verdict, IsNotExplainedByAWarning) {
  EXPECT_EQ(texts(verdict_after({{Severity::Warning, "IMU at 50 Hz", ""}})).size(), 5U);
}

TEST(Verdict, CallsALensCorrectedOnlyWhereARunCanCorrectIt) {
  for (const auto& [off_percent, severity, remedy] :
       {std::tuple(2.4, Severity::Warning, "the run has corrected"), {4.0, Severity::Error, "more than a run can"}}) {
    RunSummary run = doubtful_run();
    run.calibration = {{"frames", 0.0, 0.0, 0.0, false, 0.1, 0.3}};
    run.calibration.front().corrections = {{"fx_percent", off_percent, 0.14, 0.4}};
    judge_run(run, SourceOptions(), Ending::Complete);
    EXPECT_THAT(run.verdict.findings.front().text, StartsWith("camera frames: differs from the calibration by fx"));
    EXPECT_THAT(run.verdict.findings.front().remedy, StartsWith(remedy));
    EXPECT_EQ(run.verdict.findings.front().severity, severity);
  }
}

TEST(Verdict, TheScaleIsJudgedByTheOptionOfTheRun) {
  Step step;
  step.status = TrackingStatus::Good;
  const Eigen::Matrix3d none = Eigen::Matrix3d::Zero();
  step.covariance = {none, none, Eigen::Vector3d(0.05 * 0.05, 0.0, 0.0).asDiagonal()};
  step.state.v_W = {0.2, 0.0, 0.0};
  for (const double most : {0.2, 0.3}) {
    RunSummary summary;
    summary.run.max_scale_sigma = most;
    for (int i = 0; i < 40; ++i) {
      step.t = timestamp_from_seconds(0.1 * i);
      summary.statistics.add(step);
    }
    judge_run(summary, {}, Ending::Complete);
    EXPECT_EQ(summary.verdict.trusted, most > 0.25) << summary.verdict.text;
    if (most < 0.25) {
      EXPECT_THAT(summary.verdict.text, HasSubstr("scale: known to 25 %"));
    }
  }
}

}  // namespace
}  // namespace edged
