// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "outputs/final_trajectory.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <limits>
#include <sstream>

#include "edged/io/parse/trajectory_io.hpp"
#include "report/states_table.hpp"

namespace edged {
namespace {

class FinalTrajectoryFiles : public testing::Test {
 protected:
  FinalTrajectoryFiles() { std::filesystem::create_directories(folder_); }
  ~FinalTrajectoryFiles() override { std::filesystem::remove_all(folder_); }
  std::vector<std::string> lines(const char* file) const {
    std::ifstream in(folder_ / file);
    std::vector<std::string> all;
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
  }
  void write(const FinalTrajectory& known) const {
    write_final_trajectory(folder_, OutputFrame({}, "body"), known, {"head"});
  }

  const std::filesystem::path folder_ = testing::TempDir() + "edged_final_" + std::to_string(getpid());
};

TEST_F(FinalTrajectoryFiles, LeavesCompleteFilesWithoutAPoseOrAMap) {
  write({});
  EXPECT_TRUE(read_tum(folder_ / "trajectory_final.tum").empty());
  EXPECT_EQ(lines("trajectory_final.tum")[0], "# head");
  EXPECT_EQ(lines("keyframes.csv").size(), 2U) << "what they are, and the names of the columns";
  EXPECT_EQ(lines("map.ply").front(), "ply");
  EXPECT_EQ(lines("map.ply").back(), "end_header");
  EXPECT_EQ(lines("map.ply")[4], "element vertex 0");
}

TEST_F(FinalTrajectoryFiles, HoldsPosesKeyframesAndPoints) {
  const SE3 T(so3::exp({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0});
  const MappedKeyframe::Point point{{0.5, -0.25, 2.0}, 77, 9, 4}, bad{{0.0, 0.0, std::nan("")}, 1, 0, 0};
  const Timestamp t = timestamp_from_ns(1'500'000'000);
  write({{{t, T}}, {{t, T, "frames", 3, timestamp_from_ns(7'000'000'000), {point, bad}}}});
  const Trajectory poses = read_tum(folder_ / "trajectory_final.tum");
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses[0].T.translation(), T.translation());
  const std::vector<std::string> keyframes = lines("keyframes.csv"), ply = lines("map.ply");
  ASSERT_EQ(keyframes.size(), 3U);
  EXPECT_TRUE(keyframes[2].starts_with("1500000000,1,2,3,"));
  EXPECT_TRUE(keyframes[2].ends_with(",frames,2,3,7000000000"));
  EXPECT_EQ(std::ranges::count(keyframes[1], ','), std::ranges::count(keyframes[2], ','));
  const std::vector<MappedKeyframe> read = read_keyframes(folder_);
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].t, t);
  EXPECT_EQ(read[0].T_W_B.translation(), T.translation());
  EXPECT_EQ(read[0].times_found, 3);
  EXPECT_EQ(ply[4], "element vertex 1") << "a point that is not finite is skipped";
  EXPECT_EQ(ply.back(), "0.50000 -0.25000 2.00000 77 77 77 0 9 4");
}

}  // namespace
}  // namespace edged
