// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// EuRoC folders of other data sets (the real one is in open_recording_test.cpp).
#include <gmock/gmock.h>
#include <spdlog/fmt/fmt.h>

#include "edged/io/open_recording.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

constexpr const char* kCamchain = R"(cam0:
  camera_model: pinhole
  distortion_model: equidistant
  distortion_coeffs: [0.0034, 0.0007, -0.0020, 0.0002]
  intrinsics: [290.97, 290.97, 254.93, 256.89]
  resolution: [512, 512]
  T_cam_imu:
  - [-0.99952504, 0.00750192, -0.02989013, 0.04557484]
  - [0.02961534, -0.03439736, -0.99896935, -0.07116180]
  - [-0.00852233, -0.99938008, 0.03415885, -0.04468125]
  - [0.0, 0.0, 0.0, 1.0]
)";

/// A folder as in TUM-VI: no sensor.yaml, ground truth in mocap0, calibration in dso.
void write_tum_vi(const TempFolder& folder) {
  folder.write("mav0/cam0/data.csv",
               "#timestamp [ns],filename\n1520530308199447626,1520530308199447626.png\n"
               "1520530308249448626,1520530308249448626.png\n");
  for (const char* name : {"1520530308199447626", "1520530308249448626"}) {
    cv::Mat image(512, 512, CV_16UC1, cv::Scalar(0xab12));
    folder.write_image(fmt::format("mav0/cam0/data/{}.png", name), image);
  }
  folder.write("mav0/imu0/data.csv",
               "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y,w_RS_S_z,a_RS_S_x [m s^-2],a_RS_S_y,a_RS_S_z\n"
               "1520530308198447626,0.1,0.2,0.3,9.5,-1.5,-2\n1520530308203447626,0.1,0.2,0.3,9.5,-1.5,-2\n");
  folder.write("mav0/mocap0/data.csv",
               "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n"
               "1520530308190447626,1,2,3,1,0,0,0\n1520530308210447626,1,2,3.5,0.6,0.8,0,0\n");
  folder.write("dso/camchain.yaml", kCamchain);
  folder.write("dso/imu_config.yaml",
               "accelerometer_noise_density: 0.0028\naccelerometer_random_walk: 0.00086\n"
               "gyroscope_noise_density: 0.00016\ngyroscope_random_walk: 0.000022\nupdate_rate: 200.0\n");
}

TEST(TumVi, OpensWithTruthCalibrationAndSixteenBitImages) {
  TempFolder folder;
  write_tum_vi(folder);
  for (const char* given : {"", "mav0", "dso"}) {
    const Recording recording = open_recording(folder.path() / given);
    ASSERT_TRUE(recording.calibration) << given;
    EXPECT_EQ(recording.calibration->rig.cameras.at(0).model.width(), 512);
    EXPECT_TRUE(recording.calibration->has_imu_noise);
    const Contents c = read_all(*recording.dataset);
    ASSERT_EQ(c.frames.size(), 2u);
    EXPECT_EQ(c.frames[0].image.type(), CV_8UC1);
    EXPECT_EQ(c.frames[0].image.at<std::uint8_t>(100, 100), 0xab);  // the upper half of 16 bits
    ASSERT_EQ(c.imu.size(), 2u);
    EXPECT_EQ(c.imu[0].gyro_B, Eigen::Vector3d(0.1, 0.2, 0.3));
    const auto truth = recording.dataset->ground_truth();
    ASSERT_TRUE(truth);
    EXPECT_EQ(truth->frame, "body");
    ASSERT_EQ(truth->trajectory.size(), 2u);
    EXPECT_NEAR(truth->trajectory[1].T.rotation().x(), 0.8, 1e-12);
    EXPECT_TRUE(recording.dataset->repairs().empty());
  }
}

/// Replaces a text in the calibration of write_tum_vi.
void change_camchain(const TempFolder& folder, const std::string& from, const std::string& to) {
  std::string text = kCamchain;
  folder.write("dso/camchain.yaml", text.replace(text.find(from), from.size(), to));
}

TEST(TumVi, ItsLensIsUsedAsFarAsItCanBe) {
  TempFolder folder;
  write_tum_vi(folder);
  change_camchain(folder, "290.97, 290.97", "190.97, 190.97");  // the published one: the corners lie beyond 90 degrees
  const Recording recording = open_recording(folder.path());
  ASSERT_TRUE(recording.calibration);
  EXPECT_TRUE(recording.calibration->rig.cameras[0].model.view_limit());
}

TEST(TumVi, ACalibrationThatIsRefusedDoesNotCloseTheRecording) {
  TempFolder folder;
  write_tum_vi(folder);
  change_camchain(folder, "camera_model: pinhole", "camera_model: omni");
  const Recording recording = open_recording(folder.path());
  EXPECT_FALSE(recording.calibration);
  EXPECT_EQ(read_all(*recording.dataset).frames.size(), 2u);
}

TEST(TumVi, PositionsAloneAreNoGroundTruth) {
  TempFolder folder;
  write_tum_vi(folder);
  std::filesystem::rename(folder.path() / "mav0/mocap0", folder.path() / "mav0/leica0");
  EXPECT_FALSE(open_recording(folder.path()).dataset->ground_truth());
}

TEST(EuRoC, GivesEveryCameraThatIsAskedFor) {
  TempFolder folder;
  write_tum_vi(folder);
  std::filesystem::copy(folder.path() / "mav0/cam0", folder.path() / "mav0/cam1",
                        std::filesystem::copy_options::recursive);
  for (const char* camera : {"cam0", "cam1"})
    folder.write(std::string("mav0/") + camera + "/sensor.yaml",
                 std::string("sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, ") +
                     (camera[3] == '0' ? "0" : "0.11") +
                     ", 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nresolution: [512, 512]\ncamera_model: pinhole\n"
                     "intrinsics: [290.0, 290.0, 255.5, 255.5]\ndistortion_model: radial-tangential\n"
                     "distortion_coefficients: [0.0, 0.0, 0.0, 0.0]\n");
  const auto read = [&](std::vector<std::string> cameras) {
    Recording recording = open_recording(folder.path(), nullptr, {.cameras = std::move(cameras)});
    std::string names = recording.dataset->info().frame_camera + ":";
    for (const Frame& frame : read_all(*recording.dataset).frames) names += " " + frame.camera;
    names += ";";
    for (const RigCamera& camera : recording.calibration->rig.cameras) names += " " + camera.name;
    return names;
  };
  EXPECT_EQ(read({}), "cam0: cam0 cam0; cam0");
  EXPECT_EQ(read({"cam1", "cam0"}), "cam0: cam0 cam1 cam0 cam1; cam0 cam1");
  EXPECT_EQ(read({"cam1"}), "cam1: cam1 cam1; cam0 cam1");
  EXPECT_EQ(read({"elsewhere"}), "cam0: cam0 cam0; cam0");
}

/// As where only the images of one camera were downloaded.
TEST(EuRoC, CountsNoCameraWithoutImages) {
  TempFolder folder;
  write_tum_vi(folder);
  folder.write("mav0/cam1/data.csv", "#timestamp [ns],filename\n1520530308199447626,1520530308199447626.png\n");
  EXPECT_TRUE(open_recording(folder.path(), nullptr, {.all_cameras = true}).dataset->info().more_cameras.empty());
}

}  // namespace
}  // namespace edged
