// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Frames byte by byte. tests/program/mavlink_test.py reads them with a decoder of its own.
#include "edged/autopilot/mavlink.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

namespace edged {
namespace {

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// A field of a message definition; length 0: no array.
struct PublishedField {
  std::string type, name;
  std::uint8_t length = 0;
};

/// By the published rule.
int crc_extra_of(const std::string& name, const std::vector<PublishedField>& in_wire_order) {
  std::uint16_t crc = mavlink_crc(bytes_of(name + " "));
  for (const PublishedField& field : in_wire_order) {
    crc = mavlink_crc(bytes_of(field.type + " " + field.name + " "), crc);
    if (field.length > 0) crc = mavlink_crc({&field.length, 1}, crc);
  }
  return (crc & 0xFF) ^ (crc >> 8);
}

std::uint64_t unsigned_at(const MavlinkFrame& frame, std::size_t at, std::size_t size) {
  std::uint64_t number = 0;
  for (std::size_t i = size; i-- > 0;) number = 256 * number + frame.at(at + i);
  return number;
}

float float_at(const MavlinkFrame& frame, std::size_t payload_at) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(unsigned_at(frame, 10 + payload_at, 4)));
}

VehicleOdometry some_odometry() {
  VehicleOdometry odometry;
  odometry.timestamp_sample = 0x0102030405060708;
  odometry.position = {1, 2, 3};
  odometry.q = {0.5F, -0.5F, 0.5F, -0.5F};
  odometry.velocity = {4, 5, 6};
  odometry.angular_velocity = {7, 8, 9};
  odometry.position_variance = {10, 11, 12};
  odometry.orientation_variance = {13, 14, 15};
  odometry.velocity_variance = {16, 17, 18};
  odometry.reset_counter = 200;
  odometry.quality = 77;
  return odometry;
}

TEST(Mavlink, TheChecksumIsThatOfTheCatalogue) {
  EXPECT_EQ(mavlink_crc(bytes_of("123456789")), 0x6F91);  // check value of CRC-16/MCRF4XX
}

TEST(Mavlink, TheCrcExtraFollowsFromThePublishedFields) {
  EXPECT_EQ(crc_extra_of("HEARTBEAT", {{"uint32_t", "custom_mode"},
                                       {"uint8_t", "type"},
                                       {"uint8_t", "autopilot"},
                                       {"uint8_t", "base_mode"},
                                       {"uint8_t", "system_status"},
                                       {"uint8_t", "mavlink_version"}}),
            kMavlinkHeartbeat.crc_extra);
  EXPECT_EQ(crc_extra_of("TIMESYNC", {{"int64_t", "tc1"}, {"int64_t", "ts1"}}), kMavlinkTimesync.crc_extra);
  EXPECT_EQ(crc_extra_of("ODOMETRY", {{"uint64_t", "time_usec"},
                                      {"float", "x"},
                                      {"float", "y"},
                                      {"float", "z"},
                                      {"float", "q", 4},
                                      {"float", "vx"},
                                      {"float", "vy"},
                                      {"float", "vz"},
                                      {"float", "rollspeed"},
                                      {"float", "pitchspeed"},
                                      {"float", "yawspeed"},
                                      {"float", "pose_covariance", 21},
                                      {"float", "velocity_covariance", 21},
                                      {"uint8_t", "frame_id"},
                                      {"uint8_t", "child_frame_id"}}),
            kMavlinkOdometry.crc_extra);
}

