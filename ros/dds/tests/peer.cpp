// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A driver and a subscriber on Fast DDS: publishes a recording as drivers do, keeps what `edged ros2` publishes.
// Usage: edged_ros2_peer RECORDING|none OUT [skip=N] [from=S] [rate=R] [reliable=1] [listen=S] [node=NAME]
// [interfaces=2] [rig=NAME] [loss=PERCENT] [nodes=N] Writes OUT.tum (odometry) and OUT.json; without a recording also
// OUT.ready once the node publishes to it. skip: packet numbers that are never sent; loss: packets of the network that
// are; nodes: it waits for so many; listen: ends so long after the last pose.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/calibration.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/parse/evt.hpp"
#include "edged/live/live_clock.hpp"
#include "fast_peer.hpp"

namespace edged::fast {
namespace {

using Json = nlohmann::ordered_json;
using Options = std::map<std::string, std::string>;
using Clock = std::chrono::steady_clock;

double number_of(const Options& options, const std::string& key, double otherwise) {
  const auto found = options.find(key);
  return found == options.end() ? otherwise : std::stod(found->second);
}

std::string image_bytes(const Frame& frame) {
  Encoder out(frame.image.total() + 256);
  out.header(to_ns(frame.t), frame.camera);
  out << static_cast<std::uint32_t>(frame.image.rows) << static_cast<std::uint32_t>(frame.image.cols)
      << std::string("mono8") << std::uint8_t{0} << static_cast<std::uint32_t>(frame.image.cols);
  const cv::Mat image = frame.image.isContinuous() ? frame.image : frame.image.clone();
  out << std::vector<std::uint8_t>(image.data, image.data + image.total());
  return out.bytes();
}

std::string imu_bytes(const ImuSample& sample) {
  Encoder out(1024);
  out.header(to_ns(sample.t), "imu");
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
  Driver(Participant& participant, const Options& options)
      : skip_(static_cast<std::uint64_t>(number_of(options, "skip", 0))) {
    const bool reliable = number_of(options, "reliable", 0) > 0;
    events_ = participant.writer("/events", "event_camera_msgs::msg::dds_::EventPacket_", {reliable, false, 1000});
    image_ = participant.writer("/image", "sensor_msgs::msg::dds_::Image_", {reliable, false, 10});
    imu_ = participant.writer("/imu", "sensor_msgs::msg::dds_::Imu_", {reliable, false, 1000});
  }

  bool is_heard(int nodes) const {
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
      write(image_, image_bytes(*frame));
    } else if (const auto* sample = std::get_if<ImuSample>(&measurement)) {
      write(imu_, imu_bytes(*sample));
    }
  }

 private:
  static int readers(dds::DataWriter* writer) {
    dds::PublicationMatchedStatus status;
    writer->get_publication_matched_status(status);
    return status.current_count;
  }
  static void write(dds::DataWriter* writer, std::string bytes) { writer->write(&bytes); }

  void send_packet(std::span<const Event> events, cv::Size sensor) {
    const std::string& evt3 = encoder_.encode(events);
    const std::uint64_t sequence = sequence_++;
    if (skip_ > 0 && sequence % skip_ == skip_ - 1) return;  // lost on the way
    Encoder out(evt3.size() + 256);
    out.header(to_ns(events.front().t), "event_camera");
    out << static_cast<std::uint32_t>(sensor.height) << static_cast<std::uint32_t>(sensor.width) << sequence
        << static_cast<std::uint64_t>(to_ns(events.front().t)) << std::string("evt3") << false
        << std::vector<std::uint8_t>(evt3.begin(), evt3.end());
    write(events_, out.bytes());
  }

