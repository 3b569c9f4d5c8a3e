// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Agreement with results that another program published for the same trajectories.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "edged/core/test_data.hpp"
#include "edged/eval/metrics.hpp"
#include "edged/eval/test_trajectories.hpp"

namespace edged {
namespace {

std::filesystem::path oracle() { return data_folder() / "eval_oracle"; }

/// Numbers of every line that is no comment.
std::vector<std::vector<double>> read_rows(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream numbers(line);
    rows.emplace_back();
    for (double value; numbers >> value;) rows.back().push_back(value);
  }
  return rows;
}

Trajectory read_kitti(const std::string& name) {
  Trajectory trajectory;
  for (const auto& m : read_rows(oracle() / name)) {
    Eigen::Matrix3d R;
    R << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
    const double t = 0.1 * static_cast<double>(trajectory.size());
    trajectory.push_back({timestamp_from_seconds(t), SE3(R, Eigen::Vector3d(m[3], m[7], m[11]))});
  }
  return trajectory;
}

Trajectory read_tum(const std::string& name) {
  Trajectory trajectory;
  for (const auto& r : read_rows(oracle() / name)) {
    const Eigen::Quaterniond q(r[7], r[4], r[5], r[6]);
    trajectory.push_back({timestamp_from_seconds(r[0]), SE3(q, Eigen::Vector3d(r[1], r[2], r[3]))});
  }
  return trajectory;
}

TEST(EvalOracle, EqualsThePublishedStatisticsOfKitti00) {
  if (!std::filesystem::exists(oracle())) GTEST_SKIP() << "no data";
  const Association association = associate_by_index(read_kitti("KITTI_00_gt.txt"), read_kitti("KITTI_00_ORB.txt"));
  const Statistics ate = evaluate(association, protocol("P3")).ate_m;
  // KITTI_00_ORB_ape_se3_stats.json
  EXPECT_NEAR(ate.rmse, 1.3034497145650266, 1e-6);
  EXPECT_NEAR(ate.mean, 1.1569971285389768, 1e-6);
  EXPECT_NEAR(ate.median, 1.065624769555848, 1e-6);
  EXPECT_NEAR(ate.std, 0.6002822693968323, 1e-6);
  EXPECT_NEAR(ate.min, 0.06931322021483087, 1e-6);
  EXPECT_NEAR(ate.max, 3.587949120678954, 1e-6);
  EXPECT_NEAR(ate.sse, 7715.073440292808, 1e-6);
}

TEST(EvalOracle, PairsFreiburgWithItsGroundTruth) {
  if (!std::filesystem::exists(oracle())) GTEST_SKIP() << "no data";
  const Trajectory truth = read_tum("freiburg1_xyz-groundtruth.txt");
  const Trajectory estimate = read_tum("freiburg1_xyz-rgbdslam_drift.txt");
  const Association association = associate(truth, estimate);
  EXPECT_GT(association.pairs.size(), estimate.size() * 95 / 100);
  const Evaluation result = evaluate(association, protocol("P3"));
  EXPECT_LT(result.ate_m.rmse, 0.05);  // a hand-held room scan: the published error is a few centimetres
  EXPECT_NEAR(result.scale, 1.0, 0.1);
}

TEST(EvalOracle, RecoversATransformAppliedToARealTrajectory) {
  if (!std::filesystem::exists(oracle())) GTEST_SKIP() << "no data";
  const Trajectory truth = read_tum("V102.txt");
  const SE3 T(so3::exp({0.3, 0.2, -1.0}), Eigen::Vector3d(10, -20, 30));
  // By index: four stamps of this file stand twice, with different positions.
  const Evaluation result = evaluate(associate_by_index(truth, scaled(2.0, moved(T, truth))), protocol("P4"));
  EXPECT_EQ(result.pairs, truth.size());
  EXPECT_NEAR(result.scale, 0.5, 1e-9);
  EXPECT_LT(result.ate_m.max, 1e-8);
}

}  // namespace
}  // namespace edged
