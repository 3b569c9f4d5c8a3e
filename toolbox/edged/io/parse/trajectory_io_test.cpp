// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Trajectory files: columns, stamps, damage.
#include "edged/io/parse/trajectory_io.hpp"

#include <gmock/gmock.h>

#include "edged/io/test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

Trajectory sample_trajectory() {
  Trajectory out;
  for (int i = 0; i < 50; ++i) {
    const Vector6d xi = (Vector6d() << 0.1 * i, -0.03 * i, 1.0 / (i + 3), 0.01 * i, -0.02 * i, 0.05 * i).finished();
    out.push_back({timestamp_from_ns(1'468'940'220'388'679'504 + i * 5'000'001), SE3::exp(xi)});
  }
  return out;
}

void expect_same(const Trajectory& a, const Trajectory& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].t, b[i].t);
    EXPECT_EQ(a[i].T.translation(), b[i].T.translation());
    EXPECT_TRUE(a[i].T.rotation().coeffs().isApprox(b[i].T.rotation().coeffs(), 1e-15));
  }
}

TEST(TrajectoryIo, TumAndEurocReadBackExactly) {
  TempFolder folder;
  const Trajectory trajectory = sample_trajectory();
  write_tum(folder.path() / "a.tum", trajectory, {"pose of the body in the world"});
  TrajectoryWriter euroc(folder.path() / "a.csv", TrajectoryFormat::EurocCsv, {"pose of the body in the world"});
  for (const StampedPose& pose : trajectory) euroc.add(pose);
  euroc.flush();
  expect_same(read_tum(folder.path() / "a.tum"), trajectory);
  expect_same(read_poses(folder.path() / "a.csv", euroc_table()), trajectory);
  expect_same(read_trajectory(folder.path() / "a.tum"), trajectory);
  expect_same(read_trajectory(folder.path() / "a.csv"), trajectory);
  EXPECT_THAT(read_text(folder.path() / "a.tum"), HasSubstr("# pose of the body in the world\n# timestamp"));
  EXPECT_THAT(read_text(folder.path() / "a.tum"), HasSubstr("\n1468940220.388679504 "));
}

TEST(TrajectoryIo, TumPutsTheScalarLastAndEurocFirst) {
  TempFolder folder;
  const auto tum = read_tum(folder.write("a.tum", "# c\n1.5 1 2 3 0 0 0.6 0.8\n"));
  const auto csv =
      read_poses(folder.write("a.csv", "#t\n1500000000, 1, 2, 3, 0.8, 0, 0, 0.6, 7, 7, 7\n"), euroc_table());
  expect_same(tum, csv);
  EXPECT_NEAR(tum[0].T.rotation().w(), 0.8, 1e-15);
}

