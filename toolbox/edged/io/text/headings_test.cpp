// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Columns by the names in headings: the folders of UZH-FPV, and files with other names and orders.
#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include "edged/io/open_recording.hpp"
#include "edged/io/test_support.hpp"
#include "edged/io/text/sample_files.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

/// A folder as in UZH-FPV: first a column `id`, the gyro before the accelerometer.
void write_uzh_fpv(const TempFolder& folder) {
  std::string imu = "# id timestamp ang_vel_x ang_vel_y ang_vel_z lin_acc_x lin_acc_y lin_acc_z\n";
  std::string events = "# timestamp x y polarity\n", images = "# id timestamp image_name\n";
  std::string truth = "# id timestamp tx ty tz qx qy qz qw\n";
  for (int i = 0; i < 100; ++i) {
    const double t = 1540821844.0 + 0.002 * i;
    imu += fmt::format("{} {:.6f} 0.1 0.2 0.3 1 2 9.7\n", i, t);
    events += fmt::format("{:.6f} {} 7 1\n", t + 0.0001, i);
    truth += fmt::format("{} {:.6f} 4 5 6 0 0.6 0 0.8\n", i, t);
    if (i % 50 == 0) images += fmt::format("{} {:.6f} img/image_0_{}.png\n", i / 50, t, i / 50);
  }
  folder.write("imu.txt", imu);
  folder.write("events.txt", events);
  folder.write("images.txt", images);
  folder.write("groundtruth.txt", truth);
  folder.write_image("img/image_0_0.png", 346, 260);
  folder.write_image("img/image_0_1.png", 346, 260);
}

