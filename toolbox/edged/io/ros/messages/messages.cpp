// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads messages field by field, in the order of their definitions.
#include "edged/io/ros/messages/messages.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "edged/camera/lens_table.hpp"
#include "edged/core/check.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/io/parse/distortion.hpp"
#include "edged/io/parse/image_codec.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

constexpr std::uint32_t kLargestSide = 32768;  // of an image or sensor [px]

/// The conversion of an encoding to grey; conversion < 0: none needed. Words of 16 bits are read as pairs of bytes, as
/// rows may begin at any address.
struct Encoding {
  std::string_view name;
  int type;
  int conversion;
};

// Bayer patterns: ROS names the first row, OpenCV the second row from the second column on.
constexpr std::array kEncodings = {
    Encoding{"mono8", CV_8UC1, -1},
    Encoding{"8UC1", CV_8UC1, -1},
    Encoding{"mono16", CV_8UC2, -1},
    Encoding{"16UC1", CV_8UC2, -1},
    Encoding{"bgr8", CV_8UC3, cv::COLOR_BGR2GRAY},
    Encoding{"8UC3", CV_8UC3, cv::COLOR_BGR2GRAY},
    Encoding{"rgb8", CV_8UC3, cv::COLOR_RGB2GRAY},
    Encoding{"bgra8", CV_8UC4, cv::COLOR_BGRA2GRAY},
    Encoding{"rgba8", CV_8UC4, cv::COLOR_RGBA2GRAY},
    Encoding{"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2GRAY},
    Encoding{"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2GRAY},
    Encoding{"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2GRAY},
    Encoding{"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2GRAY},
};

/// The upper byte of each pixel.
cv::Mat upper_bytes(const cv::Mat& words, bool big_endian) {
  cv::Mat gray(words.size(), CV_8UC1);
  for (int y = 0; y < words.rows; ++y)
    for (int x = 0; x < words.cols; ++x) gray.at<std::uint8_t>(y, x) = words.ptr(y)[2 * x + (big_endian ? 0 : 1)];
  return gray;
}

Timestamp checked_stamp(std::int64_t ns) {
  if (ns < 0 || ns > kMaxStampNs) throw Damage("stamp out of range");
  return timestamp_from_ns(ns);
}

StampedPose pose_from(Timestamp t, WireReader& message) {
  const Eigen::Vector3d p = message.vector<3>();
  const Eigen::Vector4d xyzw = message.vector<4>();
  if (!p.allFinite() || !(std::abs(xyzw.norm() - 1.0) < 0.1)) throw Damage("no pose");
  return {t, SE3(Eigen::Quaterniond(xyzw), p)};  // Eigen's order of coefficients is x, y, z, w, too
}

// The ICAO standard atmosphere below 11 km, with its standard pressure at sea level. So the zero of the heights is
// arbitrary.
constexpr double kSeaLevel_pa = 101325.0, kAtmosphere_m = 44330.77, kAtmosphereExponent = 0.190263;

HeightSample height_of_pressure(Timestamp t, double pressure_pa, double variance_pa2) {
  if (!(pressure_pa > 2e4 && pressure_pa < 1.2e5)) throw Damage("not an air pressure in Pa");
  const double part = std::pow(pressure_pa / kSeaLevel_pa, kAtmosphereExponent);
  const double m_per_pa = kAtmosphere_m * kAtmosphereExponent * part / pressure_pa;
  return {t, kAtmosphere_m * (1.0 - part), variance_pa2 > 0.0 ? m_per_pa * std::sqrt(variance_pa2) : 0.0};
}

/// The linear velocity after the header, and the diagonal of its covariance, where 0 means unknown.
VelocitySample read_twist(std::string_view type, Timestamp t, WireReader& message) {
  if (type == "nav_msgs/Odometry") {
    message.text();            // child_frame_id
    message.vector<7 + 36>();  // pose and its covariance
  }
  VelocitySample sample{t, message.vector<3>()};
  message.vector<3>();  // angular velocity: the gyro is more accurate
  if (type == "geometry_msgs/TwistStamped") return sample;
  const Eigen::Matrix<double, 36, 1> covariance = message.vector<36>();
  for (int axis = 0; axis < 3; ++axis) {
    const double variance = covariance[7 * axis];
    sample.sigma[axis] = variance > 0.0 ? std::sqrt(variance) : 0.0;
    if (variance >= 1e3)
      sample.sigma[axis] = std::numeric_limits<double>::infinity();  // the convention of drivers for: not measured
  }
  return sample;
}

}  // namespace

WireReader::WireReader(Wire wire, ByteSpan message) : wire_(wire), reader_(message) {
  if (wire == Wire::Ros1) return;
  ByteReader kind(message);
  kind.take(1);
  if (kind.number<std::uint8_t>() != 1) throw Damage("not plain little-endian CDR");
  kind.take(2);
  reader_ = ByteReader(message.subspan(4));
}

std::string_view WireReader::text() {
  const std::string_view value = reader_.text(number<std::uint32_t>());
  return wire_ == Wire::Cdr && value.ends_with('\0') ? value.substr(0, value.size() - 1) : value;
}

ByteSpan WireReader::bytes() { return reader_.take(number<std::uint32_t>()); }

Timestamp WireReader::time() {
  const std::int64_t s = wire_ == Wire::Cdr ? number<std::int32_t>() : std::int64_t{number<std::uint32_t>()};
  return checked_stamp(s * 1'000'000'000 + number<std::uint32_t>());
}

Timestamp WireReader::header() {
  if (wire_ == Wire::Ros1) number<std::uint32_t>();  // seq
  const Timestamp stamp = time();
  text();  // frame_id
  return stamp;
}

std::uint32_t WireReader::list(std::size_t item_bytes) {
  const auto length = number<std::uint32_t>();
  if (length > reader_.left() / item_bytes) throw Damage("list longer than its message");
  return length;
}

EventArray read_event_array(WireReader message) {
  constexpr std::size_t kEventBytes = 13;
  message.header();
  EventArray array;
  array.height = message.number<std::uint32_t>();
  array.width = message.number<std::uint32_t>();
  array.events.resize(message.list(kEventBytes));
  for (Event& event : array.events) {
    event.x = message.number<std::uint16_t>();
    event.y = message.number<std::uint16_t>();
    event.t = message.time();
    event.positive = message.number<std::uint8_t>() != 0;
  }
  return array;
}

EventPacket read_event_packet(WireReader message) {
  EventPacket packet;
  packet.stamp = message.header();
  packet.height = message.number<std::uint32_t>();
  packet.width = message.number<std::uint32_t>();
  packet.sequence = message.number<std::uint64_t>();
  packet.time_base = message.number<std::uint64_t>();
  packet.encoding = message.text();
  message.number<std::uint8_t>();  // byte order of the recording computer; the encodings define their own
  packet.events = message.bytes();
  return packet;
}

ImuMessage read_imu_message(WireReader message) {
  ImuMessage imu;
  imu.t = message.header();
  message.vector<4 + 9>();  // orientation and its covariance: not measured
  const auto is_measured = [](const Eigen::Vector3d& v, double covariance) {
    return covariance != -1.0 && v.allFinite() && !v.isZero(0.0);
  };
  imu.gyro = message.vector<3>();
  imu.has_gyro = is_measured(imu.gyro, message.vector<9>()[0]);
  imu.accel = message.vector<3>();
  imu.has_accel = is_measured(imu.accel, message.vector<9>()[0]);
  return imu;
}

ImuSample read_imu(WireReader message) {
  const ImuMessage imu = read_imu_message(message);
  if (!imu.gyro.allFinite() || !imu.accel.allFinite()) throw Damage("not finite");
  return {imu.t, imu.gyro, imu.accel};
}

CameraModel read_camera_info(WireReader message) try {
  message.header();
  const auto height = message.number<std::uint32_t>(), width = message.number<std::uint32_t>();
  if (width > kLargestSide || height > kLargestSide) throw Damage("the size of the image is invalid");
  const std::string name(message.text());
  std::vector<double> coefficients(message.list(sizeof(double)));
  for (double& k : coefficients) k = message.number<double>();
  const Eigen::Matrix<double, 9, 1> K = message.vector<9>();
  if (K[0] == 0.0) throw Damage("not calibrated");
  const Distortion distortion = make_distortion(name.empty() ? "plumb_bob" : name, coefficients);
  return CameraModel(static_cast<int>(width), static_cast<int>(height), K[0], K[4], K[2], K[5], distortion.model,
                     distortion.k);
} catch (const InputError& e) {
  throw Damage(e.what());
}

GrayImage read_image(WireReader message) try {
  GrayImage out{message.header(), {}};
  const auto height = message.number<std::uint32_t>(), width = message.number<std::uint32_t>();
  const std::string_view name = message.text();
  const bool big_endian = message.number<std::uint8_t>() != 0;
  const auto step = message.number<std::uint32_t>();
  const ByteSpan data = message.bytes();

  const auto* const encoding = std::ranges::find(kEncodings, name, &Encoding::name);
  if (encoding == kEncodings.end()) throw Damage("encoding `" + std::string(name) + "` is not known");
  const std::size_t row = width * static_cast<std::size_t>(CV_ELEM_SIZE(encoding->type));
  if (width == 0 || height == 0 || width > kLargestSide || height > kLargestSide || step < row ||
      data.size() < (height - 1) * std::size_t{step} + row)
    throw Damage("size of the image contradicts its data");
  // The library wants a mutable pointer, but only reads.
  const cv::Mat raw(static_cast<int>(height), static_cast<int>(width), encoding->type,
                    const_cast<std::uint8_t*>(data.data()), step);
  if (encoding->type == CV_8UC2) {
    out.image = upper_bytes(raw, big_endian);
  } else if (encoding->conversion < 0) {
    out.image = raw.clone();
  } else {
    cv::cvtColor(raw, out.image, encoding->conversion);
  }
  return out;
} catch (const cv::Exception&) {
  throw Damage("image cannot be turned into grey");
}

GrayImage read_compressed_image(WireReader message) {
  GrayImage out{message.header(), {}};
  message.text();  // format: detected from the data
  const ByteSpan data = message.bytes();
  if (data.empty()) throw Damage("no image");
  out.image = decode_gray(data);
  if (out.image.empty()) throw Damage("image cannot be decoded");
  return out;
}

ExternalSample read_external(std::string_view type, WireReader message) {
  const Timestamp t = message.header();
  ExternalSample sample;
  if (type == "sensor_msgs/FluidPressure") {
    const auto pressure_pa = message.number<double>(), variance = message.number<double>();
    sample = height_of_pressure(t, pressure_pa, variance);
  } else if (type == "sensor_msgs/Range") {
    message.number<std::uint8_t>();  // sound or light
    message.number<float>();         // field of view
    const auto least = message.number<float>(), most = message.number<float>(), range = message.number<float>();
    if (!(range >= least && range <= most)) throw Damage("out of its range");
    sample = HeightSample{t, range, 0.0};
  } else {
    sample = read_twist(type, t, message);
  }
  if (!is_plausible(sample)) throw Damage("not finite, or more than such a sensor measures");
  return sample;
}

AirPressure pressure_of_height(const HeightSample& height) {
  const double part = 1.0 - height.height_m / kAtmosphere_m;
  const double pressure_pa = kSeaLevel_pa * std::pow(part, 1.0 / kAtmosphereExponent);
  const double sigma_pa = height.sigma_m * pressure_pa / (kAtmosphere_m * kAtmosphereExponent * part);
  return {pressure_pa, sigma_pa * sigma_pa};
}

StampedPose read_pose_stamped(WireReader message) {
  const Timestamp t = message.header();
  return pose_from(t, message);
}

NamedPose read_named_pose(WireReader message) {
  const Timestamp t = message.header();
  const std::string_view frame = message.text();
  return {pose_from(t, message), frame};
}

}  // namespace edged