  const std::uint64_t skip_;
  dds::DataWriter *events_, *image_, *imu_;
  EvtEncoder encoder_{EvtFormat::Evt3};
  std::uint64_t sequence_ = 0;
};

constexpr const char* kToPx4 = "/fmu/in/vehicle_visual_odometry";

struct Output {
  const char* topic;  ///< "~" stands for the node
  const char* type;
  FastQos qos;
};
const Output kOutputs[] = {
    {"~/odometry", "nav_msgs::msg::dds_::Odometry_", {true, false, 1000}},
    {"~/prediction", "nav_msgs::msg::dds_::Odometry_", {true, false, 5000}},
    {"~/pose", "geometry_msgs::msg::dds_::PoseWithCovarianceStamped_", {true, false, 1000}},
    {"~/path", "nav_msgs::msg::dds_::Path_", {true, false, 10}},
    {"~/landmarks", "sensor_msgs::msg::dds_::PointCloud2_", {true, false, 10}},
    {"~/map", "sensor_msgs::msg::dds_::PointCloud2_", {true, false, 1}},
    {"~/occupancy", "nav_msgs::msg::dds_::OccupancyGrid_", {true, true, 1}},
    {"~/octomap", "octomap_msgs::msg::dds_::Octomap_", {true, true, 1}},
    {"~/tracks/events", "sensor_msgs::msg::dds_::Image_", {true, false, 5}},
    {"~/tracks/frames", "sensor_msgs::msg::dds_::Image_", {true, false, 5}},
    {"/tf", "tf2_msgs::msg::dds_::TFMessage_", {true, false, 1000}},
    {"/tf_static", "tf2_msgs::msg::dds_::TFMessage_", {true, true, 1}},
    {"/diagnostics", "diagnostic_msgs::msg::dds_::DiagnosticArray_", {true, false, 100}},
    {kToPx4, "px4_msgs::msg::dds_::VehicleOdometry_", {false, false, 1000}},
};

/// Reads every field of the message; "complete" says whether nothing was left of it.
Json odometry_fields(const std::string& bytes) {
  Decoder in(bytes);
  const auto header = in.header();
  Json json = {{"stamp_ns", header.stamp_ns}, {"frame", header.frame}, {"child", in.get<std::string>()}};
  json["pose"] = in.doubles(7);
  json["pose_covariance"] = in.doubles(36);
  json["twist"] = in.doubles(6);
  json["twist_covariance"] = in.doubles(36);
  json["complete"] = in.at_end();
  return json;
}

Json pose_fields(const std::string& bytes) {
  Decoder in(bytes);
  const auto header = in.header();
  Json json = {{"stamp_ns", header.stamp_ns}, {"frame", header.frame}};
  json["pose"] = in.doubles(7);
  json["pose_covariance"] = in.doubles(36);
  json["complete"] = in.at_end();
  return json;
}

Json path_fields(const std::string& bytes) {
  Decoder in(bytes);
  Json json = {{"frame", in.header().frame}, {"poses", Json::array()}};
  for (auto left = in.get<std::uint32_t>(); left > 0; --left) {
    const auto header = in.header();
    json["poses"].push_back({{"stamp_ns", header.stamp_ns}, {"frame", header.frame}, {"pose", in.doubles(7)}});
  }
  json["complete"] = in.at_end();
  return json;
}

Json cloud_fields(const std::string& bytes) {
  Decoder in(bytes);
  Json json = {{"frame", in.header().frame}, {"fields", Json::array()}};
  json["height"] = in.get<std::uint32_t>();
  json["width"] = in.get<std::uint32_t>();
  for (auto left = in.get<std::uint32_t>(); left > 0; --left) {
    Json field = {{"name", in.get<std::string>()}};
    field["offset"] = in.get<std::uint32_t>();
    field["datatype"] = in.get<std::uint8_t>();
    field["count"] = in.get<std::uint32_t>();
    json["fields"].push_back(field);
  }
  json["is_bigendian"] = in.get<bool>();
  json["point_step"] = in.get<std::uint32_t>();
  json["row_step"] = in.get<std::uint32_t>();
  json["bytes"] = in.get<std::vector<std::uint8_t>>().size();
  json["is_dense"] = in.get<bool>();
  json["complete"] = in.at_end();
  return json;
}

Json grid_fields(const std::string& bytes) {
  Decoder in(bytes);
  const auto header = in.header();
  Json json = {{"stamp_ns", header.stamp_ns}, {"frame", header.frame}};
  json["load_time_s"] = in.get<std::int32_t>();
  json["load_time_ns"] = in.get<std::uint32_t>();
  json["resolution"] = in.get<float>();
  json["width"] = in.get<std::uint32_t>();
  json["height"] = in.get<std::uint32_t>();
  json["origin"] = in.doubles(7);
  std::map<std::string, int> cells = {{"occupied", 0}, {"free", 0}, {"unknown", 0}, {"others", 0}};
  for (const std::int8_t cell : in.get<std::vector<std::int8_t>>())
    ++cells[cell == 100 ? "occupied" : cell == 0 ? "free" : cell == -1 ? "unknown" : "others"];
  json["cells"] = cells;
  json["complete"] = in.at_end();
  return json;
}

Json octomap_fields(const std::string& bytes) {
  Decoder in(bytes);
  const auto header = in.header();
  Json json = {{"stamp_ns", header.stamp_ns}, {"frame", header.frame}};
  json["binary"] = in.get<bool>();
  json["id"] = in.get<std::string>();
  json["resolution"] = in.get<double>();
  json["bytes"] = in.get<std::vector<std::int8_t>>().size();
  json["complete"] = in.at_end();
  return json;
}

Json image_fields(const std::string& bytes) {
  Decoder in(bytes);
  Json json = {{"frame", in.header().frame}};
  json["height"] = in.get<std::uint32_t>();
  json["width"] = in.get<std::uint32_t>();
  json["encoding"] = in.get<std::string>();
  json["is_bigendian"] = in.get<std::uint8_t>();
  json["step"] = in.get<std::uint32_t>();
  json["bytes"] = in.get<std::vector<std::uint8_t>>().size();
  json["complete"] = in.at_end();
  return json;
}

Json transforms_fields(const std::string& bytes) {
  Decoder in(bytes);
  Json json = {{"transforms", Json::array()}};
  for (auto left = in.get<std::uint32_t>(); left > 0; --left) {
    Json transform = {{"frame", in.header().frame}};
    transform["child"] = in.get<std::string>();
    transform["pose"] = in.doubles(7);
    json["transforms"].push_back(transform);
  }
  json["complete"] = in.at_end();
  return json;
}

Json diagnostics_fields(const std::string& bytes) {
  Decoder in(bytes);
  in.header();
  Json json = {{"statuses", in.get<std::uint32_t>()}};
  json["level"] = in.get<std::uint8_t>();
  json["name"] = in.get<std::string>();
  json["message"] = in.get<std::string>();
  json["hardware"] = in.get<std::string>();
  json["values"] = Json::object();
  for (auto left = in.get<std::uint32_t>(); left > 0; --left) {
    const auto key = in.get<std::string>();
    json["values"][key] = in.get<std::string>();
  }
  json["complete"] = in.at_end();
  return json;
}

Json floats(Decoder& in, int count) {
  Json list = Json::array();
  for (int i = 0; i < count; ++i) list.push_back(in.get<float>());
  return list;
}

Json px4_fields(const std::string& bytes) {
  Decoder in(bytes);
  Json json = {{"timestamp", in.get<std::uint64_t>()}};
  json["timestamp_sample"] = in.get<std::uint64_t>();
  json["pose_frame"] = in.get<std::uint8_t>();
  json["position"] = floats(in, 3);
  json["q"] = floats(in, 4);
  json["velocity_frame"] = in.get<std::uint8_t>();
  for (const char* name :
       {"velocity", "angular_velocity", "position_variance", "orientation_variance", "velocity_variance"})
    json[name] = floats(in, 3);
  json["reset_counter"] = in.get<std::uint8_t>();
  json["quality"] = in.get<std::int8_t>();
  json["complete"] = in.at_end();
  return json;
}

Json fields_of(const std::string& type, const std::string& bytes) {
  const std::map<std::string, Json (*)(const std::string&)> decoders = {
      {"Odometry", odometry_fields},   {"PoseWithCovarianceStamped", pose_fields},
      {"Path", path_fields},           {"PointCloud2", cloud_fields},
      {"Image", image_fields},         {"TFMessage", transforms_fields},
      {"VehicleOdometry", px4_fields}, {"DiagnosticArray", diagnostics_fields},
      {"OccupancyGrid", grid_fields},  {"Octomap", octomap_fields}};
  const std::size_t begin = type.rfind(':') + 1;
  return decoders.at(type.substr(begin, type.size() - begin - 1))(bytes);
}

/// The position and rotation as trajectories have them.
void write_tum(const std::string& file, const std::vector<std::string>& odometry) {
  std::ofstream out(file);
  for (const std::string& bytes : odometry) {
    const Json fields = odometry_fields(bytes);
    const auto ns = fields["stamp_ns"].get<std::int64_t>();
    char stamp[40];
    std::snprintf(stamp, sizeof stamp, "%lld.%09lld", static_cast<long long>(ns / 1'000'000'000),
                  static_cast<long long>(ns % 1'000'000'000));
    out << stamp;
    char value[40];
    for (const double x : fields["pose"].get<std::vector<double>>()) {
      std::snprintf(value, sizeof value, " %.17g", x);
      out << value;
    }
    out << "\n";
  }
}

class Listener {
 public:
  Listener(Participant& participant, const std::string& node) {
    for (const Output& output : kOutputs) {
      std::string topic = output.topic;
      if (topic.front() == '~') topic.replace(0, 1, "/" + node);
      readers_.push_back(participant.reader(topic, output.type, output.qos, collectors_[output.topic]));
    }
  }
  /// The node publishes its poses to this.
  bool is_told() const {
    dds::SubscriptionMatchedStatus status;
    readers_.front()->get_subscription_matched_status(status);
    return status.current_count > 0;
  }
  std::size_t poses() { return collectors_["~/odometry"].count(); }

  void write(const std::string& out) {
    Json json;
    for (const Output& output : kOutputs) {
      const std::vector<std::string> messages = collectors_[output.topic].messages();
      json[output.topic] = {{"count", messages.size()}};
      if (!messages.empty()) json[output.topic]["last"] = fields_of(output.type, messages.back());
    }
    add_delays(json[kToPx4]);
    std::ofstream(out + ".json") << json.dump(1) << "\n";
    write_tum(out + ".tum", collectors_["~/odometry"].messages());
    write_tum(out + ".prediction.tum", collectors_["~/prediction"].messages());
  }

 private:
  /// From the time of the IMU sample, by the clock of this machine, until its state was here.
  void add_delays(Json& px4) {
    const std::vector<std::string> messages = collectors_[kToPx4].messages();
    std::vector<double> delays_ms;
    for (std::size_t i = 0; i < messages.size(); ++i) {
      const auto sampled_us = px4_fields(messages[i])["timestamp_sample"].get<std::int64_t>();
      delays_ms.push_back(1e-3 * static_cast<double>(collectors_[kToPx4].arrivals_us()[i] - sampled_us));
    }
    std::ranges::sort(delays_ms);
    if (delays_ms.empty()) return;
    px4["delay_ms"] = {delays_ms[delays_ms.size() / 2], delays_ms[delays_ms.size() * 99 / 100]};
  }

  std::map<std::string, Collector> collectors_;
  std::vector<dds::DataReader*> readers_;  // of kOutputs: first the odometry
};

template <typename Condition>
void wait_until(Condition condition, const char* otherwise) {
  const auto deadline = Clock::now() + std::chrono::seconds(20);
  while (!condition()) {
    if (Clock::now() > deadline) throw std::runtime_error(otherwise);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

void drive_recording(Participant& participant, Driver& driver, const std::string& path, const Options& options) {
  const Recording recording = open_recording(path);
  const auto nodes = static_cast<int>(number_of(options, "nodes", 1));
  wait_until([&driver, nodes] { return driver.is_heard(nodes); }, "nobody subscribes");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // the readers of the other side match as well
  participant.lose(number_of(options, "loss", 0));
  const auto rig = options.find("rig");
  const Calibration calibration = rig == options.end() ? recording.calibration.value() : load_rig(rig->second);
  const CameraModel& camera = calibration.rig.find(Modality::Events)->model;
  const cv::Size sensor(camera.width(), camera.height());
  const double rate = number_of(options, "rate", 1.0);
  const Duration from =
      std::chrono::duration_cast<Duration>(std::chrono::duration<double>(number_of(options, "from", 0)));
  std::optional<Timestamp> first;
  LiveClock pace;
  while (const auto measurement = recording.dataset->next()) {
    const auto t = last_stamp(*measurement);
    if (!t) continue;
    if (!first) first = *t;
    if (*t - *first < from) continue;
    pace.wait_for(*first + duration_from_seconds(to_seconds(*t - *first) / rate), [] { return false; });
    driver.send(*measurement, sensor);
  }
}

int run_peer(const std::string& recording, const std::string& out, const Options& options) {
  const char* domain = std::getenv("ROS_DOMAIN_ID");
  Participant participant(domain ? static_cast<std::uint32_t>(std::atoi(domain)) : 0,
                          number_of(options, "interfaces", 1) < 2);
  const auto node = options.find("node");
  Listener listener(participant, node == options.end() ? "edged" : node->second);
  std::optional<Driver> driver;
  if (recording != "none") {
    driver.emplace(participant, options);
    drive_recording(participant, *driver, recording, options);
  } else {
    wait_until([&listener] { return listener.is_told(); }, "nobody publishes");
    std::ofstream(out + ".ready") << "\n";
  }
  const auto quiet = std::chrono::duration<double>(number_of(options, "listen", 1.5));
  auto last_news = Clock::now();
  for (std::size_t poses = 0; Clock::now() - last_news < quiet;) {
    if (listener.poses() != poses) last_news = Clock::now();
    poses = listener.poses();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  listener.write(out);
  return 0;
}

}  // namespace
}  // namespace edged::fast

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fputs("usage: edged_ros2_peer RECORDING|none OUT [key=value ...]\n", stderr);
    return 2;
  }
  std::map<std::string, std::string> options;
  for (int i = 3; i < argc; ++i) {
    const std::string word = argv[i];
    const std::size_t sign = word.find('=');
    options[word.substr(0, sign)] = sign == std::string::npos ? "" : word.substr(sign + 1);
  }
  try {
    return edged::fast::run_peer(argv[1], argv[2], options);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "peer: %s\n", e.what());
    return 1;
  }
}
