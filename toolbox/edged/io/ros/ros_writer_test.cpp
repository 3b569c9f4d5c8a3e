// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Written bags: their content besides the measurements, and their check by the tools of ROS.
#include "edged/io/ros/ros.hpp"

#include <gmock/gmock.h>

#include <cstdio>

#include "edged/io/calibration.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/ros/bag/bag_test_support.hpp"
#include "edged/io/ros/bag/open_messages.hpp"
#include "edged/io/write_recording.hpp"

namespace edged {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// The poses of that frame, beside one event and one IMU sample.
ListedDataset with_truth(const std::string& frame, Timestamp t = timestamp_from_seconds(5)) {
  ListedDataset source = random_dataset(Duration(1));
  source.measurements = {EventBatch{"left", {{t, 3, 4, true}}}, ImuSample{t + Duration(7), {1, 2, 3}, {4, 5, 6}}};
  source.truth = GroundTruth{{{t - std::chrono::seconds(1), SE3(Eigen::Quaterniond(1, 0, 0, 0), {1, 2, 3})},
                              {t + std::chrono::seconds(1), SE3(Eigen::Quaterniond(0, 1, 0, 0), {4, 5, 6})}},
                             frame};
  return source;
}

TEST(RosWriter, GroundTruthComesBackAsThatOfItsFrame) {
  Calibration calibration = load_rig("davis240c_ecd");
  calibration.rig.cameras[0].name = "left";
  for (const char* format : {"bag", "mcap"})
    for (const auto& [frame, read] :
         {std::pair("body", "body"), std::pair("events", "events"), std::pair("left", "events")}) {
      TempFolder folder;
      ListedDataset source = with_truth(frame);
      const fs::path file = folder.path() / "out";
      write_recording(source, writable_format(format, file), file, calibration);
      const auto truth = open_recording(file).dataset->ground_truth();
      ASSERT_TRUE(truth);
      EXPECT_EQ(truth->frame, read);
      ASSERT_EQ(truth->trajectory.size(), 2u);
      EXPECT_EQ(truth->trajectory[1].t, source.truth->trajectory[1].t);
      EXPECT_EQ(truth->trajectory[1].T.translation(), Eigen::Vector3d(4, 5, 6));
    }
}

TEST(RosWriter, IntrinsicsComeBack) {
  TempFolder folder;
  ListedDataset source = random_dataset(Duration(1));
  const fs::path file = folder.path() / "out.bag";
  const Calibration rig = load_rig("davis240c_ecd");
  write_recording(source, writable_format("", file), file, rig);
  const auto calibration = open_recording(file).calibration;
  ASSERT_TRUE(calibration);
  EXPECT_FALSE(calibration->has_extrinsics);
  EXPECT_EQ(calibration->rig.camera("events").model, rig.rig.find(Modality::Events)->model);
  EXPECT_EQ(calibration->rig.camera("frames").model, rig.rig.find(Modality::Frames)->model);
}

TEST(RosWriter, StampsThatRosCannotHoldAreRefused) {
  for (const char* format : {"bag", "mcap"})
    for (const std::int64_t s : {std::int64_t{-1}, std::int64_t{5'000'000'000}}) {
      TempFolder folder;
      ListedDataset source = with_truth("body", timestamp_from_seconds(static_cast<double>(s)));
      const fs::path file = folder.path() / "out";
      EXPECT_THAT(
          input_error([&] { write_recording(source, writable_format(format, file), file, load_rig("davis240c_ecd")); }),
          HasSubstr(s < 0 ? "add --from 1.001" : "shift the recording's clock"));
    }
}

/// Output of tests/program/bag_oracle.py, which uses the reader and writer of ROS.
std::string oracle(const std::string& arguments) {
  const std::string command =
      std::string("/usr/bin/python3 " EDGED_SOURCE_DIR "/tests/program/bag_oracle.py ") + arguments + " 2>&1";
  std::string text;
  FILE* pipe = ::popen(command.c_str(), "r");
  char piece[4096];
  while (const std::size_t n = std::fread(piece, 1, sizeof piece, pipe)) text.append(piece, n);
  return ::pclose(pipe) == 0 ? text : "FAILED: " + text;
}

bool no_oracle() { return oracle("--version").starts_with("FAILED"); }

/// The output of the oracle for a message.
std::string line_of(const Topic& topic, ByteSpan data) {
  std::string line = topic.name + " " + topic.type + " ";
  for (const std::uint8_t byte : data) line += fmt::format("{:02x}", byte);
  return line + "\n";
}

std::string our_lines(const fs::path& file) {
  const auto source = open_messages(file, nullptr);
  std::string lines;
  while (const auto message = source->next()) lines += line_of(source->topics()[message->topic], message->data);
  return lines;
}

TEST(BagOracle, ReadsWhatWeWriteMessageForMessageAndAgreesWithItsDefinitions) {
  if (no_oracle()) GTEST_SKIP() << "no python3-rosbag (Debian), which reads bags as ROS does";
  for (const std::size_t container : {0u, 1u}) {
    TempFolder folder;
    SmallBag bag(Wire::Ros1);
    bag.topics.push_back(
        {"/dvs/camera_info",
         "sensor_msgs/CameraInfo",
         {{timestamp_from_seconds(100), camera_info_message(Wire::Ros1, timestamp_from_seconds(100), "events",
                                                            load_rig("davis240c_ecd").rig.cameras[0].model)}},
         definition_of("sensor_msgs/CameraInfo", Wire::Ros1)});
    const fs::path file = write_bag(folder, kBagContainers[container], bag.topics);
    const std::string lines = oracle("dump " + file.string());
    EXPECT_TRUE(lines == our_lines(file)) << lines.substr(0, 2000);
    // Field by field, by the definitions that we write.
    const std::string fields = oracle("fields " + file.string());
    EXPECT_THAT(fields, HasSubstr("/dvs/events header.stamp=100000000000 width=346 height=260 events=50"));
    EXPECT_THAT(fields, HasSubstr("/camera/image_raw header.stamp=100000000000 mono8 30x20 step=30 first=0"));
    EXPECT_THAT(fields,
                HasSubstr("/imu/data header.stamp=100035000000 gyro=0.7000000000000001,0.3333333333333333,-2.0"));
    EXPECT_THAT(fields,
                HasSubstr("/pose header.stamp=100000000000 world body 0.0,0.3333333333333333,-2.0 0.0,0.6,0.0,0.8"));
    EXPECT_THAT(fields, HasSubstr("/dvs/camera_info header.stamp=100000000000 240x180 plumb_bob"));
  }
}

TEST(BagOracle, AgreesWithTheDefinitionsOfTheEventMessagesOfDrivers) {
  if (no_oracle()) GTEST_SKIP() << "no python3-rosbag (Debian), which reads bags as ROS does";
  const TempFolder folder;
  const Timestamp t = timestamp_from_seconds(100);
  const auto topic = [&](const char* name, const char* type, const std::string& message) {
    return TestTopic{name, type, {{t, message}}, definition_of(type, Wire::Ros1)};
  };
  const fs::path file = write_bag(
      folder, kBagContainers[0],
      {topic("/a", "prophesee_event_msgs/EventArray", event_array_message(Wire::Ros1, bag_events(t, 7, 1), kBagSensor)),
       topic("/b", "event_camera_msgs/EventPacket", event_packet_message(Wire::Ros1, t, 5, 6, "evt3", "12345678"))});
  const std::string fields = oracle("fields " + file.string());  // checks the md5 sums, too
  EXPECT_THAT(fields, HasSubstr("/a header.stamp=100000000000 width=346 height=260 events=7"));
  EXPECT_THAT(fields, HasSubstr("/b header.stamp=100000000000 evt3 width=346 height=260 seq=5 time_base=6 bytes=8"));
}

TEST(BagOracle, WritesWhatWeReadMessageForMessageInEveryCompression) {
  if (no_oracle()) GTEST_SKIP() << "no python3-rosbag (Debian), which writes bags as ROS does";
  TempFolder folder;
  const SmallBag bag(Wire::Ros1);
  const fs::path ours = write_bag(folder, kBagContainers[0], bag.topics);
  for (const std::string compression : {"none", "bz2", "lz4"}) {
    const fs::path theirs = folder.path() / (compression + ".bag");
    EXPECT_EQ(oracle("rewrite " + ours.string() + " " + theirs.string() + " " + compression), "");
    EXPECT_TRUE(our_lines(theirs) == our_lines(ours)) << compression;
    const Recording r = open_recording(theirs);
    EXPECT_TRUE(read_all(*r.dataset).events == bag.events);
    EXPECT_TRUE(r.dataset->repairs().empty());
  }
}

}  // namespace
}  // namespace edged
