// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/autopilot/mavlink.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <type_traits>

namespace edged {
namespace {

constexpr std::uint8_t kMagic = 0xFD, kSigned = 0x01;
constexpr std::size_t kHeader = 10, kChecksum = 2, kSignature = 13;

// Constants of MAVLink's common message set.
constexpr std::uint8_t kLocalFrd = 20, kBodyFrd = 12;  // MAV_FRAME
constexpr std::uint8_t kVisualInertial = 3;            // MAV_ESTIMATOR_TYPE_VIO
constexpr std::uint8_t kOnboardController = 18;        // MAV_TYPE
constexpr std::uint8_t kNoAutopilot = 8, kActive = 4;  // MAV_AUTOPILOT_INVALID, MAV_STATE_ACTIVE
constexpr std::uint8_t kMavlinkVersion = 3;

/// Writes numbers with their lowest byte first.
class Payload {
 public:
  template <typename Integer>
  requires std::is_integral_v<Integer> Payload& operator<<(Integer value) {
    const auto bits = static_cast<std::uint64_t>(value);
    for (std::size_t i = 0; i < sizeof value; ++i) bytes.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
    return *this;
  }
  Payload& operator<<(float value) { return *this << std::bit_cast<std::uint32_t>(value); }
  template <std::size_t N>
  Payload& operator<<(const std::array<float, N>& values) {
    for (const float value : values) *this << value;
    return *this;
  }

  std::vector<std::uint8_t> bytes;
};

/// The upper triangle of a 6x6 covariance, row by row, with variances on its diagonal. Correlations are unknown; 0 says
/// that, as receivers use the diagonal alone.
std::array<float, 21> triangle(const std::array<float, 3>& first, const std::array<float, 3>& second) {
  std::array<float, 21> covariance{};
  std::size_t at = 0;
  for (std::size_t i = 0; i < 6; at += 6 - i, ++i) covariance[at] = i < 3 ? first[i] : second[i - 3];
  return covariance;
}

std::uint64_t number_at(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t size) {
  std::uint64_t number = 0;
  // Trailing zeros of a payload are not sent.
  for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i) number |= std::uint64_t{bytes[at + i]} << (8 * i);
  return number;
}

std::uint16_t checksum_of(std::span<const std::uint8_t> header_and_payload, const MavlinkMessage& message) {
  return mavlink_crc({&message.crc_extra, 1}, mavlink_crc(header_and_payload.subspan(1)));
}

/// A request in a complete frame.
std::optional<MavlinkTimesync> request_in(std::span<const std::uint8_t> frame) {
  if (number_at(frame, 7, 3) != kMavlinkTimesync.id) return std::nullopt;
  const auto checked = frame.first(kHeader + frame[1]);
  if (number_at(frame, checked.size(), kChecksum) != checksum_of(checked, kMavlinkTimesync)) return std::nullopt;
  const auto payload = checked.subspan(kHeader);
  const auto integer = [payload](std::size_t at) { return static_cast<std::int64_t>(number_at(payload, at, 8)); };
  const MavlinkTimesync message{integer(0), integer(8), {frame[5], frame[6]}};
  return message.tc1 == 0 ? std::optional(message) : std::nullopt;
}

}  // namespace

std::uint16_t mavlink_crc(std::span<const std::uint8_t> bytes, std::uint16_t crc) {
  constexpr std::uint16_t kPolynomial = 0x8408;  // x^16 + x^12 + x^5 + 1, lowest bit first
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ byte);
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>((crc & 1U) != 0 ? (crc >> 1U) ^ kPolynomial : crc >> 1U);
  }
  return crc;
}

MavlinkFrame MavlinkEncoder::frame(const MavlinkMessage& message, std::vector<std::uint8_t> payload) {
  while (payload.size() > 1 && payload.back() == 0) payload.pop_back();
  Payload out;
  out << kMagic << static_cast<std::uint8_t>(payload.size()) << std::uint8_t{0} << std::uint8_t{0} << sequence_++
      << ids_.system << ids_.component << static_cast<std::uint16_t>(message.id)
      << static_cast<std::uint8_t>(message.id >> 16U);
  out.bytes.insert(out.bytes.end(), payload.begin(), payload.end());
  out << checksum_of(out.bytes, message);
  return std::move(out.bytes);
}

MavlinkFrame MavlinkEncoder::odometry(const VehicleOdometry& odometry) {
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  Payload out;
  out << odometry.timestamp_sample << odometry.position << odometry.q << odometry.velocity << odometry.angular_velocity
      << triangle(odometry.position_variance, odometry.orientation_variance)
      << triangle(odometry.velocity_variance, {kUnknown, kUnknown, kUnknown}) << kLocalFrd << kBodyFrd
      << odometry.reset_counter << kVisualInertial << odometry.quality;
  return frame(kMavlinkOdometry, std::move(out.bytes));
}

MavlinkFrame MavlinkEncoder::heartbeat() {
  constexpr std::uint32_t kNoMode = 0;
  Payload out;
  out << kNoMode << kOnboardController << kNoAutopilot << std::uint8_t{0} << kActive << kMavlinkVersion;
  return frame(kMavlinkHeartbeat, std::move(out.bytes));
}

MavlinkFrame MavlinkEncoder::timesync(const MavlinkTimesync& request, std::int64_t now_ns) {
  Payload out;
  out << now_ns << request.ts1 << request.from.system << request.from.component;
  return frame(kMavlinkTimesync, std::move(out.bytes));
}

std::vector<MavlinkTimesync> MavlinkDecoder::add(std::span<const std::uint8_t> bytes) {
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  std::vector<MavlinkTimesync> requests;
  auto begin = pending_.begin();
  while ((begin = std::find(begin, pending_.end(), kMagic)) != pending_.end()) {
    const auto left = static_cast<std::size_t>(pending_.end() - begin);
    if (left < kHeader) break;
    if ((begin[2] & ~kSigned) != 0) {  // a byte that looks like the beginning of a frame
      ++begin;
      continue;
    }
    const std::size_t size = kHeader + begin[1] + kChecksum + ((begin[2] & kSigned) != 0 ? kSignature : 0);
    if (left < size) break;
    if (const auto request = request_in({begin, size})) requests.push_back(*request);
    // The checksum of other messages cannot be verified: the next frame shows whether this was one.
    begin += left == size || begin[static_cast<std::ptrdiff_t>(size)] == kMagic ? static_cast<std::ptrdiff_t>(size) : 1;
  }
  pending_.erase(pending_.begin(), begin);
  return requests;
}

}  // namespace edged