TEST(Headings, AFolderOfUzhFpvIsReadAsPublished) {
  const TempFolder folder;
  write_uzh_fpv(folder);
  const Recording r = open_recording(folder.path());
  const Contents c = read_all(*r.dataset);
  ASSERT_EQ(c.imu.size(), 100u);
  EXPECT_EQ(c.imu[0].gyro_B, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(c.imu[0].accel_B, Eigen::Vector3d(1, 2, 9.7));
  EXPECT_EQ(to_ns(c.imu[1].t), 1'540'821'844'002'000'000);
  EXPECT_EQ(c.events.size(), 100u);
  EXPECT_EQ(c.frames.size(), 2u);
  const auto truth = r.dataset->ground_truth();
  ASSERT_TRUE(truth);
  EXPECT_EQ(truth->frame, "body");
  EXPECT_EQ(truth->trajectory.size(), 100u);
  EXPECT_EQ(truth->trajectory[0].T.translation(), Eigen::Vector3d(4, 5, 6));
  EXPECT_NEAR(truth->trajectory[0].T.rotation().w(), 0.8, 1e-12);
  EXPECT_TRUE(r.dataset->repairs().empty());
  EXPECT_EQ(r.dataset->info().end, c.events.back().t);
}

TEST(Headings, DamagedLinesBelowAHeadingAreCounted) {
  const TempFolder folder;
  write_uzh_fpv(folder);
  folder.write("imu.txt",
               "# id timestamp ang_vel_x ang_vel_y ang_vel_z lin_acc_x lin_acc_y lin_acc_z\n0 1.0 0 0 0 0 0 9.8\n"
               "1 1.1 0 0 0 0\nx\n2 1.2 0 0 0 0 nan 9.8\n3 1.3 0 0 0 0 0 9.8\n");
  const Recording r = open_recording(folder.path());
  EXPECT_EQ(read_all(*r.dataset).imu.size(), 2u);
  EXPECT_EQ(r.dataset->repairs().at("imu: unreadable line"), 3u);
}

TEST(Headings, NamesThatAreNotKnownAreRefusedByName) {
  const TempFolder folder;
  write_uzh_fpv(folder);
  folder.write("imu.txt", "# id timestamp foo_x foo_y foo_z lin_acc_x lin_acc_y lin_acc_z\n0 1.0 0 0 0 0 0 9.8\n");
  const std::string refusal = input_error([&] { open_recording(folder.path()); });
  EXPECT_THAT(refusal, HasSubstr("imu.txt:1: no column is called gx, gy, gz; not known: `id`, `foo_x`"));
  EXPECT_EQ(refusal.find('\n'), std::string::npos);
}

TEST(Headings, AnotherImuIsUsedWithoutReadingTheFoldersOwn) {
  const TempFolder folder;
  write_uzh_fpv(folder);
  folder.write("imu.txt", "# id timestamp foo_x foo_y foo_z a b c\n0 1.0 0 0 0 0 0 9.8\n");
  std::string imu = "t[s],gx[rad/s],gy[rad/s],gz[rad/s],ax[m/s^2],ay[m/s^2],az[m/s^2]\n";
  for (int i = 0; i < 20; ++i) imu += fmt::format("{:.6f},1,0,0,0,0,9.8\n", 1540821844.0 + 0.01 * i);
  Recording r = open_recording(folder.path(), nullptr, {.own_imu = false});
  r.dataset = with_imu_file(std::move(r.dataset), folder.write("other/imu.csv", imu));
  const Contents c = read_all(*r.dataset);
  EXPECT_EQ(c.imu.size(), 20u);
  EXPECT_EQ(c.events.size(), 100u);
}

TEST(Headings, OrdersAndUnitsOfAllFilesOfAFolderAreThoseThatTheyName) {
  const TempFolder folder;
  std::string imu = "time_us gyro_z[deg/s] gyro_y[deg/s] gyro_x[deg/s] acc_x[g] acc_y[g] acc_z[g]\n";
  std::string events = "# polarity y x t[us]\n", truth = "# qw qx qy qz tx ty tz timestamp\n";
  for (int i = 0; i < 50; ++i) {
    imu += fmt::format("{} 90 0 0 0 0 1\n", 1'000'000 + 2000 * i);
    events += fmt::format("1 7 {} {}\n", i, 1'000'100 + 2000 * i);
    truth += fmt::format("0.8 0 0 0.6 1 2 3 {:.6f}\n", 1.0 + 0.002 * i);
  }
  folder.write("imu.txt", imu);
  folder.write("events.txt", events);
  folder.write("groundtruth.txt", truth);
  folder.write("images.txt", "# image_name timestamp\na.png 1.01\n");
  folder.write_image("a.png");
  const Recording r = open_recording(folder.path());
  const Contents c = read_all(*r.dataset);
  ASSERT_EQ(c.imu.size(), 50u);
  EXPECT_NEAR(c.imu[0].gyro_B.z(), 1.570796, 1e-6);
  EXPECT_NEAR(c.imu[0].accel_B.z(), 9.80665, 1e-9);
  ASSERT_EQ(c.events.size(), 50u);
  EXPECT_EQ(c.events[3].x, 3);
  EXPECT_EQ(to_ns(c.events[0].t), 1'000'100'000);
  EXPECT_EQ(c.frames.size(), 1u);
  EXPECT_NEAR(r.dataset->ground_truth()->trajectory[0].T.rotation().z(), 0.6, 1e-12);
  EXPECT_TRUE(r.dataset->repairs().empty());
}

TEST(Headings, EurocColumnsMayStandInAnyOrder) {
  const TempFolder folder;
  std::string imu =
      "#timestamp [ns],a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2],w_RS_S_x [rad s^-1],w_RS_S_y "
      "[rad s^-1],w_RS_S_z [rad s^-1]\n";
  for (int i = 0; i < 20; ++i) imu += fmt::format("{},0,0,9.8,0.1,0.2,0.3\n", 1'000'000'000 + 5'000'000LL * i);
  folder.write("mav0/imu0/data.csv", imu);
  folder.write("mav0/cam0/data.csv", "#filename,timestamp [ns]\n1.png,1000000000\n");
  folder.write_image("mav0/cam0/data/1.png");
  const Contents c = read_all(*open_recording(folder.path()).dataset);
  ASSERT_EQ(c.imu.size(), 20u);
  EXPECT_EQ(c.imu[0].gyro_B, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(c.frames.size(), 1u);
}

}  // namespace
}  // namespace edged
