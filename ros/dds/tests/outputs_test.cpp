// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the node publishes, decoded by Cyclone with the types of messages.idl.
#include <messages.h>

#include <gmock/gmock.h>

#include "dds_test_support.hpp"
#include "node/messages.hpp"

namespace edged::ros2 {
namespace {

using ::testing::ElementsAre;

constexpr Timestamp kOutputTime = timestamp_from_ns(1'700'000'000'123'456'789);
const node::Format kFormat{};  // of ROS 2, frames map, odom and body

node::Estimate some_estimate() {
  node::Estimate estimate;
  estimate.state.t = kOutputTime;
  estimate.state.T_W_B = SE3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(1, 2, 3));
  estimate.state.v_W = Eigen::Vector3d(4, 5, 6);
  estimate.gyro_B = Eigen::Vector3d(0.1, 0.2, 0.3);
  estimate.covariance = StateCovariance{Eigen::Matrix3d::Identity() * 7, Eigen::Matrix3d::Identity() * 8,
                                        Eigen::Matrix3d::Identity() * 9};
  return estimate;
}

class Ros2Outputs : public ::testing::Test {
 protected:
  /// The message as a typed reader of that topic gets it.
  template <typename T>
  const T* passed(TypedPeer<T>& peer, std::string_view type, const std::string& message) {
    const Writer writer(participant_, "/out", type, {});
    peer.read();
    EXPECT_TRUE(eventually([&] { return writer.readers() == 1; }));
    EXPECT_TRUE(writer.write(message));
    return peer.take();
  }
  static void expect_header(const std_msgs_msg_dds__Header_& header, const char* frame) {
    EXPECT_EQ(header.stamp.sec, 1'700'000'000);
    EXPECT_EQ(header.stamp.nanosec, 123'456'789U);
    EXPECT_STREQ(header.frame_id, frame);
  }

  Participant participant_{test_discovery()};
};

TEST_F(Ros2Outputs, Odometry) {
  TypedPeer<nav_msgs_msg_dds__Odometry_> peer("/out", nav_msgs_msg_dds__Odometry__desc);
  const auto* odometry = passed(peer, "nav_msgs/Odometry", node::odometry_message(kFormat, some_estimate()));
  ASSERT_TRUE(odometry);
  expect_header(odometry->header, "odom");
  EXPECT_STREQ(odometry->child_frame_id, "body");
  EXPECT_EQ(odometry->pose.pose.position.z, 3.0);
  EXPECT_EQ(odometry->pose.pose.orientation.w, 1.0);
  EXPECT_EQ(odometry->pose.covariance[7], 7.0);
  EXPECT_EQ(odometry->pose.covariance[35], 8.0);
  EXPECT_EQ(odometry->twist.twist.linear.y, 5.0);
  EXPECT_EQ(odometry->twist.twist.angular.z, 0.3);
  EXPECT_EQ(odometry->twist.covariance[14], 9.0);
}

TEST_F(Ros2Outputs, PoseWithCovariance) {
  TypedPeer<geometry_msgs_msg_dds__PoseWithCovarianceStamped_> peer(
      "/out", geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc);
  const auto* pose =
      passed(peer, "geometry_msgs/PoseWithCovarianceStamped", node::pose_message(kFormat, some_estimate()));
  ASSERT_TRUE(pose);
  expect_header(pose->header, "map");
  EXPECT_EQ(pose->pose.pose.position.y, 2.0);
  EXPECT_EQ(pose->pose.covariance[0], 7.0);
}

TEST_F(Ros2Outputs, Path) {
  TypedPeer<nav_msgs_msg_dds__Path_> peer("/out", nav_msgs_msg_dds__Path__desc);
  const SE3 T = some_estimate().state.T_W_B;
  const auto* path =
      passed(peer, "nav_msgs/Path", node::path_message(kFormat, kOutputTime, {{kOutputTime, SE3()}, {kOutputTime, T}}));
  ASSERT_TRUE(path);
  expect_header(path->header, "map");
  ASSERT_EQ(path->poses._length, 2U);
  expect_header(path->poses._buffer[1].header, "map");
  EXPECT_EQ(path->poses._buffer[1].pose.position.x, 1.0);
}

TEST_F(Ros2Outputs, Transforms) {
  TypedPeer<tf2_msgs_msg_dds__TFMessage_> peer("/out", tf2_msgs_msg_dds__TFMessage__desc);
  const std::vector<node::FrameTransform> sent{
      {"body", "dvs", SE3(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, 0, 0.1))}};
  const auto* tf = passed(peer, "tf2_msgs/TFMessage", node::transforms_message(Wire::Cdr, kOutputTime, sent));
  ASSERT_TRUE(tf);
  ASSERT_EQ(tf->transforms._length, 1U);
  expect_header(tf->transforms._buffer[0].header, "body");
  EXPECT_STREQ(tf->transforms._buffer[0].child_frame_id, "dvs");
  EXPECT_EQ(tf->transforms._buffer[0].transform.translation.z, 0.1);
  EXPECT_EQ(tf->transforms._buffer[0].transform.rotation.w, 1.0);
}

TEST_F(Ros2Outputs, Landmarks) {
  TypedPeer<sensor_msgs_msg_dds__PointCloud2_> peer("/out", sensor_msgs_msg_dds__PointCloud2__desc);
  const std::vector<Landmark> landmarks = {{7, {1, 2, 3}}, {9, {4, 5, 6}}};
  const auto* cloud = passed(peer, "sensor_msgs/PointCloud2", node::landmarks_message(kFormat, kOutputTime, landmarks));
  ASSERT_TRUE(cloud);
  expect_header(cloud->header, "map");
  EXPECT_EQ(cloud->height, 1U);
  EXPECT_EQ(cloud->width, 2U);
  ASSERT_EQ(cloud->fields._length, 4U);
  EXPECT_STREQ(cloud->fields._buffer[2].name, "z");
  EXPECT_EQ(cloud->fields._buffer[2].offset, 8U);
  EXPECT_EQ(cloud->fields._buffer[3].datatype, 6);
  EXPECT_EQ(cloud->fields._buffer[3].count, 1U);
  EXPECT_FALSE(cloud->is_bigendian);
  EXPECT_EQ(cloud->point_step, 16U);
  EXPECT_EQ(cloud->row_step, 32U);
  ASSERT_EQ(cloud->data._length, 32U);
  float y = 0;
  std::memcpy(&y, cloud->data._buffer + 20, sizeof y);
  EXPECT_EQ(y, 5.0F);
  EXPECT_EQ(cloud->data._buffer[28], 9);
  EXPECT_TRUE(cloud->is_dense);
}

TEST_F(Ros2Outputs, OccupancyGrid) {
  TypedPeer<nav_msgs_msg_dds__OccupancyGrid_> peer("/out", nav_msgs_msg_dds__OccupancyGrid__desc);
  OccupancySlice slice{cv::Mat(2, 3, CV_8SC1, cv::Scalar(OccupancySlice::kUnknown)), {-1.0, 2.0}};
  slice.cells.at<schar>(0, 1) = OccupancySlice::kOccupied;
  slice.cells.at<schar>(1, 2) = OccupancySlice::kFree;
  const auto* grid = passed(peer, "nav_msgs/OccupancyGrid", node::occupancy_message(kFormat, kOutputTime, slice, 0.05));
  ASSERT_TRUE(grid);
  expect_header(grid->header, "map");
  EXPECT_EQ(grid->info.map_load_time.nanosec, 123'456'789U);
  EXPECT_EQ(grid->info.resolution, 0.05F);
  EXPECT_EQ(grid->info.width, 3U);
  EXPECT_EQ(grid->info.height, 2U);
  EXPECT_EQ(grid->info.origin.position.x, -1.0);
  EXPECT_EQ(grid->info.origin.position.y, 2.0);
  EXPECT_EQ(grid->info.origin.orientation.w, 1.0);
  ASSERT_EQ(grid->data._length, 6U);
  EXPECT_THAT(std::vector<int>(grid->data._buffer, grid->data._buffer + 6), ElementsAre(-1, 100, -1, -1, -1, 0));
}

TEST_F(Ros2Outputs, Octomap) {
  TypedPeer<octomap_msgs_msg_dds__Octomap_> peer("/out", octomap_msgs_msg_dds__Octomap__desc);
  octomap::OcTree tree(0.05);
  tree.updateNode(octomap::point3d(1.0F, 2.0F, 3.0F), true);
  const auto* map = passed(peer, "octomap_msgs/Octomap", node::octomap_message(kFormat, kOutputTime, tree));
  ASSERT_TRUE(map);
  expect_header(map->header, "map");
  EXPECT_TRUE(map->binary);
  EXPECT_STREQ(map->id, "OcTree");
  EXPECT_EQ(map->resolution, 0.05);
  std::ostringstream voxels;
  tree.writeBinaryData(voxels);
  EXPECT_EQ(std::string(reinterpret_cast<const char*>(map->data._buffer), map->data._length), voxels.str());
}

TEST_F(Ros2Outputs, TrackedImages) {
  TypedPeer<sensor_msgs_msg_dds__Image_> peer("/out", sensor_msgs_msg_dds__Image__desc);
  const CameraStep camera{"cam", Modality::Frames, cv::Mat(20, 30, CV_8UC1, cv::Scalar(50))};
  const auto* image = passed(peer, "sensor_msgs/Image", node::tracks_message(kFormat, kOutputTime, camera));
  ASSERT_TRUE(image);
  expect_header(image->header, "cam");
  EXPECT_EQ(image->height, 20U);
  EXPECT_EQ(image->width, 30U);
  EXPECT_STREQ(image->encoding, "bgr8");
  EXPECT_EQ(image->is_bigendian, 0);
  EXPECT_EQ(image->step, 90U);
  ASSERT_EQ(image->data._length, 1800U);
  EXPECT_EQ(image->data._buffer[1799], 50);
}

TEST_F(Ros2Outputs, Diagnostics) {
  TypedPeer<diagnostic_msgs_msg_dds__DiagnosticArray_> peer("/out", diagnostic_msgs_msg_dds__DiagnosticArray__desc);
  const node::Diagnosis diagnosis{node::Diagnosis::Level::Warning, "Degraded", {{"packets", "3"}, {"late", "4"}}};
  const auto* array = passed(peer, "diagnostic_msgs/DiagnosticArray",
                             node::diagnostics_message(Wire::Cdr, kOutputTime, "rig", diagnosis));
  ASSERT_TRUE(array);
  expect_header(array->header, "");
  ASSERT_EQ(array->status._length, 1U);
  const auto& status = array->status._buffer[0];
  EXPECT_EQ(status.level, 1);
  EXPECT_STREQ(status.name, "edged: odometry");
  EXPECT_STREQ(status.message, "Degraded");
  EXPECT_STREQ(status.hardware_id, "rig");
  ASSERT_EQ(status.values._length, 2U);
  EXPECT_STREQ(status.values._buffer[1].key, "late");
  EXPECT_STREQ(status.values._buffer[1].value, "4");
}

TEST_F(Ros2Outputs, OdometryOfPx4) {
  TypedPeer<px4_msgs_msg_dds__VehicleOdometry_> peer("/out", px4_msgs_msg_dds__VehicleOdometry__desc);
  const VehicleOdometry sent{
      1, 2, 3, {0, 1, 2}, {3, 4, 5, 6}, 4, {7, 8, 9}, {10, 11, 12}, {13, 14, 15}, {16, 17, 18}, {19, 20, 21}, 5, 6};
  const auto* odometry = passed(peer, "px4_msgs/VehicleOdometry", node::vehicle_odometry_message(sent));
  ASSERT_TRUE(odometry);
  EXPECT_EQ(odometry->timestamp_sample, 2U);
  EXPECT_EQ(odometry->pose_frame, 3);
  EXPECT_THAT(odometry->q, ElementsAre(3, 4, 5, 6));
  EXPECT_EQ(odometry->velocity_frame, 4);
  EXPECT_THAT(odometry->velocity_variance, ElementsAre(19, 20, 21));
  EXPECT_EQ(odometry->reset_counter, 5);
  EXPECT_EQ(odometry->quality, 6);
}

}  // namespace
}  // namespace edged::ros2
