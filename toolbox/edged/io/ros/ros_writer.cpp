// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/ros/ros.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/io/parse/text_parsing.hpp"
#include "edged/io/ros/bag/message_records.hpp"
#include "edged/io/ros/messages/messages.hpp"

namespace edged {
namespace {

class RosWriter final : public RecordingWriter {
 public:
  RosWriter(const WriterSetup& setup, std::unique_ptr<MessageSink> sink) : setup_(setup), sink_(std::move(sink)) {
    for (std::size_t i = 0; setup.info.has_events && i < setup.cameras(Modality::Events); ++i)
      sensors_.push_back(setup.event_sensor(i));
  }

  void write(const EventBatch& batch) override {
    if (batch.events.empty()) return;
    const Timestamp end = batch.events.back().t;
    check(batch.events.front().t);
    const std::size_t camera = setup_.place_of(batch.camera, Modality::Events);
    const std::string name_space = "/dvs" + number(camera);
    describe_camera(Modality::Events, name_space, batch.camera, end);
    // A driver sends events after the last one has occurred.
    send(name_space + "/events", "dvs_msgs/EventArray", end,
         event_array_message(sink_->wire(), batch, sensors_[camera]));
  }

  void write(const Frame& frame) override {
    check(frame.t);
    const std::string name_space = "/camera" + number(setup_.place_of(frame.camera, Modality::Frames));
    describe_camera(Modality::Frames, name_space, frame.camera, frame.t);
    send(name_space + "/image_raw", "sensor_msgs/Image", frame.t, image_message(sink_->wire(), frame));
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
    if (t < Timestamp())
      throw InputError::format(
          "{}: ROS messages hold no stamp before zero, as {} s: add --from {:.3f}, which leaves out "
          "what is earlier",
          setup_.path.string(), format_seconds(t), 0.001 - to_seconds(t));
    if (t > latest_stamp(sink_->wire()))
      throw InputError::format("{}: ROS messages cannot hold the stamp {} s; shift the recording's clock",
                               setup_.path.string(), format_seconds(t));
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

  /// "/dvs/events", "/dvs2/events".
  static std::string number(std::size_t camera) { return camera == 0 ? "" : std::to_string(camera + 1); }

  /// Written once for each camera, before its first measurement.
  void describe_camera(Modality modality, const std::string& name_space, const std::string& name, Timestamp t) {
    const std::string topic = name_space + "/camera_info";
    if (!setup_.calibration || topics_.contains(topic)) return;
    const std::vector<RigCamera>& cameras = setup_.calibration->rig.cameras;
    const auto named = std::ranges::find(cameras, name, &RigCamera::name);
    const RigCamera* only = setup_.place_of(name, modality) == 0 ? setup_.calibration->rig.find(modality) : nullptr;
    const RigCamera* camera = named != cameras.end() ? &*named : only;
    if (camera && camera->modality == modality)
      send(topic, "sensor_msgs/CameraInfo", t, camera_info_message(sink_->wire(), t, name, camera->model));
  }

  WriterSetup setup_;
  std::vector<cv::Size> sensors_;
  std::unique_ptr<MessageSink> sink_;
  std::map<std::string, std::size_t, std::less<>> topics_;
  GroundTruth truth_;
  std::size_t next_pose_ = 0;
};

}  // namespace

std::unique_ptr<RecordingWriter> write_ros1_bag(const WriterSetup& setup) {
  return std::make_unique<RosWriter>(setup, create_ros1_bag(setup.path));
}

std::unique_ptr<RecordingWriter> write_mcap(const WriterSetup& setup) {
  return std::make_unique<RosWriter>(setup, std::make_unique<McapWriter>(setup.path, "ros2"));
}

}  // namespace edged
