// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
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

template <std::size_t N>
constexpr std::array<double, N> kZeros{};

}  // namespace

EventArray read_event_array(WireReader message) {
  constexpr std::size_t kEventBytes = 13;
  message.header();
  EventArray array;
  message.numbers(array.height, array.width);
  array.events.resize(message.list(kEventBytes));
  for (Event& event : array.events) {
    event.x = message.number<std::uint16_t>();
    event.y = message.number<std::uint16_t>();
    event.t = message.time();
    event.positive = message.number<std::uint8_t>() != 0;
  }
  return array;
}

std::string event_array_message(Wire wire, const EventBatch& batch, cv::Size sensor) {
  WireWriter out(wire);
  out.header(batch.events.front().t, batch.camera);
  out.numbers(static_cast<std::uint32_t>(sensor.height), static_cast<std::uint32_t>(sensor.width),
              static_cast<std::uint32_t>(batch.events.size()));
  for (const Event& event : batch.events) {
    out.number(event.x);
    out.number(event.y);
    out.time(event.t);
    out.number<std::uint8_t>(event.positive ? 1 : 0);
  }
  return out.message();
}

EventPacket read_event_packet(WireReader message) {
  EventPacket packet;
  packet.stamp = message.header();
  message.numbers(packet.height, packet.width, packet.sequence, packet.time_base);
  packet.encoding = message.text();
  message.number<std::uint8_t>();  // byte order of the recording computer; the encodings define their own
  packet.events = message.bytes();
  return packet;
}

std::string event_packet_message(Wire wire, const EventPacket& packet, std::string_view camera) {
  WireWriter out(wire);
  out.header(packet.stamp, camera);
  out.numbers(packet.height, packet.width, packet.sequence, packet.time_base);
  out.text(packet.encoding);
  out.number(std::uint8_t{0});  // little-endian
  out.bytes(packet.events);
  return out.message();
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

std::string camera_info_message(Wire wire, Timestamp stamp, std::string_view camera, const CameraModel& model) {
  const bool distorted = model.distortion() != DistortionModel::None;
  const LensModel& lens = lens_model(distorted ? model.distortion() : DistortionModel::RadTan);
  WireWriter out(wire);
  out.header(stamp, camera);
  out.numbers(static_cast<std::uint32_t>(model.height()), static_cast<std::uint32_t>(model.width()));
  out.text(lens.ros.empty() ? lens.name : lens.ros);  // our name where ROS has none
  out.number(static_cast<std::uint32_t>(lens.max_coefficients));
  out.numbers({model.coefficients().data(), lens.max_coefficients});
  const double fx = model.fx(), fy = model.fy(), cx = model.cx(), cy = model.cy();
  out.numbers(std::array{fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0});                 // K
  out.numbers(std::array{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});             // no rectification
  out.numbers(std::array{fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0});  // P
  for (int i = 0; i < 6; ++i) out.number(std::uint32_t{0});                         // no binning, the whole image
  out.number(std::uint8_t{0});
  return out.message();
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

GrayImage read_frame(std::string_view type, WireReader message) {
  return type == "sensor_msgs/Image" ? read_image(message) : read_compressed_image(message);
}

std::string image_message(Wire wire, const Frame& frame) {
  const cv::Mat image = frame.image.isContinuous() ? frame.image : frame.image.clone();
  WireWriter out(wire);
  out.header(frame.t, frame.camera);
  out.numbers(static_cast<std::uint32_t>(image.rows), static_cast<std::uint32_t>(image.cols));
  out.text("mono8");
  out.number(std::uint8_t{0});  // little-endian
  out.number(static_cast<std::uint32_t>(image.cols));
  out.bytes({image.data, image.total()});
  return out.message();
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

std::string_view external_type(std::size_t place) {
  constexpr std::array<std::string_view, kExternalSensors> kTypes = {"sensor_msgs/FluidPressure",
                                                                     "geometry_msgs/TwistWithCovarianceStamped"};
  return kTypes.at(place);
}

std::string external_message(Wire wire, const ExternalSample& sample) {
  WireWriter out(wire);
  if (const auto* height = std::get_if<HeightSample>(&sample)) {
    const double part = 1.0 - height->height_m / kAtmosphere_m;  // the reverse of the standard atmosphere
    const double pressure_pa = kSeaLevel_pa * std::pow(part, 1.0 / kAtmosphereExponent);
    const double sigma_pa = height->sigma_m * pressure_pa / (kAtmosphere_m * kAtmosphereExponent * part);
    out.header(height->t, "body");
    out.numbers(std::array{pressure_pa, sigma_pa * sigma_pa});
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

NamedPose read_pose(std::string_view type, WireReader message) {
  const Timestamp t = message.header();
  const std::string_view frame = type == "geometry_msgs/PoseStamped" ? "" : message.text();
  const Eigen::Vector3d p = message.vector<3>();
  const Eigen::Vector4d xyzw = message.vector<4>();
  if (!p.allFinite() || !(std::abs(xyzw.norm() - 1.0) < 0.1)) throw Damage("no pose");
  return {{t, SE3(Eigen::Quaterniond(xyzw), p)}, frame};  // Eigen's order of coefficients is x, y, z, w, too
}

std::string transform_message(Wire wire, const StampedPose& pose, std::string_view child) {
  WireWriter out(wire);
  out.header(pose.t, "world");
  out.text(child);
  out.numbers({pose.T.translation().data(), 3});
  out.numbers({pose.T.rotation().coeffs().data(), 4});  // Eigen's order of coefficients is x, y, z, w, too
  return out.message();
}

}  // namespace edged
