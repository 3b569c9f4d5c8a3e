// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/files.hpp"
#include "common/step_numbers.hpp"
#include "edged/camera/field_of_view.hpp"
#include "edged/core/check.hpp"
#include "edged/io/test_support.hpp"
#include "outputs/states.hpp"
#include "report/states_table.hpp"
#include "run/estimated_calibration.hpp"
#include "run/run_summary.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;

class RunFolder : public ::testing::Test {
 protected:
  void touch(const char* name) { std::ofstream(folder / name) << "x"; }

  std::vector<std::string> lines(const char* name) {
    std::ifstream in(folder / name);
    std::vector<std::string> result;
    for (std::string line; std::getline(in, line);) result.push_back(line);
    return result;
  }

  const TempFolder temp;
  const fs::path folder = temp.path() / "run";  ///< not there yet
};

TrackingStatus status_of_step(int i) {
  if (i == 9) return TrackingStatus::Lost;
  return i < 3 ? TrackingStatus::Initializing : TrackingStatus::Good;
}

TEST_F(RunFolder, IsMadeWithItsParents) {
  make_run_folder(folder / "a" / "b");
  EXPECT_TRUE(fs::is_directory(folder / "a" / "b"));
}

TEST_F(RunFolder, RefusesAFolderThatHoldsOtherThings) {
  fs::create_directories(folder);
  touch("thesis.tex");
  EXPECT_THROW(make_run_folder(folder), InputError);
  EXPECT_THROW(make_run_folder(folder / "thesis.tex"), InputError);
  EXPECT_TRUE(fs::exists(folder / "thesis.tex"));
}

TEST_F(RunFolder, KeepsEarlierRunsAndTakesTheFirstFreeNumber) {
  EXPECT_EQ(make_run_folder(folder / "run"), folder / "run");
  EXPECT_EQ(make_run_folder(folder / "run"), folder / "run-2");
  fs::create_directories(folder / "run-3");
  std::ofstream(folder / "run-3" / "thesis.tex") << "x";
  EXPECT_EQ(make_run_folder(folder / "run/"), folder / "run-4");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "run-3"), {}), 1);
}

TEST_F(RunFolder, SaysWhyANameCannotBeUsed) {
  EXPECT_THROW(make_run_folder(folder / std::string(300, 'x')), InputError);
  EXPECT_THROW(make_run_folder("/dev/null/run"), InputError);
}

TEST_F(RunFolder, ReplacesAnEarlierRunAndNothingElseWhereAskedTo) {
  fs::create_directories(folder);
  touch("config_resolved.yaml");
  touch("metrics.json");
  touch("notes.txt");
  EXPECT_EQ(make_run_folder(folder, EarlierRun::Replace, {"metrics.json"}), folder);
  EXPECT_FALSE(fs::exists(folder / "metrics.json"));
  EXPECT_TRUE(fs::exists(folder / "notes.txt"));
}

TEST_F(RunFolder, HoldsPosesOfGoodAndDegradedPacketsAndALineForEveryPacket) {
  make_run_folder(folder);
  {
    RunWriter writer(folder, "body", {"first comment"});
    Step step;
    for (const TrackingStatus status :
         {TrackingStatus::Initializing, TrackingStatus::Good, TrackingStatus::Degraded, TrackingStatus::Lost}) {
      step.status = status;
      if (status == TrackingStatus::Degraded) step.ln_depth_scale = LogScale{0.1, 0.2};
      step.t = timestamp_from_seconds(1.0 + static_cast<double>(writer.poses()));
      writer.add(step);
    }
    EXPECT_EQ(writer.poses(), 2u);
  }
  EXPECT_EQ(read_tum(folder / "trajectory.tum").size(), 2u);
  EXPECT_EQ(read_poses(folder / "trajectory_euroc.csv", euroc_table()).size(), 2u);
  EXPECT_EQ(lines("trajectory.kitti"), std::vector<std::string>(2, "1 0 0 0 0 1 0 0 0 0 1 0"));
  EXPECT_EQ(lines("trajectory.tum")[0], "# first comment");
  const std::vector<std::string> states = lines("states.csv");
  ASSERT_EQ(states.size(), 6u);  // comment, names, four packets
  const auto columns = [](const std::string& line) { return std::count(line.begin(), line.end(), ','); };
  for (std::size_t i = 2; i < states.size(); ++i) EXPECT_EQ(columns(states[i]), columns(states[1])) << states[i];
}

TEST_F(RunFolder, HasTheAttitudeWhereThereIsNoPose) {
  make_run_folder(folder);
  Step step;
  step.attitude = {so3::exp({0.1, 0.2, 0.3}), 1e-4 * Eigen::Matrix3d::Identity()};
  {
    RunWriter writer(folder, "body", {});
    writer.add(step);
  }
  const StatesTable states = read_states(folder);
  EXPECT_TRUE(body_poses(states).empty());
  EXPECT_TRUE(std::isnan(states.find("px_m")->at(0)));
  EXPECT_EQ(states.find("qw")->at(0), step.attitude->R_W_B.w());
  EXPECT_EQ(states.find("r_zz_rad2")->at(0), 1e-4);
}