TEST(Mavlink, OdometryHasItsFieldsInTheOrderOfTheWire) {
  MavlinkEncoder encoder({42, 197});
  encoder.heartbeat();
  const MavlinkFrame frame = encoder.odometry(some_odometry());
  ASSERT_EQ(frame.size(), 10U + 233U + 2U);
  const std::vector<std::uint8_t> header(frame.begin(), frame.begin() + 10);
  EXPECT_EQ(header, (std::vector<std::uint8_t>{0xFD, 233, 0, 0, 1, 42, 197, 0x4B, 0x01, 0x00}));
  EXPECT_EQ(unsigned_at(frame, 10, 8), 0x0102030405060708U);
  const std::vector<float> first = {1, 2, 3, 0.5F, -0.5F, 0.5F, -0.5F, 4, 5, 6, 7, 8, 9};
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(float_at(frame, 8 + 4 * i), first[i]) << i;
  // The diagonals of the two triangles: rows of 6, 5, 4, 3, 2 and 1.
  const std::vector<std::size_t> diagonal = {0, 6, 11, 15, 18, 20};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(float_at(frame, 60 + 4 * diagonal[i]), static_cast<float>(10 + i));
    const float velocity = float_at(frame, 144 + 4 * diagonal[i]);
    EXPECT_TRUE(i < 3 ? velocity == static_cast<float>(16 + i) : std::isnan(velocity)) << i;
  }
  EXPECT_EQ(float_at(frame, 64), 0.0F);  // beside the diagonal
  const std::vector<std::uint8_t> last(frame.begin() + 10 + 228, frame.end() - 2);
  EXPECT_EQ(last, (std::vector<std::uint8_t>{20, 12, 200, 3, 77}));
  std::vector<std::uint8_t> checked(frame.begin() + 1, frame.end() - 2);
  checked.push_back(91);
  EXPECT_EQ(unsigned_at(frame, frame.size() - 2, 2), mavlink_crc(checked));
}

TEST(Mavlink, TrailingZerosAreNotSentAndTheSequenceWraps) {
  MavlinkEncoder encoder({1, 1});
  const MavlinkFrame reply = encoder.timesync({0, 5, {0, 0}}, 258);
  EXPECT_EQ(reply.size(), 10U + 9U + 2U);  // ts1 = 5 takes one byte of its eight; the rest is zero
  EXPECT_EQ(encoder.timesync({0, 0, {0, 0}}, 0).size(), 10U + 1U + 2U);  // at least one byte
  for (int i = 2; i <= 256; ++i) EXPECT_EQ(encoder.heartbeat()[4], i % 256);
}

TEST(Mavlink, ATimesyncRequestIsFoundAmongOtherBytes) {
  MavlinkEncoder autopilot({7, 1});
  MavlinkFrame stream = {1, 2, 0xFD, 3};  // noise that looks like the beginning of a frame
  const auto append = [&stream](const MavlinkFrame& frame) { stream.insert(stream.end(), frame.begin(), frame.end()); };
  append(autopilot.odometry(some_odometry()));
  append(autopilot.timesync({0, 123'456'789'012, {1, 197}}, 0));
  append(autopilot.timesync({0, 1, {1, 197}}, 99));  // a reply, not a request
  MavlinkFrame damaged = autopilot.timesync({0, 77, {1, 197}}, 0);
  damaged[18] ^= 1U;
  append(damaged);
  append(autopilot.timesync({0, 55, {1, 197}}, 0));
  for (const std::size_t piece : {stream.size(), std::size_t{7}, std::size_t{1}}) {
    MavlinkDecoder decoder;
    std::vector<MavlinkTimesync> requests;
    for (std::size_t at = 0; at < stream.size(); at += piece)
      for (const MavlinkTimesync& request :
           decoder.add(std::span(stream).subspan(at, std::min(piece, stream.size() - at))))
        requests.push_back(request);
    // A false beginning that would be longer than what follows waits for more.
    for (const MavlinkTimesync& request : decoder.add(MavlinkFrame(300, 0))) requests.push_back(request);
    ASSERT_EQ(requests.size(), 2U) << piece;
    EXPECT_EQ(requests[0].ts1, 123'456'789'012);
    EXPECT_EQ(requests[0].from.system, 7);
    EXPECT_EQ(requests[1].ts1, 55);
  }
}

}  // namespace
}  // namespace edged
