// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Converts measurements to messages.
#include "edged/io/ros/ros_writer.hpp"

#include <map>

#include "edged/core/check.hpp"
#include "edged/io/ros/bag_writer.hpp"
#include "edged/io/ros/definitions.hpp"
#include "edged/io/ros/mcap_sink.hpp"
#include "edged/io/ros/wire_writer.hpp"
#include "edged/io/text_parsing.hpp"

namespace edged {
namespace {

class RosWriter final : public RecordingWriter {
 public:
  RosWriter(const WriterSetup& setup, std::unique_ptr<MessageSink> sink)
      : setup_(setup),
        name_(setup.path.string()),
        sensor_(setup.info.has_events ? setup.event_sensor() : cv::Size()),
        sink_(std::move(sink)) {}

  void write(const EventBatch& batch) override {
    if (batch.events.empty()) return;
    const Timestamp end = batch.events.back().t;
    check(batch.events.front().t);
    describe_camera(Modality::Events, "/dvs/camera_info", batch.camera, end);
    // A driver sends events after the last one has occurred.
    send("/dvs/events", "dvs_msgs/EventArray", end, event_array_message(sink_->wire(), batch, sensor_));
  }

  void write(const Frame& frame) override {
    check(frame.t);
    describe_camera(Modality::Frames, "/camera/camera_info", frame.camera, frame.t);
    send("/camera/image_raw", "sensor_msgs/Image", frame.t, image_message(sink_->wire(), frame));
  }

  void write(const ImuSample& sample) override {
    check(sample.t);
    send("/imu/data", "sensor_msgs/Imu", sample.t, imu_message(sink_->wire(), sample));
  }

  void write(const GroundTruth& truth) override {
    truth_ = truth;
    truth_.frame = setup_.name_when_read(truth.frame);
  }

  void finish() override {
    write_truth_until(Timestamp::max());
    sink_->finish();
  }

 private:
  void check(Timestamp t) const {
    if (t < Timestamp() || t > latest_stamp(sink_->wire()))
      throw InputError::format("{}: ROS messages cannot hold the stamp {} s; shift the recording's clock", name_,
                               format_seconds(t));
  }

  void send(std::string_view topic, std::string_view type, Timestamp t, std::string_view message) {
    check(t);
    write_truth_until(t);
    put(topic, type, t, message);
  }

  void put(std::string_view topic, std::string_view type, Timestamp t, std::string_view message) {
    auto place = topics_.find(topic);
    if (place == topics_.end())
      place = topics_.emplace(topic, sink_->add_topic(topic, type, definition_of(type, sink_->wire()))).first;
    sink_->write(place->second, t, message);
  }

  /// Poses are written between the measurements, so that the messages of the file are in order.
  void write_truth_until(Timestamp t) {
    const Trajectory& poses = truth_.trajectory;
    for (; next_pose_ < poses.size() && poses[next_pose_].t <= t; ++next_pose_) {
      check(poses[next_pose_].t);
      put("/ground_truth/pose", "geometry_msgs/TransformStamped", poses[next_pose_].t,
          transform_message(sink_->wire(), poses[next_pose_], truth_.frame));
    }
  }

  /// Written once for each camera, before its first measurement.
  void describe_camera(Modality modality, std::string_view topic, const std::string& name, Timestamp t) {
    if (!setup_.calibration || topics_.contains(topic)) return;
    if (const RigCamera* camera = setup_.calibration->rig.find(modality))
      send(topic, "sensor_msgs/CameraInfo", t, camera_info_message(sink_->wire(), t, name, camera->model));
  }

  WriterSetup setup_;
  std::string name_;
  cv::Size sensor_;
  std::unique_ptr<MessageSink> sink_;
  std::map<std::string, std::size_t, std::less<>> topics_;
  GroundTruth truth_;
  std::size_t next_pose_ = 0;
};

}  // namespace

std::unique_ptr<RecordingWriter> write_ros1_bag(const WriterSetup& setup) {
  return std::make_unique<RosWriter>(setup, std::make_unique<BagWriter>(setup.path));
}

std::unique_ptr<RecordingWriter> write_mcap(const WriterSetup& setup) {
  return std::make_unique<RosWriter>(setup, std::make_unique<McapSink>(setup.path));
}

}  // namespace edged