TEST_F(RunFolder, GivesTheBodysPosesBack) {
  make_run_folder(folder);
  Trajectory written;
  {
    RunWriter writer(folder, "body", {});
    Step step;
    for (int i = 0; i < 20; ++i) {
      step.relocalized = i == 12;
      step.status = status_of_step(i);
      step.state.T_W_B = SE3(so3::exp({0.1 * i, 0.3, -0.2 * i}), Eigen::Vector3d(i / 3.0, 1e-7 * i, -7.0));
      step.t = timestamp_from_seconds(1e9 + i / 7.0);
      writer.add(step);
      if (step.status == TrackingStatus::Good) written.push_back({step.t, step.state.T_W_B});
    }
  }
  const Trajectory read = body_poses(read_states(folder));
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].t, written[i].t);
    EXPECT_EQ(read[i].T.translation(), written[i].T.translation());
    EXPECT_LT(so3::log(read[i].T.rotation().conjugate() * written[i].T.rotation()).norm(), 1e-15);
  }
}

TEST_F(RunFolder, HasAHeadingThatReadsBeforeAnyPacketHasCome) {
  make_run_folder(folder);
  const RunWriter writer(folder, "body", {});
  EXPECT_TRUE(read_states(folder).t.empty());
}

TEST_F(RunFolder, GivesThePaceOfEachPacketBackButOfThoseThatAKillHasCut) {
  make_run_folder(folder);
  {
    RunWriter writer(folder, "body", {});
    TableFile pace(folder / "pace.csv", pace_heading());
    Step step;
    for (int i = 0; i < 3; ++i) {
      step.t = timestamp_from_seconds(i);
      writer.add(step);
      if (i < 2) pace.add(pace_line(step.t, {1.5 + i, i == 1 ? std::optional(20.0) : std::nullopt}));
    }
  }
  StatesTable states = read_states(folder);
  read_pace(folder, states);
  const std::vector<double>& processing = *states.find("processing_ms");
  EXPECT_EQ(processing[1], 2.5);
  EXPECT_TRUE(std::isnan(processing[2]));
  EXPECT_TRUE(std::isnan((*states.find("latency_ms"))[0]));
  EXPECT_EQ((*states.find("latency_ms"))[1], 20.0);
}

TEST_F(RunFolder, SaysHowFarBackTheMapReaches) {
  Step step;
  step.t = timestamp_from_seconds(10);
  EXPECT_FALSE(map_reach_s(step));
  for (const int keyframe_s : {8, 3, 9})
    step.map_matches.push_back({timestamp_from_seconds(keyframe_s), Eigen::Vector2d::Zero(), Eigen::Vector3d::Zero()});
  EXPECT_EQ(map_reach_s(step), 7.0);
}

TEST_F(RunFolder, GivesTheCovariancesBack) {
  make_run_folder(folder);
  CovarianceSamples samples;
  {
    RunWriter writer(folder, "body", {});
    Step step;
    for (int i = 0; i < 20; ++i) {
      step.relocalized = i == 12;
      step.status = status_of_step(i);
      step.covariance.reset();
      Eigen::Matrix3d P;
      P << 1.0, 0.1, 0.2, 0.1, 2.0 + i, 0.3, 0.2, 0.3, 3.0 / 7.0;
      if (i > 4 && i != 9) step.covariance = {P, 0.1 * P, 0.2 * P};
      if (i % 3 == 0) step.ln_depth_scale = LogScale{0.1, 0.2};
      step.t = timestamp_from_seconds(i / 7.0);
      writer.add(step);
      samples.add(step);
    }
  }
  const std::vector<StateCovarianceSample> read = covariance_samples_of(read_states(folder));
  ASSERT_EQ(read.size(), 14u);
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].t, samples.all()[i].t);
    EXPECT_EQ(read[i].reference, samples.all()[i].reference);
    EXPECT_EQ(read[i].covariance.position, samples.all()[i].covariance.position);
    EXPECT_EQ(read[i].covariance.rotation, samples.all()[i].covariance.rotation);
    EXPECT_EQ(read[i].covariance.velocity, samples.all()[i].covariance.velocity);
  }
}

TEST(TimingJson, ListsEveryStage) {
  StageTimings pipeline, program;
  { const auto scope = pipeline.measure("warp"); }
  { const auto scope = program.measure_often("read"); }
  const auto json = nlohmann::json::parse(timing_json(pipeline, program));
  ASSERT_EQ(json["stages"].size(), 2u);
  EXPECT_EQ(json["stages"][0]["stage"], "read");
  EXPECT_EQ(json["stages"][1]["count"], 1);
  for (const char* key : {"mean_ms", "p50_ms", "p95_ms", "p99_ms", "total_s"})
    EXPECT_TRUE(json["stages"][1].contains(key));
  EXPECT_FALSE(json["stages"][0].contains("cpu_s"));
  EXPECT_TRUE(json["stages"][1].contains("cpu_s"));
}

}  // namespace
}  // namespace edged
