// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "messages.hpp"

#include <gtest/gtest.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <opencv2/core.hpp>

namespace edged::ros1 {
namespace {

const FrameNames kFrames{"odom", "body"};

/// At 1, 2, 3, turned by 90 degrees about z: the body's x points along the world's y.
NavState turned_state() {
  NavState state;
  state.t = timestamp_from_ns(1'700'000'000'123'456'789);
  state.T_W_B =
      SE3(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())), Eigen::Vector3d(1, 2, 3));
  state.v_W = Eigen::Vector3d(0, 5, 0);
  state.bias_gyro = Eigen::Vector3d(0.1, 0, 0);
  return state;
}

TEST(RosMessages, StampsKeepTheirNanosecondsAndEndAtWhatRosHolds) {
  const ros::Time t = to_ros(timestamp_from_ns(1'700'000'000'123'456'789));
  EXPECT_EQ(t.sec, 1'700'000'000U);
  EXPECT_EQ(t.nsec, 123'456'789U);
  EXPECT_EQ(to_ros(timestamp_from_ns(-5)), ros::Time(0, 0));
  EXPECT_EQ(to_ros(timestamp_from_seconds(5e9)), ros::TIME_MAX);
}

TEST(RosMessages, OdometryHasThePoseInTheWorldAndTheVelocitiesInTheBody) {
  const nav_msgs::Odometry odometry = odometry_message(turned_state(), Eigen::Vector3d(0.3, 0, 0), {}, kFrames);
  EXPECT_EQ(odometry.header.frame_id, "odom");
  EXPECT_EQ(odometry.child_frame_id, "body");
  EXPECT_EQ(odometry.header.stamp.nsec, 123'456'789U);
  EXPECT_EQ(odometry.pose.pose.position.y, 2.0);
  EXPECT_NEAR(odometry.pose.pose.orientation.z, M_SQRT1_2, 1e-12);
  EXPECT_NEAR(odometry.twist.twist.linear.x, 5.0, 1e-12);
  EXPECT_NEAR(odometry.twist.twist.linear.y, 0.0, 1e-12);
  EXPECT_NEAR(odometry.twist.twist.angular.x, 0.2, 1e-12);
  EXPECT_EQ(odometry.pose.covariance[0], 0.0);
}

TEST(RosMessages, TheCovarianceOfTheRotationIsAboutTheAxesOfTheWorld) {
  StateCovariance covariance{Eigen::Vector3d(1, 2, 3).asDiagonal(), Eigen::Vector3d(4, 5, 6).asDiagonal(),
                             Eigen::Vector3d(7, 8, 9).asDiagonal()};
  covariance.position(0, 1) = covariance.position(1, 0) = 0.5;
  const auto P = odometry_message(turned_state(), Eigen::Vector3d::Zero(), covariance, kFrames).pose.covariance;
  EXPECT_EQ(P[0], 1.0);
  EXPECT_EQ(P[1], 0.5);
  EXPECT_EQ(P[14], 3.0);
  EXPECT_NEAR(P[21], 5.0, 1e-12);  // about the world's x, which is the body's -y
  EXPECT_NEAR(P[28], 4.0, 1e-12);
  EXPECT_NEAR(P[35], 6.0, 1e-12);
}

TEST(RosMessages, TheCovarianceOfTheVelocityIsAlongTheAxesOfTheBody) {
  const StateCovariance covariance{Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity(),
                                   Eigen::Vector3d(7, 8, 9).asDiagonal()};
  const auto P = odometry_message(turned_state(), Eigen::Vector3d::Zero(), covariance, kFrames).twist.covariance;
  EXPECT_NEAR(P[0], 8.0, 1e-12);  // along the body's x, which is the world's y
  EXPECT_NEAR(P[7], 7.0, 1e-12);
  EXPECT_NEAR(P[14], 9.0, 1e-12);
}

TEST(RosMessages, TransformsLeadFromTheWorldToTheBodyAndOnToEachCamera) {
  Rig rig;
  rig.cameras.push_back(
      {"dvs", Modality::Events, CameraModel(), SE3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, 0, 0.1))});
  const auto transforms = transforms_message(turned_state(), rig, kFrames).transforms;
  ASSERT_EQ(transforms.size(), 2U);
  EXPECT_EQ(transforms[0].header.frame_id, "odom");
  EXPECT_EQ(transforms[0].child_frame_id, "body");
  EXPECT_EQ(transforms[0].transform.translation.x, 1.0);
  EXPECT_EQ(transforms[1].header.frame_id, "body");
  EXPECT_EQ(transforms[1].child_frame_id, "dvs");
  EXPECT_EQ(transforms[1].transform.translation.z, 0.1);
}

TEST(RosMessages, LandmarksAreACloudWithTheirIds) {
  const std::vector<Landmark> landmarks = {{7, {1, 2, 3}}, {9, {4, 5, 6}}};
  const sensor_msgs::PointCloud2 cloud = landmarks_message(timestamp_from_seconds(2), landmarks, kFrames);
  EXPECT_EQ(cloud.header.frame_id, "odom");
  EXPECT_EQ(cloud.width, 2U);
  sensor_msgs::PointCloud2ConstIterator<float> xyz(cloud, "x");
  sensor_msgs::PointCloud2ConstIterator<std::uint32_t> id(cloud, "id");
  EXPECT_EQ(xyz[2], 3.0F);
  ++xyz, ++id;
  EXPECT_EQ(xyz[0], 4.0F);
  EXPECT_EQ(*id, 9U);
}

TEST(RosMessages, TracksAreDrawnOnACopyOfTheImage) {
  const cv::Mat image(20, 30, CV_8UC1, cv::Scalar(50));
  Track track;
  track.pixel = {15, 10};
  track.previous_pixel = {5, 10};
  const sensor_msgs::Image message = tracks_message(timestamp_from_seconds(2), "cam", image, std::vector{track});
  EXPECT_EQ(message.header.frame_id, "cam");
  EXPECT_EQ(message.encoding, "bgr8");
  EXPECT_EQ(message.step, 90U);
  ASSERT_EQ(message.data.size(), 1800U);
  EXPECT_EQ(message.data[0], 50);
  EXPECT_NE(message.data[10 * 90 + 8 * 3 + 2], 50);  // where it came from
  EXPECT_EQ(cv::countNonZero(image != 50), 0);
}

}  // namespace
}  // namespace edged::ros1
