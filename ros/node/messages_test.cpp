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

TEST_P(RosMessages, OdometryHasThePoseInOdomAndTheVelocitiesInTheBase) {
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

TEST_P(RosMessages, TransformsHaveParentsAndChildren) {
  const std::vector<FrameTransform> tree{{"map", "odom", SE3()},
                                         {"odom", "base_link", SE3(Eigen::Quaterniond::Identity(), {1.0, 2.0, 3.0})}};
  const std::string message = transforms_message(GetParam(), timestamp_from_seconds(2), tree);
  WireReader transforms = reader(message);
  EXPECT_EQ(transforms.number<std::uint32_t>(), 2U);
  EXPECT_EQ(transforms.header(), timestamp_from_seconds(2));
  EXPECT_EQ(transforms.text(), "odom");
  EXPECT_EQ(transforms.vector<7>()[6], 1.0);
  transforms.header();
  EXPECT_EQ(transforms.text(), "base_link");
  EXPECT_EQ(transforms.vector<3>().z(), 3.0);
}

// On an arm of 1 m along the body's x, turned by 90 degrees about z: its x points along the body's y.
const SE3 kArm(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())), Eigen::Vector3d(1, 0, 0));

TEST(Estimates, OfAnotherFrameOnTheBodyHaveItsPoseAndMotion) {
  Estimate body = turned_estimate();
  body.gyro_B = Eigen::Vector3d(0.1, 0.0, 2.0);  // less the bias: 2 rad/s about z
  const Estimate base = at(kArm, body);
  EXPECT_TRUE(base.state.T_W_B.translation().isApprox(Eigen::Vector3d(1, 3, 3)));
  EXPECT_TRUE(base.state.v_W.isApprox(Eigen::Vector3d(-2, 5, 0))) << base.state.v_W.transpose();
  EXPECT_TRUE(base.gyro_B.isApprox(Eigen::Vector3d(0, 0, 2)));
}

TEST(Estimates, OfAnotherFrameAreAsUncertainAsTheArmIsTurned) {
  Estimate body = turned_estimate();
  body.gyro_B.x() = body.state.bias_gyro.x();
  body.covariance =
      StateCovariance{Eigen::Matrix3d::Zero(), Eigen::Vector3d(1, 2, 3).asDiagonal(), Eigen::Matrix3d::Zero()};
  const Estimate base = at(kArm, body);
  // Turned about the body's y and z, the end of the arm moves along its z and y: the world's z and -x.
  EXPECT_TRUE(base.covariance->position.isApprox(Eigen::Vector3d(3, 0, 2).asDiagonal().toDenseMatrix()));
  EXPECT_TRUE(base.covariance->rotation.isApprox(Eigen::Vector3d(2, 1, 3).asDiagonal().toDenseMatrix()));
  EXPECT_TRUE(base.covariance->velocity.isZero(1e-12));
}

TEST(Estimates, InAnotherFrameOfTheWorldAreTurnedWithIt) {
  const SE3 T_V_W(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())), Eigen::Vector3d(10, 0, 0));
  Estimate estimate = turned_estimate();
  estimate.covariance = StateCovariance{Eigen::Vector3d(1, 2, 3).asDiagonal(), Eigen::Matrix3d::Identity(),
                                        Eigen::Vector3d(4, 5, 6).asDiagonal()};
  const Estimate moved = in(T_V_W, estimate);
  EXPECT_TRUE(moved.state.T_W_B.translation().isApprox(Eigen::Vector3d(8, 1, 3)));
  EXPECT_TRUE(moved.state.v_W.isApprox(Eigen::Vector3d(-5, 0, 0)));
  EXPECT_NEAR(moved.covariance->position(0, 0), 2.0, 1e-12);
  EXPECT_NEAR(moved.covariance->velocity(1, 1), 4.0, 1e-12);
}

TEST_P(RosMessages, TracksAreRenderedOnACopyOfTheImage) {
  const cv::Mat image(20, 30, CV_8UC1, cv::Scalar(50));
  Track track;
  track.pixel = {15, 10};
  track.previous_pixel = {5, 10};
  const std::string message =
      tracks_message({GetParam()}, timestamp_from_seconds(2), {"cam", Modality::Frames, image, {track}});
  const cv::Mat gray = read_image(reader(message)).image;
  EXPECT_EQ(gray.size(), image.size());
  EXPECT_EQ(gray.at<std::uint8_t>(0, 0), 50);
  EXPECT_NE(gray.at<std::uint8_t>(10, 8), 50);  // where it came from
  EXPECT_EQ(cv::countNonZero(image != 50), 0);
}

}  // namespace
}  // namespace edged::node
