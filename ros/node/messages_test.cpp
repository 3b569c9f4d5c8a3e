// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/messages.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "edged/io/ros/messages/messages.hpp"

namespace edged::node {
namespace {

class RosMessages : public ::testing::TestWithParam<Wire> {
 protected:
  static WireReader reader(const std::string& message) { return {GetParam(), as_bytes(message)}; }
};
INSTANTIATE_TEST_SUITE_P(Wires, RosMessages, ::testing::Values(Wire::Ros1, Wire::Cdr));

/// At 1, 2, 3, turned by 90 degrees about z: the body's x points along the world's y.
Estimate turned_estimate() {
  Estimate estimate;
  NavState& state = estimate.state;
  state.t = timestamp_from_ns(1'700'000'000'123'456'789);
  state.T_W_B =
      SE3(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())), Eigen::Vector3d(1, 2, 3));
  state.v_W = Eigen::Vector3d(0, 5, 0);
  state.bias_gyro = Eigen::Vector3d(0.1, 0, 0);
  estimate.gyro_B = Eigen::Vector3d(0.3, 0, 0);
  return estimate;
}

/// The numbers of an Odometry.
struct OdometryFields {
  Timestamp stamp;
  std::string_view child;
  Eigen::Matrix<double, 7, 1> pose;
  Eigen::Matrix<double, 36, 1> pose_covariance;
  Eigen::Matrix<double, 6, 1> twist;
  Eigen::Matrix<double, 36, 1> twist_covariance;
};
OdometryFields odometry_fields(WireReader reader) {
  OdometryFields fields;
  fields.stamp = reader.header();
  fields.child = reader.text();
  fields.pose = reader.vector<7>();
  fields.pose_covariance = reader.vector<36>();
  fields.twist = reader.vector<6>();
  fields.twist_covariance = reader.vector<36>();
  return fields;
}

TEST_P(RosMessages, OdometryHasThePoseInTheWorldAndTheVelocitiesInTheBody) {
  const std::string message = odometry_message({GetParam()}, turned_estimate());
  const OdometryFields odometry = odometry_fields(reader(message));
  EXPECT_EQ(odometry.stamp, turned_estimate().state.t);
  EXPECT_EQ(odometry.child, "body");
  EXPECT_EQ(odometry.pose[1], 2.0);
  EXPECT_NEAR(odometry.pose[5], M_SQRT1_2, 1e-12);
  EXPECT_NEAR(odometry.twist[0], 5.0, 1e-12);
  EXPECT_NEAR(odometry.twist[1], 0.0, 1e-12);
  EXPECT_NEAR(odometry.twist[3], 0.2, 1e-12);
  EXPECT_EQ(odometry.pose_covariance[0], 0.0);
}

TEST_P(RosMessages, StampsThatRosCannotHoldBecomeItsFirstOrLast) {
  Estimate estimate = turned_estimate();
  estimate.state.t = timestamp_from_ns(-5);
  EXPECT_EQ(odometry_fields(reader(odometry_message({GetParam()}, estimate))).stamp, Timestamp());
}

TEST_P(RosMessages, CovariancesAreAboutTheAxesThatRosWants) {
  Estimate estimate = turned_estimate();
  estimate.covariance = StateCovariance{Eigen::Vector3d(1, 2, 3).asDiagonal(), Eigen::Vector3d(4, 5, 6).asDiagonal(),
                                        Eigen::Vector3d(7, 8, 9).asDiagonal()};
  estimate.covariance->position(0, 1) = estimate.covariance->position(1, 0) = 0.5;
  const std::string message = odometry_message({GetParam()}, estimate);
  const OdometryFields odometry = odometry_fields(reader(message));
  EXPECT_EQ(odometry.pose_covariance[0], 1.0);
  EXPECT_EQ(odometry.pose_covariance[1], 0.5);
  EXPECT_EQ(odometry.pose_covariance[14], 3.0);
  EXPECT_NEAR(odometry.pose_covariance[21], 5.0, 1e-12);  // about the world's x, which is the body's -y
  EXPECT_NEAR(odometry.pose_covariance[28], 4.0, 1e-12);
  EXPECT_NEAR(odometry.twist_covariance[0], 8.0, 1e-12);  // along the body's x, which is the world's y
  EXPECT_NEAR(odometry.twist_covariance[7], 7.0, 1e-12);
}

TEST_P(RosMessages, TransformsLeadFromTheWorldToTheBodyAndOnToEachCamera) {
  Rig rig;
  rig.cameras.push_back(
      {"dvs", Modality::Events, CameraModel(), SE3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, 0, 0.1))});
  const std::string body = body_transform_message({GetParam()}, turned_estimate().state);
  WireReader to_body = reader(body);
  EXPECT_EQ(to_body.number<std::uint32_t>(), 1U);
  to_body.header();
  EXPECT_EQ(to_body.text(), "body");
  EXPECT_EQ(to_body.vector<3>().x(), 1.0);
  const std::string cameras = camera_transforms_message({GetParam()}, Timestamp(), rig);
  WireReader to_camera = reader(cameras);
  EXPECT_EQ(to_camera.number<std::uint32_t>(), 1U);
  to_camera.header();
  EXPECT_EQ(to_camera.text(), "dvs");
  EXPECT_EQ(to_camera.vector<3>().z(), 0.1);
}

TEST_P(RosMessages, TracksAreRenderedOnACopyOfTheImage) {
  const cv::Mat image(20, 30, CV_8UC1, cv::Scalar(50));
  Track track;
  track.pixel = {15, 10};
  track.previous_pixel = {5, 10};
  const std::string message =
      tracks_message(GetParam(), timestamp_from_seconds(2), {"cam", Modality::Frames, image, {track}});
  const cv::Mat gray = read_image(reader(message)).image;
  EXPECT_EQ(gray.size(), image.size());
  EXPECT_EQ(gray.at<std::uint8_t>(0, 0), 50);
  EXPECT_NE(gray.at<std::uint8_t>(10, 8), 50);  // where it came from
  EXPECT_EQ(cv::countNonZero(image != 50), 0);
}

}  // namespace
}  // namespace edged::node