TEST(TrajectoryIo, KittiLinesAreRowsOfTheMatrix) {
  TempFolder folder;
  const auto file = folder.write("a.txt", "1 0 0 4 0 1 0 5 0 0 1 6\n0 -1 0 7 1 0 0 8 0 0 1 9\n");
  const auto poses = read_trajectory(file);
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(to_ns(poses[1].t), 1'000'000'000);
  EXPECT_EQ(poses[1].T.translation(), Eigen::Vector3d(7, 8, 9));
  EXPECT_TRUE((poses[1].T * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d(7, 9, 9)));
}

TEST(TrajectoryIo, AStampBelowAnHourInNanosecondsIsKnownByTheCommas) {
  TempFolder folder;
  const std::string csv = "424833000,1,2,3,0.8,0,0,0.6\n466500000,1,2,3,0.8,0,0,0.6\n";
  const auto nanoseconds = folder.write("a.csv", csv);
  const auto seconds = folder.write("a.tum", "424833000 1 2 3 0 0 0.6 0.8\n");
  expect_same(read_trajectory(nanoseconds), read_poses(nanoseconds, euroc_table()));
  expect_same(read_trajectory(seconds), read_tum(seconds));
}

TEST(TrajectoryIo, AByteOrderMarkAndDecimalCommasAreReadAsOtherPrograms) {
  TempFolder folder;
  const auto marked = folder.write("a.csv", "\xEF\xBB\xBF#timestamp,tx,ty,tz,qx,qy,qz,qw\n0.5,1,2,3.5,0,0,0,1\n");
  const auto commas = folder.write("b.csv", "\xEF\xBB\xBFtimestamp;tx;ty;tz;qx;qy;qz;qw\n0,5;1;2;3,5;0;0;0;1\n");
  expect_same(read_trajectory(marked), read_trajectory(commas));
  EXPECT_EQ(read_trajectory(commas).at(0).T.translation(), Eigen::Vector3d(1, 2, 3.5));
}

TEST(TrajectoryIo, OtherProgramsFilesAreReadInTheirOrder) {
  TempFolder folder;
  const auto ns = [](int i) { return 1'403'636'580'000'000'000 + 50'000'000LL * i; };
  const auto write = [&](const std::string& heading, const std::string& format) {
    std::string text = heading;
    for (int i = 0; i < 5; ++i)
      text += fmt::format(fmt::runtime(format), fmt::arg("ns", ns(i)), fmt::arg("s", 1e-9 * static_cast<double>(ns(i))),
                          fmt::arg("p", "1 2 3"), fmt::arg("xyzw", "0.1 0.2 0.3 0.9273618"), fmt::arg("cp", "1,2,3"),
                          fmt::arg("cxyzw", "0.1,0.2,0.3,0.9273618"), fmt::arg("cwxyz", "0.9273618,0.1,0.2,0.3"));
    return folder.write("a.txt", text);
  };
  const struct {
    const char *who, *heading, *line;
  } cases[] = {
      {"ORB-SLAM3", "", "{ns} {p} {xyzw}\n"},
      {"ORB-SLAM3 with decimals", "", "{ns}.000000 {p} {xyzw}\n"},
      {"TUM", "", "{s:.6f} {p} {xyzw}\n"},
      {"TUM as csv", "", "{s:.6f},{cp},{cxyzw}\n"},
      {"EuRoC", "", "{ns},{cp},{cwxyz},0,0,0\n"},
      {"VINS", "", "{ns},{cp},{cwxyz},0,0,0,\n"},
      {"OKVIS2", "timestamp, p_WS_W_x, p_WS_W_y, p_WS_W_z, q_WS_x, q_WS_y, q_WS_z, q_WS_w, v_WS_W_x, b_g_x\n",
       "{ns}, {cp}, {cxyzw}, 7, 8\n"},
      {"Kalibr", "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n",
       "{ns},{cp},{cwxyz}\n"},
      {"Kimera", "#timestamp_kf,x,y,z,qw,qx,qy,qz,vx,vy,vz,bgx,bgy,bgz,bax,bay,baz\n",
       "{ns},{cp},{cwxyz},0,0,0,0,0,0,0,0,0\n"},
      {"maplab",
       "timestamp [ns], vertex index, position x [m], position y [m], position z [m], quaternion x, quaternion "
       "y, quaternion z, quaternion w, velocity x [m/s]\n",
       "{ns}, 4, {cp}, {cxyzw}, 7\n"},
      {"rostopic",
       "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.pose.position.x,field.pose.position.y,"
       "field.pose.position.z,field.pose.orientation.x,field.pose.orientation.y,field.pose.orientation.z,"
       "field.pose.orientation.w\n",
       "5,1,{ns},map,{cp},{cxyzw}\n"},
      {"OpenVINS", "# timestamp(s) q p v bg ba cam_imu_dt\n", "{s:.5f} {xyzw} {p} 0 0 0 0 0 0 0 0 0 0\n"},
      {"UZH-FPV", "# id timestamp tx ty tz qx qy qz qw\n", "3 {s:.6f} {p} {xyzw}\n"},
  };
  for (const auto& c : cases) {
    const auto file = write(c.heading, c.line);
    const TrajectoryForm form = find_trajectory_form(file);
    EXPECT_EQ(form.columns.doubt, "") << c.who;
    EXPECT_FALSE(form.columns.said.empty()) << c.who;
    const Trajectory poses = read_trajectory(file);
    ASSERT_EQ(poses.size(), 5u) << c.who;
    EXPECT_NEAR(to_seconds(poses[3].t - timestamp_from_ns(ns(3))), 0.0, 2e-6) << c.who << form.columns.said;
    EXPECT_EQ(poses[3].T.translation(), Eigen::Vector3d(1, 2, 3)) << c.who;
    EXPECT_NEAR(poses[3].T.rotation().w(), 0.9273618, 1e-6) << c.who;
    EXPECT_NEAR(poses[3].T.rotation().y(), 0.2, 1e-6) << c.who;
  }
}

TEST(TrajectoryIo, StampsFromTheStartOfARecordingAreKnownByTheirDistance) {
  TempFolder folder;
  std::string ns, us;
  for (int i = 0; i < 5; ++i) {
    ns += fmt::format("{}.000000 0 0 0 0 0 0 1\n", 2'400'000'000 + 50'000'000LL * i);
    us += fmt::format("{} 0 0 0 0 0 0 1\n", 2'400'000 + 5'000LL * i);
  }
  EXPECT_EQ(to_ns(read_trajectory(folder.write("ns.txt", ns)).front().t), 2'400'000'000);
  EXPECT_EQ(to_ns(read_trajectory(folder.write("us.txt", us)).front().t), 2'400'000'000);
}

TEST(TrajectoryIo, AFirstPoseThatFitsTheOtherOrderIsADoubt) {
  TempFolder folder;
  std::string text;
  for (int i = 0; i < 5; ++i)
    text += fmt::format("{},0,0,0,0,0,0.01,0.99995\n", 1'403'636'580'000'000'000 + 50'000'000LL * i);
  EXPECT_THAT(find_trajectory_form(folder.write("a.csv", text)).columns.doubt, HasSubstr("scalar last"));
}

TEST(TrajectoryIo, NamesThatAreNotKnownAreRefusedByName) {
  TempFolder folder;
  const auto file = folder.write("a.csv", "t,x,y,z,roll,pitch,yaw,error\n1,0,0,0,0,0,0,1\n");
  EXPECT_THAT(input_error([&] { read_trajectory(file); }), HasSubstr("a.csv:1: no column is called qx, qy, qz, qw"));
}

TEST(TrajectoryIo, DamageIsNamedByFileAndLine) {
  TempFolder folder;
  const auto complaint = [&](const std::string& text) {
    return input_error([&] { read_tum(folder.write("bad.tum", text)); });
  };
  const std::string good = "1 0 0 0 0 0 0 1\n";
  EXPECT_THAT(complaint(good + "2 0 0 0 0 0 0\n"), HasSubstr("bad.tum:2: no pose in finite numbers"));
  EXPECT_THAT(complaint(good + "2 0 nan 0 0 0 0 1\n"), HasSubstr("bad.tum:2:"));
  EXPECT_THAT(complaint(good + "2 0 0 0 0 0 0 0\n"), HasSubstr("norm 0.000"));
  EXPECT_THAT(complaint(good + "0.5 0 0 0 0 0 0 1\n"), HasSubstr("sort the file"));
  EXPECT_THAT(input_error([&] { read_tum(folder.path() / "none.tum"); }), HasSubstr("none.tum: cannot be opened"));
  EXPECT_THAT(input_error([&] { read_trajectory(folder.write("e.tum", "")); }), HasSubstr("holds no pose"));
  EXPECT_THAT(input_error([&] { read_trajectory(folder.write("e.tum", "1 2 3\n")); }), HasSubstr("3 columns"));
}

TEST(TrajectoryIo, HandsDamageToTheHandlerAndGoesOn) {
  TempFolder folder;
  std::vector<std::size_t> lines;
  const auto trajectory =
      read_poses(folder.write("a.tum", "1 0 0 0 0 0 0 1\nrubbish\n1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n3 0 0 0"),
                 tum_table(TimeUnit::Seconds), [&](std::size_t line, const std::string&) { lines.push_back(line); });
  EXPECT_EQ(trajectory.size(), 2u);
  EXPECT_EQ(lines, (std::vector<std::size_t>{2, 3, 5}));
}

TEST(TrajectoryIo, ReadsTheRealFiles) {
  const auto data = data_folder();
  if (!std::filesystem::exists(data / "eval_oracle")) GTEST_SKIP() << "no data";
  EXPECT_EQ(read_trajectory(data / "eval_oracle" / "KITTI_00_gt.txt").size(), 4541u);
  EXPECT_EQ(to_ns(read_trajectory(data / "eval_oracle" / "V102.txt").front().t), 1'403'715'529'112'143'517);
  EXPECT_EQ(to_ns(read_trajectory(data / "ecd" / "groundtruth" / "poster_translation.txt").front().t),
            1'468'940'220'388'679'504);
  EXPECT_GT(read_trajectory(data / "euroc_mh01" / "mav0" / "state_groundtruth_estimate0" / "data.csv").size(), 3000u);
}

}  // namespace
}  // namespace edged
