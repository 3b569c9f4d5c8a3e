// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes messages field by field, in the order of their definitions.
#include "edged/io/ros/messages/wire_writer.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "edged/camera/lens_table.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;

template <std::size_t N>
constexpr std::array<double, N> kZeros{};

}  // namespace

WireWriter::WireWriter(Wire wire) : wire_(wire) {
  if (wire == Wire::Cdr) out_.assign({0, 1, 0, 0});  // plain, little-endian
}

void WireWriter::numbers(std::span<const double> values) {
  for (const double value : values) number(value);
}

void WireWriter::text(std::string_view value) {
  const std::size_t terminator = wire_ == Wire::Cdr ? 1 : 0;
  number(static_cast<std::uint32_t>(value.size() + terminator));
  out_ += value;
  out_.append(terminator, '\0');
}

void WireWriter::bytes(ByteSpan value) {
  number(static_cast<std::uint32_t>(value.size()));
  out_ += as_text(value);
}

Timestamp latest_stamp(Wire wire) {
  const std::int64_t s = wire == Wire::Cdr ? std::numeric_limits<std::int32_t>::max()
                                           : std::int64_t{std::numeric_limits<std::uint32_t>::max()};
  return timestamp_from_ns(s * kSecondNs + kSecondNs - 1);
}

void WireWriter::time(Timestamp t) {
  EDGED_CHECK(to_ns(t) >= 0 && t <= latest_stamp(wire_), "stamp {} ns", to_ns(t));
  number(static_cast<std::uint32_t>(to_ns(t) / kSecondNs));
  number(static_cast<std::uint32_t>(to_ns(t) % kSecondNs));
}

void WireWriter::header(Timestamp stamp, std::string_view frame_id) {
  if (wire_ == Wire::Ros1) number(std::uint32_t{0});  // seq
  time(stamp);
  text(frame_id);
}

std::string event_array_message(Wire wire, const EventBatch& batch, cv::Size sensor) {
  WireWriter out(wire);
  out.header(batch.events.front().t, batch.camera);
  out.number(static_cast<std::uint32_t>(sensor.height));
  out.number(static_cast<std::uint32_t>(sensor.width));
  out.number(static_cast<std::uint32_t>(batch.events.size()));
  for (const Event& event : batch.events) {
    out.number(event.x);
    out.number(event.y);
    out.time(event.t);
    out.number<std::uint8_t>(event.positive ? 1 : 0);
  }
  return out.message();
}

std::string event_packet_message(Wire wire, const EventPacket& packet, std::string_view camera) {
  WireWriter out(wire);
  out.header(packet.stamp, camera);
  out.number(packet.height);
  out.number(packet.width);
  out.number(packet.sequence);
  out.number(packet.time_base);
  out.text(packet.encoding);
  out.number(std::uint8_t{0});  // little-endian
  out.bytes(packet.events);
  return out.message();
}

std::string image_message(Wire wire, const Frame& frame) {
  const cv::Mat image = frame.image.isContinuous() ? frame.image : frame.image.clone();
  WireWriter out(wire);
  out.header(frame.t, frame.camera);
  out.number(static_cast<std::uint32_t>(image.rows));
  out.number(static_cast<std::uint32_t>(image.cols));
  out.text("mono8");
  out.number(std::uint8_t{0});  // little-endian
  out.number(static_cast<std::uint32_t>(image.cols));
  out.bytes({image.data, image.total()});
  return out.message();
}

std::string imu_message(Wire wire, const ImuSample& sample) {
  WireWriter out(wire);
  out.header(sample.t, "body");
  out.numbers(std::array{0.0, 0.0, 0.0, 1.0});
  out.number(-1.0);  // a covariance that begins with -1: no orientation
  out.numbers(kZeros<8>);
  out.numbers({sample.gyro_B.data(), 3});
  out.numbers(kZeros<9>);
  out.numbers({sample.accel_B.data(), 3});
  out.numbers(kZeros<9>);
  return out.message();
}

std::string external_message(Wire wire, const ExternalSample& sample) {
  WireWriter out(wire);
  if (const auto* height = std::get_if<HeightSample>(&sample)) {
    const AirPressure pressure = pressure_of_height(*height);
    out.header(height->t, "body");
    out.numbers(std::array{pressure.pressure_pa, pressure.variance_pa2});
    return out.message();
  }
  constexpr double kNotMeasured = 1e6;  // a variance [m^2/s^2], by the convention of drivers
  const auto& velocity = std::get<VelocitySample>(sample);
  std::array<double, 36> covariance{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double sigma = velocity.sigma[static_cast<Eigen::Index>(axis)];
    covariance[7 * axis] = std::isfinite(sigma) ? sigma * sigma : kNotMeasured;
  }
  out.header(velocity.t, "body");
  out.numbers({velocity.v_S.data(), 3});
  out.numbers(kZeros<3>);
  out.numbers(covariance);
  return out.message();
}

std::string transform_message(Wire wire, const StampedPose& pose, std::string_view child) {
  WireWriter out(wire);
  out.header(pose.t, "world");
  out.text(child);
  out.numbers({pose.T.translation().data(), 3});
  out.numbers({pose.T.rotation().coeffs().data(), 4});  // Eigen's order of coefficients is x, y, z, w, too
  return out.message();
}

std::string camera_info_message(Wire wire, Timestamp stamp, std::string_view camera, const CameraModel& model) {
  const bool distorted = model.distortion() != DistortionModel::None;
  const LensModel& lens = lens_model(distorted ? model.distortion() : DistortionModel::RadTan);
  WireWriter out(wire);
  out.header(stamp, camera);
  out.number(static_cast<std::uint32_t>(model.height()));
  out.number(static_cast<std::uint32_t>(model.width()));
  out.text(lens.ros.empty() ? lens.name : lens.ros);  // our name where ROS has none
  out.number(static_cast<std::uint32_t>(lens.most));
  out.numbers({model.coefficients().data(), lens.most});
  const double fx = model.fx(), fy = model.fy(), cx = model.cx(), cy = model.cy();
  out.numbers(std::array{fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0});                 // K
  out.numbers(std::array{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});             // no rectification
  out.numbers(std::array{fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0});  // P
  for (int i = 0; i < 6; ++i) out.number(std::uint32_t{0});                         // no binning, the whole image
  out.number(std::uint8_t{0});
  return out.message();
}

}  // namespace edged
