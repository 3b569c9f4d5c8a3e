// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "common/config_source.hpp"
#include "common/files.hpp"
#include "common/json_text.hpp"
#include "edged/core/check.hpp"
#include "edged/io/calibration.hpp"
#include "edged/io/test_support.hpp"
#include "outputs/snapshots.hpp"
#include "outputs/states.hpp"
#include "report/point_cloud.hpp"
#include "report/report_data.hpp"
#include "report/report_page.hpp"
#include "report/report_rows.hpp"
#include "run/estimated_calibration.hpp"
#include "run/run_folder.hpp"
#include "run/run_summary.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;

/// The json that a browser finds in the page.
nlohmann::json data_of(const std::string& page) {
  const std::string begin = "id=\"data\">", end = "</script>";
  const std::size_t from = page.find(begin) + begin.size();
  return nlohmann::json::parse(page.substr(from, page.find(end, from) - from));
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

class Report : public ::testing::Test {
 protected:
  /// A run folder of `edged run`, with a circle 1 % too large.
  fs::path make_run(const std::string& name, bool with_truth, int steps = 200) {
    const fs::path folder = top / name;
    make_run_folder(folder);
    Calibration calibration;
    calibration.rig = Rig{"head", {{"events", Modality::Events, CameraModel(240, 180, 200, 200, 120, 90), SE3(), {}}}};
    RunWriter writer(folder, "events", {});
    GroundTruth truth{{}, "events"};
    for (int i = 0; i < steps; ++i) {
      Step step = step_at(i);
      step.rig = calibration.rig;
      const Eigen::Vector3d p = step.state.T_W_B.translation() / 1.01 + Eigen::Vector3d(1.0, 2.0, 3.0);
      truth.trajectory.push_back({step.t, SE3(step.state.T_W_B.rotation(), p)});
      writer.add(step);
      snapshots.add(step);
    }
    RunSummary summary;
    summary.run.recording = name;
    summary.run.mode = summary.run.frame = "events";
    summary.verdict.status = "good";
    const StatesTable states = read_states(folder);
    const OutputFrame frame(calibration.rig, "events");
    const CausalPoses poses = causal_poses(folder, states, "events", frame);
    if (with_truth) summary.truth = compare_with_truth(poses, covariance_samples_of(states), frame, truth);
    write_file(folder / "calibration.yaml", to_yaml(calibration));
    write_file(folder / "config_resolved.yaml", options_with_one_changed());
    write_file(folder / "metrics.json", json_text(to_json(summary)));
    Rig found = calibration.rig;
    found.cameras[0].time_offset = std::chrono::milliseconds(3);
    write_file(folder / "calibration_found.yaml", to_yaml(with_estimated(calibration, found)));
    if (with_truth) write_tum(folder / "groundtruth.tum", snapshots.part_of_run(truth.trajectory));
    write_file(folder / "album.json", snapshots.to_json(with_truth ? "events" : "", std::nullopt).dump());
    return folder;
  }

  static std::string options_with_one_changed() {
    RunConfig config;
    ConfigFields fields = ConfigFields::of(config);
    fields.set("packets.max_interval_s=0.033");
    return fields.to_yaml();
  }

  static Step step_at(int i) {
    Step step;
    step.t = timestamp_from_seconds(100.0 + 0.05 * i);
    step.status = i < 10 ? TrackingStatus::Initializing : i == 50 ? TrackingStatus::Lost : TrackingStatus::Good;
    if (i < 10) step.waiting_for = "parallax, 3 px of 10";
    if (i == 50) step.lost_because = "no landmark for 2.5 s";
    const double a = 0.03 * i;
    step.state.T_W_B = SE3(so3::exp({0.0, 0.0, a}), Eigen::Vector3d(std::cos(a), std::sin(a), 0.1 * a));
    step.keyframe = i % 5 == 0;
    step.relocalized = i == 60;
    if (i == 60) step.map_matches = {{timestamp_from_seconds(100.0), Eigen::Vector2d::Zero(), Eigen::Vector3d::Zero()}};
    step.landmarks = {{static_cast<FeatureId>(i), Eigen::Vector3d(3.0, i, 0.0)}};
    step.cameras = {{.name = "events",
                     .modality = Modality::Events,
                     .image = cv::Mat(180, 240, CV_8UC1, cv::Scalar(i % 256)),
                     .survival_rate = 0.9}};
    if (i >= 10)
      step.covariance = StateCovariance{1e-4 * Eigen::Matrix3d::Identity(), 1e-4 * Eigen::Matrix3d::Identity(),
                                        1e-4 * Eigen::Matrix3d::Identity()};
    return step;
  }

  const TempFolder temp;
  const fs::path top = temp.path();
  Snapshots snapshots;
};

TEST_F(Report, HoldsTheNumbersOfTheRun) {
  const fs::path folder = make_run("circle", true);
  const auto page = report_page(report_data({folder}));
  const nlohmann::json run = data_of(page)["runs"][0];
  const nlohmann::json metrics = nlohmann::json::parse(std::ifstream(folder / "metrics.json"));
  EXPECT_EQ(run["metrics"], metrics);
  ASSERT_GT(metrics["ate_rmse_m"].get<double>(), 1e-3);
  EXPECT_EQ(run["evaluation"]["ate_rmse_m"], metrics["ate_rmse_m"]);
  EXPECT_EQ(run["evaluation"]["path_length_m"], metrics["evaluation"]["path_length_m"]);
  double squares = 0.0;
  int errors = 0;
  for (const auto& e : run["rows"]["error_m"]) {
    if (e.is_null()) continue;
    squares += e.get<double>() * e.get<double>();
    ++errors;
  }
  EXPECT_EQ(errors, 189);
  EXPECT_NEAR(std::sqrt(squares / errors), metrics["ate_rmse_m"].get<double>(), 1e-5);  // all rows are there
  EXPECT_EQ(run["pose_errors"]["t"].size(), metrics["consistency"]["poses"].get<std::size_t>());
}

TEST_F(Report, TellsHealthAndWhatTheMapFoundAgain) {
  const nlohmann::json run = report_data({make_run("circle", false)})["runs"][0];
  EXPECT_EQ(run["rows"]["event_track_survival_rate"][20], 0.9);
  EXPECT_EQ(run["rows"]["frame_track_survival_rate"][20], nullptr);
  EXPECT_EQ(run["rows"]["map_matches"][59], nullptr);
  EXPECT_EQ(run["rows"]["map_matches"][60], 1);
  EXPECT_EQ(run["rows"]["map_reach"][60], 3.0);
  const auto& changes = run["changes"];
  const auto again = std::ranges::find_if(changes, [](const auto& change) { return change["relocalized"] == true; });
  ASSERT_NE(again, changes.end());
  EXPECT_EQ((*again)["t"], 3.0);
  EXPECT_EQ((*again)["reason"], "relocalized in the map");
}

TEST_F(Report, LaysTheFinalPathOntoTheTruthAsTheCausalOneIs) {
  const fs::path folder = make_run("circle", true);
  EXPECT_TRUE(report_data({folder})["runs"][0]["final"].empty()) << "of an earlier version";
  fs::copy_file(folder / "trajectory.tum", folder / "trajectory_final.tum");
  const nlohmann::json run = report_data({folder})["runs"][0];
  const nlohmann::json &rows = run["rows"], &path = run["final"];
  ASSERT_EQ(path.size(), 3 * 189u);
  std::size_t pose = 0;
  for (std::size_t i = 0; i < rows["x"].size(); ++i) {
    if (rows["x"][i].is_null()) continue;
    EXPECT_NEAR(path[3 * pose].get<double>(), rows["x"][i].get<double>(), 1e-4);
    EXPECT_NEAR(path[3 * pose + 2].get<double>(), rows["z"][i].get<double>(), 1e-4);
    ++pose;
  }
}

TEST_F(Report, SaysWhyTheStatusChangedWhatWasSetAndWhatTheCalibrationWasFoundToBe) {
  const nlohmann::json run = report_data({make_run("circle", true)})["runs"][0];
  ASSERT_EQ(run["changes"].size(), 5u);
  EXPECT_EQ(run["changes"][0]["reason"], "waits for parallax, 3 px of 10");
  EXPECT_EQ(run["changes"][2]["status"], "Lost");
  EXPECT_EQ(run["changes"][2]["reason"], "no landmark for 2.5 s");
  EXPECT_DOUBLE_EQ(run["changes"][2]["t"].get<double>(), 2.5);
  ASSERT_EQ(run["options"].size(), 1u);
  EXPECT_EQ(run["options"][0]["key"], "packets.max_interval_s");
  EXPECT_EQ(run["options"][0]["value"], "0.033");
  EXPECT_EQ(run["calibration"][0]["before"]["time_offset_ms"], 0.0);
  EXPECT_EQ(run["calibration"][0]["after"]["time_offset_ms"], 3.0);
}

TEST_F(Report, OfARunWithoutTruthHasNoErrors) {
  const fs::path folder = make_run("circle", false);
  write_run_report(folder);
  ASSERT_TRUE(fs::exists(folder / "report.html"));
  const nlohmann::json run = report_data({folder})["runs"][0];
  EXPECT_TRUE(run["evaluation"].is_null());
  EXPECT_FALSE(run["rows"].contains("error_m"));
  EXPECT_TRUE(run["pose_errors"].empty());
  EXPECT_NEAR(run["path_m"].get<double>(), 0.03 * std::hypot(1.0, 0.1) * 189, 0.01);
  EXPECT_FALSE(run["rows"]["sigma3_x"].empty());
}

TEST_F(Report, NoNameBreaksOutOfItsScript) {
  const std::string name = "a</script><script>alert(1)<!--{{css}}";
  const fs::path folder = make_run("circle", false);
  nlohmann::json metrics = nlohmann::json::parse(std::ifstream(folder / "metrics.json"));
  metrics["recording"] = name;
  write_file(folder / "metrics.json", metrics.dump());
  const std::string page = report_page(report_data({folder}));
  EXPECT_EQ(count(page, "</script>"), 2u);
  EXPECT_EQ(data_of(page)["runs"][0]["metrics"]["recording"], name);
}

TEST_F(Report, ShowsRunsAndTrajectoryFilesSideBySide) {
  const fs::path a = make_run("a", true), b = make_run("b", false);
  const fs::path own = a / "own.tum";
  std::ofstream(own) << "# edged 0.2.0, recording r, mode fused\n" << std::ifstream(a / "trajectory.tum").rdbuf();
  const nlohmann::json runs = report_data({a, b, a / "trajectory.tum", own})["runs"];
  ASSERT_EQ(runs.size(), 4u);
  EXPECT_TRUE(runs[3]["is_file"] && runs[3]["by_edged"]);
  EXPECT_EQ(runs[0]["name"], "a");
  EXPECT_EQ(runs[1]["rows"]["t"], runs[0]["rows"]["t"]);
  EXPECT_TRUE(runs[1]["evaluation"].is_null());
  EXPECT_TRUE(runs[2]["is_file"] && !runs[2]["by_edged"]);
  // It is compared with the truth of the runs beside it.
  EXPECT_TRUE(runs[2]["metrics"].is_null());
  EXPECT_NEAR(runs[2]["evaluation"]["ate_rmse_m"].get<double>(), runs[0]["metrics"]["ate_rmse_m"].get<double>(), 1e-9);
}

TEST_F(Report, AnotherTruthAndAlignmentCount) {
  const fs::path folder = make_run("circle", false);
  ReportOptions options;
  options.truth = make_run("true", true) / "groundtruth.tum";
  options.how.align = "sim3";
  const nlohmann::json run = report_data({folder}, options)["runs"][0];
  EXPECT_LT(run["evaluation"]["ate_rmse_m"].get<double>(), 1e-6);
  EXPECT_NEAR(run["evaluation"]["scale"].get<double>(), 1.0 / 1.01, 1e-6);
}

TEST_F(Report, StaysSmallHoweverLongTheRun) {
  const fs::path folder = make_run("long", true, 12000);
  const nlohmann::json run = report_data({folder})["runs"][0];
  EXPECT_LE(run["rows"]["t"].size(), 3020u);
  EXPECT_LE(run["pictures"].size(), Snapshots::kMostPictures);
  EXPECT_GE(run["pictures"].size(), Snapshots::kMostPictures / 2);
  EXPECT_LE(run["map"].size(), 3 * Snapshots::kMostPoints);
  const auto& status = run["rows"]["status"];
  EXPECT_EQ(std::count(status.begin(), status.end(), "Lost"), 1);  // of one row in four
  const nlohmann::json twice = report_data({folder, folder});
  EXPECT_LT(report_page(twice).size(), 5u << 20);
  EXPECT_TRUE(twice["runs"][1]["trajectories"]["trajectory.tum"].is_null());
  EXPECT_FALSE(run["trajectories"]["trajectory.tum"].is_null());
}

TEST_F(Report, HoldsTheTrajectoriesAsTheFilesAre) {
  const fs::path folder = make_run("circle", false);
  write_file(folder / "trajectory_final.tum", "1 2 3 4 0 0 0 1\n");
  const nlohmann::json held = report_data({folder})["runs"][0]["trajectories"];
  EXPECT_EQ(held["trajectory.tum"].get<std::string>(), read_text(folder / "trajectory.tum"));
  EXPECT_EQ(held["trajectory_final.tum"], "1 2 3 4 0 0 0 1\n");
  EXPECT_TRUE(report_data({folder, folder / "trajectory.tum"})["runs"][1]["trajectories"].empty()) << "of a file";
}

TEST(ReportRows, AreBoundedThoughTheStatusFlutters) {
  StatesTable states;
  for (int i = 0; i < 5000; ++i) {
    states.t.push_back(timestamp_from_seconds(i));
    states.status.push_back(i % 2 == 0 ? TrackingStatus::Good : TrackingStatus::Degraded);
  }
  std::vector<double> error(5000, 0.1);
  error[3333] = 0.2;
  const std::vector<std::size_t> rows = chosen_rows(states, error, 100);
  EXPECT_LE(rows.size(), 101u);
  EXPECT_TRUE(std::ranges::count(rows, 3333u) == 1);
  EXPECT_EQ(changes_json(states, {}, states.t[0]).size(), 300u);
}

TEST_F(Report, OfAKilledRunShowsWhatThereIs) {
  const fs::path folder = make_run("circle", true);
  for (const char* file : {"metrics.json", "album.json", "timing.json", "calibration_found.yaml", "groundtruth.tum"})
    fs::remove(folder / file);
  std::ofstream(folder / "states.csv", std::ios::app) << "12345,Good,0.1";
  const nlohmann::json run = report_data({folder})["runs"][0];
  EXPECT_TRUE(run["metrics"].is_null());
  EXPECT_EQ(run["rows"]["t"].size(), 200u);
  EXPECT_EQ(run["changes"].size(), 5u);
  EXPECT_TRUE(run["calibration"][0]["after"].is_null());
}

/// Points of dense.ply or, with an edge, of voxels.ply: the second is at x + 1 of the first, and so on.
std::string row_of_points(int count, float edge_m = 0.0F) {
  std::string ply = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment a row\nelement vertex {}\nproperty float x\nproperty float "
      "y\nproperty float z\nproperty float {}\n{}end_header\n",
      count, edge_m > 0.0F ? "size" : "sigma",
      edge_m > 0.0F ? "" : "property uchar red\nproperty uchar green\nproperty uchar blue\n");
  for (int i = 0; i < count; ++i) {
    const std::array numbers = {static_cast<float>(i), 2.0F, 3.0F, edge_m};
    ply.append(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
    if (edge_m == 0.0F) ply.append(3, static_cast<char>(i));
  }
  return ply;
}

TEST_F(Report, PacksDensePointsAndVoxelsInTheWorldThatIsShown) {
  const fs::path folder = make_run("circle", true);
  nlohmann::json run = report_data({folder})["runs"][0];
  EXPECT_TRUE(run["dense"].is_null());
  EXPECT_TRUE(run["voxels"].is_null());
  write_file(folder / "dense.ply", row_of_points(3));
  write_file(folder / "voxels.ply", row_of_points(2, 0.05F));
  run = report_data({folder})["runs"][0];
  const nlohmann::json &dense = run["dense"], &voxels = run["voxels"];
  EXPECT_EQ(dense["all"], 3);
  EXPECT_EQ(dense["grey"], base64({0, 1, 2}));
  EXPECT_EQ(dense["xyz"].get<std::string>().size(), 24U);  // 18 bytes
  EXPECT_FALSE(dense.contains("edge_m"));
  // The truth is (1, 2, 3) away from an estimate that is 1 % too large, aligned in SE(3).
  EXPECT_NEAR(dense["low"][0].get<double>(), 1.0, 0.1);
  EXPECT_NEAR(dense["low"][1].get<double>(), 4.0, 0.1);
  EXPECT_NEAR(dense["low"][2].get<double>(), 6.0, 0.1);
  EXPECT_NEAR(dense["step"][0].get<double>(), 2.0 / 65535.0, 1e-6);
  EXPECT_NEAR(voxels["edge_m"].get<double>(), 0.05, 1e-9);
  EXPECT_EQ(voxels["axes"].size(), 9U);
  EXPECT_EQ(voxels["grey"], "");
}

TEST_F(Report, ThinsOutDensePointsEvenly) {
  write_file(top / "dense.ply", row_of_points(1000));
  const PointCloud cloud = read_cloud(top / "dense.ply", 10);
  EXPECT_EQ(cloud.all, 1000U);
  ASSERT_EQ(cloud.points.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(cloud.points[i].x(), 100.0F * static_cast<float>(i));
  EXPECT_TRUE(read_cloud(top / "none.ply", 10).points.empty());
}

TEST_F(Report, RefusesDamagedPointsInOneLine) {
  const fs::path folder = make_run("circle", true);
  const std::string whole = row_of_points(3);
  for (const std::string& damaged :
       {whole.substr(0, whole.size() - 1), whole + "x", whole.substr(0, 40), std::string(), std::string("\0\1", 2),
        std::string("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
        std::string("ply\nformat binary_little_endian 1.0\nelement vertex 0\nend_header\n")}) {
    write_file(folder / "dense.ply", damaged);
    try {
      report_data({folder});
      ADD_FAILURE() << damaged;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("dense.ply: damaged ("), std::string::npos) << e.what();
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    }
  }
}

TEST_F(Report, RefusesWhatIsNoRun) {
  fs::create_directories(top / "photos");
  EXPECT_THROW(report_data({top / "photos"}), InputError);
  EXPECT_THROW(report_data({top / "nothing"}), InputError);
}

TEST(Base64, IsThatOfTheStandard) {
  const auto encoded = [](const std::string& text) { return base64({text.begin(), text.end()}); };
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace edged
