// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// For tests: a driver of event camera, camera and IMU on Fast DDS.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "edged/io/parse/evt.hpp"
#include "edged/measurement.hpp"
#include "fast_peer.hpp"

namespace edged::fast {

using Options = std::map<std::string, std::string>;

inline double number_of(const Options& options, const std::string& key, double otherwise) {
  const auto found = options.find(key);
  return found == options.end() ? otherwise : std::stod(found->second);
}

inline std::string image_bytes(const Frame& frame, Timestamp t) {
  Encoder out(frame.image.total() + 256);
  out.header(to_ns(t), frame.camera);
  out << static_cast<std::uint32_t>(frame.image.rows) << static_cast<std::uint32_t>(frame.image.cols)
      << std::string("mono8") << std::uint8_t{0} << static_cast<std::uint32_t>(frame.image.cols);
  const cv::Mat image = frame.image.isContinuous() ? frame.image : frame.image.clone();
  out << std::vector<std::uint8_t>(image.data, image.data + image.total());
  return out.bytes();
}

inline std::string imu_bytes(const ImuSample& sample, Timestamp t) {
  Encoder out(1024);
  out.header(to_ns(t), "imu");
  out.doubles({0, 0, 0, 1, -1});
  out.zeros(8);
  out.doubles({sample.gyro_B.x(), sample.gyro_B.y(), sample.gyro_B.z()});
  out.zeros(9);
  out.doubles({sample.accel_B.x(), sample.accel_B.y(), sample.accel_B.z()});
  out.zeros(9);
  return out.bytes();
}

/// Event camera, camera and IMU.
class Driver {
 public:
  static int readers(dds::DataWriter* writer) {
    dds::PublicationMatchedStatus status;
    writer->get_publication_matched_status(status);
    return status.current_count;
  }

  Driver(Participant& participant, const Options& options)
      : skip_(static_cast<std::uint64_t>(number_of(options, "skip", 0))) {
    const bool reliable = number_of(options, "reliable", 0) > 0;
    events_ = participant.writer("/events", "event_camera_msgs::msg::dds_::EventPacket_", {reliable, false, 1000});
    image_ = participant.writer("/image", "sensor_msgs::msg::dds_::Image_", {reliable, false, 10});
    imu_ = participant.writer("/imu", "sensor_msgs::msg::dds_::Imu_", {reliable, false, 1000});
  }

  void set_clock(Duration by) { set_by_ = by; }
  bool is_subscribed(int nodes) const {
    return readers(events_) >= nodes && readers(image_) >= nodes && readers(imu_) >= nodes;
  }

  void send(const Measurement& measurement, cv::Size sensor) {
    if (const auto* batch = std::get_if<EventBatch>(&measurement)) {
      for (std::size_t begin = 0, end = 0; begin < batch->events.size(); begin = end) {
        const Timestamp first = batch->events[begin].t;
        while (end < batch->events.size() && batch->events[end].t - first < std::chrono::milliseconds(1)) ++end;
        send_packet(std::span(batch->events).subspan(begin, end - begin), sensor);
      }
    } else if (const auto* frame = std::get_if<Frame>(&measurement)) {
      write(image_, image_bytes(*frame, frame->t + set_by_));
    } else if (const auto* sample = std::get_if<ImuSample>(&measurement)) {
      write(imu_, imu_bytes(*sample, sample->t + set_by_));
    }
  }

 private:
  static void write(dds::DataWriter* writer, std::string bytes) { writer->write(&bytes); }

  void send_packet(std::span<const Event> events, cv::Size sensor) {
    const std::string& evt3 = encoder_.encode(events);
    const std::uint64_t sequence = sequence_++;
    if (skip_ > 0 && sequence % skip_ == skip_ - 1) return;  // lost on the way
    Encoder out(evt3.size() + 256);
    out.header(to_ns(events.front().t + set_by_), "event_camera");
    out << static_cast<std::uint32_t>(sensor.height) << static_cast<std::uint32_t>(sensor.width) << sequence
        << static_cast<std::uint64_t>(to_ns(events.front().t)) << std::string("evt3") << false
        << std::vector<std::uint8_t>(evt3.begin(), evt3.end());
    write(events_, out.bytes());
  }

  const std::uint64_t skip_;
  Duration set_by_{0};  ///< the clock of the stamps, against that of the event camera
  dds::DataWriter *events_, *image_, *imu_;
  EvtEncoder encoder_{EvtFormat::Evt3};
  std::uint64_t sequence_ = 0;
};

}  // namespace edged::fast
