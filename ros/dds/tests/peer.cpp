// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A driver and a subscriber on Fast DDS: publishes a recording as drivers do, keeps what `edged ros2` publishes.
// Usage: edged_ros2_peer RECORDING|none OUT [key=value ...], with keys skip (numbers of packets that are never sent),
// loss [%] (packets of the network that are), from [s], rate, reliable=1, listen [s] (ends so long after the last
// pose), node=NAME, nodes=N (it waits for so many), interfaces=2, rig=NAME, base=FRAME (on /tf_static the body is 0.2 m
// in front of it), set_at, set_by [s] (the clock of the stamps is set), ask=REQUEST, ask_at [s] (without a recording at
// once). Writes OUT.tum (poses in the map),
// OUT.odom.tum, OUT.prediction.tum and OUT.json; without a recording also OUT.ready once the node publishes to it.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/calibration.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/live/live_clock.hpp"
#include "fast_peer.hpp"
#include "peer_driver.hpp"

namespace edged::fast {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr const char *kToPx4 = "/fmu/in/vehicle_visual_odometry", *kToPx4Type = "px4_msgs::msg::dds_::VehicleOdometry_";

struct Output {
  const char* topic;  ///< "~" stands for the node
  const char* type;
  FastQos qos;
  const char* poses = nullptr;  ///< end of the file of its poses, if it has one
};
const Output kOutputs[] = {
    {"~/odometry", "nav_msgs::msg::dds_::Odometry_", {true, false, 1000}, ".odom.tum"},
    {"~/prediction", "nav_msgs::msg::dds_::Odometry_", {true, false, 5000}, ".prediction.tum"},
    {"~/pose", "geometry_msgs::msg::dds_::PoseWithCovarianceStamped_", {true, false, 1000}, ".tum"},
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
    {kToPx4, kToPx4Type, {false, false, 1000}},
};

/// A field of a message and how it is read into JSON.
struct Field {
  const char* name;
  std::function<Json(Decoder&)> read;
};
using Fields = std::vector<Field>;

template <typename T>
Field one(const char* name) {
  return {name, [](Decoder& in) { return Json(in.get<T>()); }};
}
template <typename T>
Field some(const char* name, int count) {
  return {name, [count](Decoder& in) {
            Json list = Json::array();
            for (int i = 0; i < count; ++i) list.push_back(in.get<T>());
            return list;
          }};
}
template <typename T>
Field size_of(const char* name) {
  return {name, [](Decoder& in) { return Json(in.get<std::vector<T>>().size()); }};
}
Json read_fields(Decoder& in, const Fields& fields) {
  Json json = Json::object();
  for (const Field& field : fields) json[field.name] = field.read(in);
  return json;
}
Field list(const char* name, const Fields& fields) {
  return {name, [fields](Decoder& in) {
            Json items = Json::array();
            for (auto left = in.get<std::uint32_t>(); left > 0; --left) items.push_back(read_fields(in, fields));
            return items;
          }};
}

constexpr auto text = one<std::string>;
constexpr auto u8 = one<std::uint8_t>;
constexpr auto u32 = one<std::uint32_t>;
constexpr auto u64 = one<std::uint64_t>;
constexpr auto doubles = some<double>;
constexpr auto floats = some<float>;

const Field kStamp{"stamp_ns", [](Decoder& in) {
                     const std::int64_t s = in.get<std::int32_t>(), ns = in.get<std::uint32_t>();
                     return Json(s * 1'000'000'000 + ns);
                   }};
const Field kFrame = text("frame"), kChild = text("child"), kPose = doubles("pose", 7),
            kPoseCovariance = doubles("pose_covariance", 36);
const Field kCells{"cells", [](Decoder& in) {
                     std::map<std::string, int> cells = {{"occupied", 0}, {"free", 0}, {"unknown", 0}, {"others", 0}};
                     for (const std::int8_t cell : in.get<std::vector<std::int8_t>>())
                       ++cells[cell == 100 ? "occupied" : cell == 0 ? "free" : cell == -1 ? "unknown" : "others"];
                     return Json(cells);
                   }};
const Field kValues{"values", [](Decoder& in) {
                      Json values = Json::object();
                      for (auto left = in.get<std::uint32_t>(); left > 0; --left) {
                        const auto key = in.get<std::string>();
                        values[key] = in.get<std::string>();
                      }
                      return values;
                    }};

/// The fields of each message, in the order of its definition.
const std::map<std::string, Fields> kMessages = {
    {"Odometry",
     {kStamp, kFrame, kChild, kPose, kPoseCovariance, doubles("twist", 6), doubles("twist_covariance", 36)}},
    {"PoseWithCovarianceStamped", {kStamp, kFrame, kPose, kPoseCovariance}},
    {"Path", {kStamp, kFrame, list("poses", {kStamp, kFrame, kPose})}},
    {"PointCloud2",
     {kStamp, kFrame, u32("height"), u32("width"),
      list("fields", {text("name"), u32("offset"), u8("datatype"), u32("count")}), one<bool>("is_bigendian"),
      u32("point_step"), u32("row_step"), size_of<std::uint8_t>("bytes"), one<bool>("is_dense")}},
    {"OccupancyGrid",
     {kStamp, kFrame, one<std::int32_t>("load_time_s"), u32("load_time_ns"), one<float>("resolution"), u32("width"),
      u32("height"), doubles("origin", 7), kCells}},
    {"Octomap",
     {kStamp, kFrame, one<bool>("binary"), text("id"), one<double>("resolution"), size_of<std::int8_t>("bytes")}},
    {"Image",
     {kStamp, kFrame, u32("height"), u32("width"), text("encoding"), u8("is_bigendian"), u32("step"),
      size_of<std::uint8_t>("bytes")}},
    {"TFMessage", {list("transforms", {kStamp, kFrame, kChild, kPose})}},
    {"DiagnosticArray",
     {kStamp, kFrame, u32("statuses"), u8("level"), text("name"), text("message"), text("hardware"), kValues}},
    {"VehicleOdometry",
     {u64("timestamp"), u64("timestamp_sample"), u8("pose_frame"), floats("position", 3), floats("q", 4),
      u8("velocity_frame"), floats("velocity", 3), floats("angular_velocity", 3), floats("position_variance", 3),
      floats("orientation_variance", 3), floats("velocity_variance", 3), u8("reset_counter"),
      one<std::int8_t>("quality")}}};

/// Every field of the message; "complete" says whether nothing was left of it. type: "nav_msgs::msg::dds_::Odometry_".
Json fields_of(const std::string& type, const std::string& bytes) {
  const std::size_t begin = type.rfind(':') + 1;
  Decoder in(bytes);
  Json json = read_fields(in, kMessages.at(type.substr(begin, type.size() - begin - 1)));
  json["complete"] = in.at_end();
  return json;
}

/// Positions and rotations as trajectories have them. type: one with a pose.
void write_tum(const std::string& file, const std::string& type, const std::vector<std::string>& messages) {
  std::ofstream out(file);
  for (const std::string& bytes : messages) {
    const Json fields = fields_of(type, bytes);
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
  /// Whether the node publishes its poses to this.
  bool is_connected() const {
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
      if (output.poses) write_tum(out + output.poses, output.type, messages);
    }
    add_delays(json[kToPx4]);
    std::ofstream(out + ".json") << json.dump(1) << "\n";
  }

 private:
  /// From the time of the IMU sample, by the clock of this machine, until its state was here.
  void add_delays(Json& px4) {
    const std::vector<std::string> messages = collectors_[kToPx4].messages();
    std::vector<double> delays_ms;
    for (std::size_t i = 0; i < messages.size(); ++i) {
      const auto sampled_us = fields_of(kToPx4Type, messages[i])["timestamp_sample"].get<std::int64_t>();
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

/// "save_map:FILE", "load_map:FILE" or "reset" to the node, as `ros2 topic pub --once` sends it.
void request(Participant& participant, const std::string& node, const std::string& what) {
  const std::size_t sign = what.find(':');
  const std::string name = what.substr(0, sign);
  const bool reset = name == "reset";
  dds::DataWriter* writer =
      participant.writer("/" + node + "/" + name,
                         reset ? "std_msgs::msg::dds_::Empty_" : "std_msgs::msg::dds_::String_", {true, false, 1});
  wait_until([writer] { return Driver::readers(writer) > 0; }, "nobody takes requests");
  Encoder out(1024);
  if (reset) {
    out << std::uint8_t{0};
  } else {
    out << what.substr(sign + 1);
  }
  std::string bytes = out.bytes();
  writer->write(&bytes);
}

void drive_recording(Participant& participant, Driver& driver, const std::string& path, const Options& options) {
  const Recording recording = open_recording(path);
  const auto nodes = static_cast<int>(number_of(options, "nodes", 1));
  wait_until([&driver, nodes] { return driver.is_subscribed(nodes); }, "nobody subscribes");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // the readers of the other side match as well
  participant.lose(number_of(options, "loss", 0));
  const auto rig = options.find("rig");
  const Calibration calibration = rig == options.end() ? recording.calibration.value() : load_rig(rig->second);
  const CameraModel& camera = calibration.rig.find(Modality::Events)->model;
  const cv::Size sensor(camera.width(), camera.height());
  const double rate = number_of(options, "rate", 1.0);
  const auto duration = [&](const char* key, double s) { return duration_from_seconds(number_of(options, key, s)); };
  const Duration from = duration("from", 0), set_at = duration("set_at", 1e6), set_by = duration("set_by", 0);
  const Duration ask_at = duration("ask_at", 1e6);
  std::optional<Timestamp> first;
  bool asked = false;
  LiveClock pace;
  while (const auto measurement = recording.dataset->next()) {
    const auto t = last_stamp(*measurement);
    if (!t) continue;
    if (!first) first = *t;
    if (*t - *first < from) continue;
    if (*t - *first > set_at) driver.set_clock(set_by);
    if (*t - *first > ask_at && !std::exchange(asked, true)) request(participant, "edged", options.at("ask"));
    pace.wait_for(*first + duration_from_seconds(to_seconds(*t - *first) / rate), [] { return false; });
    driver.send(*measurement, sensor);
  }
}

/// A robot's description: tf2_msgs/TFMessage from that frame to the body.
void describe_robot(Participant& participant, const std::string& base) {
  Encoder out(1024);
  (out << std::uint32_t{1}).header(0, base);
  out << std::string("body");
  out.doubles({0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0});
  std::string tree = out.bytes();
  participant.writer("/tf_static", "tf2_msgs::msg::dds_::TFMessage_", {true, true, 1})->write(&tree);
}

int run_peer(const std::string& recording, const std::string& out, const Options& options) {
  const char* domain = std::getenv("ROS_DOMAIN_ID");
  Participant participant(domain ? static_cast<std::uint32_t>(std::atoi(domain)) : 0,
                          number_of(options, "interfaces", 1) < 2);
  const auto node = options.find("node");
  Listener listener(participant, node == options.end() ? "edged" : node->second);
  if (options.contains("base")) describe_robot(participant, options.at("base"));
  std::optional<Driver> driver;
  if (recording != "none") {
    driver.emplace(participant, options);
    drive_recording(participant, *driver, recording, options);
  } else {
    wait_until([&listener] { return listener.is_connected(); }, "nobody publishes");
    if (options.contains("ask")) request(participant, "edged", options.at("ask"));
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
