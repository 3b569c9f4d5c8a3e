// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Creates bags in each container.
#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "edged/io/archive/compression.hpp"
#include "edged/io/ros/bag/message_records.hpp"
#include "edged/io/ros/bag/open_messages.hpp"
#include "edged/io/ros/messages/messages.hpp"
#include "edged/io/test_support.hpp"

namespace edged {

/// A ROS 2 bag in SQLite, whose messages are compressed one by one with `compression`.
class Db3Writer final : public MessageSink {
 public:
  explicit Db3Writer(const std::filesystem::path& file, std::string_view compression = "none")
      : compression_(compression) {
    check(sqlite3_open(file.string().c_str(), &database_));
    run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT, "
        "offered_qos_profiles TEXT)");
    run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)");
    run("BEGIN");
  }
  ~Db3Writer() override { sqlite3_close(database_); }
  Db3Writer(const Db3Writer&) = delete;
  Db3Writer& operator=(const Db3Writer&) = delete;

  Wire wire() const override { return Wire::Cdr; }
  std::size_t add_topic(std::string_view name, std::string_view type, const MessageDefinition&) override {
    run(fmt::format("INSERT INTO topics VALUES({}, '{}', '{}', 'cdr', '')", ++topics_, name, ros2_type(type)));
    return topics_;
  }
  void write(std::size_t topic, Timestamp t, std::string_view message) override {
    const std::string packed = compress(compression_, message);
    sqlite3_stmt* insert = nullptr;
    check(sqlite3_prepare_v2(database_, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", -1, &insert,
                             nullptr));
    sqlite3_bind_int64(insert, 1, static_cast<sqlite3_int64>(topic));
    sqlite3_bind_int64(insert, 2, to_ns(t));
    sqlite3_bind_blob(insert, 3, packed.data(), static_cast<int>(packed.size()), SQLITE_STATIC);
    sqlite3_step(insert);
    check(sqlite3_finalize(insert));
  }
  void finish() override { run("COMMIT"); }
  void run(const std::string& query) { check(sqlite3_exec(database_, query.c_str(), nullptr, nullptr, nullptr)); }

 private:
  static void check(int result) { ASSERT_EQ(result, SQLITE_OK); }

  std::string compression_;
  sqlite3* database_ = nullptr;
  std::size_t topics_ = 0;
};

struct BagContainer {
  const char* name;
  const char* extension;
  std::unique_ptr<MessageSink> (*make)(const std::filesystem::path& file);
};

inline constexpr std::size_t kSmallChunk = 4096;  // so that a small bag has several

inline std::unique_ptr<MessageSink> make_bag(const std::filesystem::path& file, std::string_view compression) {
  return create_ros1_bag(file, {compression, kSmallChunk});
}
inline std::unique_ptr<MessageSink> make_mcap(const std::filesystem::path& file, std::string_view compression) {
  return std::make_unique<McapWriter>(file, "ros2", ChunkOptions{compression, kSmallChunk});
}
inline std::unique_ptr<MessageSink> make_db3(const std::filesystem::path& file, std::string_view compression) {
  return std::make_unique<Db3Writer>(file, compression);
}

inline const BagContainer kBagContainers[] = {
    {"ros1", ".bag", [](const auto& file) { return make_bag(file, "none"); }},
    {"ros1_lz4", ".bag", [](const auto& file) { return make_bag(file, "lz4"); }},
    {"mcap", ".mcap", [](const auto& file) { return make_mcap(file, ""); }},
    {"mcap_lz4", ".mcap", [](const auto& file) { return make_mcap(file, "lz4"); }},
    {"mcap_zstd", ".mcap", [](const auto& file) { return make_mcap(file, "zstd"); }},
    {"db3", ".db3", [](const auto& file) { return make_db3(file, "none"); }},
    {"db3_zstd_messages", ".db3", [](const auto& file) { return make_db3(file, "zstd"); }},
};

inline const cv::Size kBagSensor(346, 260);

/// `count` events, one per microsecond.
inline EventBatch bag_events(Timestamp begin, int count, unsigned seed) {
  std::mt19937 random(seed);
  EventBatch batch{"events", {}};
  for (int i = 0; i < count; ++i)
    batch.events.push_back({begin + std::chrono::microseconds(i),
                            static_cast<std::uint16_t>(random() % static_cast<unsigned>(kBagSensor.width)),
                            static_cast<std::uint16_t>(random() % static_cast<unsigned>(kBagSensor.height)),
                            random() % 2 == 0});
  return batch;
}

/// Messages of one topic, one of them at each of the stamps.
struct TestTopic {
  std::string name, type;
  std::vector<std::pair<Timestamp, std::string>> messages;
  MessageDefinition definition = {};
};

/// The messages of all topics in the order of their stamps.
inline std::filesystem::path write_bag(const std::filesystem::path& file, MessageSink& sink,
                                       const std::vector<TestTopic>& topics) {
  std::vector<std::size_t> ids, next(topics.size(), 0);
  for (const TestTopic& topic : topics) ids.push_back(sink.add_topic(topic.name, topic.type, topic.definition));
  while (true) {
    std::size_t first = topics.size();
    for (std::size_t i = 0; i < topics.size(); ++i)
      if (next[i] < topics[i].messages.size() &&
          (first == topics.size() || topics[i].messages[next[i]].first < topics[first].messages[next[first]].first))
        first = i;
    if (first == topics.size()) break;
    const auto& [t, message] = topics[first].messages[next[first]++];
    sink.write(ids[first], t, message);
  }
  sink.finish();
  return file;
}

inline std::filesystem::path write_bag(const TempFolder& folder, const BagContainer& container,
                                       const std::vector<TestTopic>& topics) {
  const std::filesystem::path file = folder.path() / (std::string("a") + container.extension);
  return write_bag(file, *container.make(file), topics);
}

/// event_camera_msgs/EventPacket.
inline std::string event_packet_message(Wire wire, Timestamp stamp, std::uint64_t sequence, std::uint64_t time_base,
                                        std::string_view encoding, std::string_view events) {
  return event_packet_message(
      wire,
      {stamp, static_cast<std::uint32_t>(kBagSensor.width), static_cast<std::uint32_t>(kBagSensor.height), sequence,
       time_base, encoding, as_bytes(events)},
      "events");
}

/// sensor_msgs/FluidPressure [Pa].
inline std::string pressure_message(Wire wire, Timestamp stamp, double pressure_pa, double variance = 0.0) {
  WireWriter out(wire);
  out.header(stamp, "barometer");
  out.number(pressure_pa);
  out.number(variance);
  return out.message();
}

/// sensor_msgs/Range of 0.2 to 40 m.
inline std::string range_message(Wire wire, Timestamp stamp, float range_m) {
  WireWriter out(wire);
  out.header(stamp, "sonar");
  out.number(std::uint8_t{0});
  for (const float value : {0.1F, 0.2F, 40.0F, range_m}) out.number(value);
  return out.message();
}

/// geometry_msgs/TwistStamped, or with the variances of the linear velocity a TwistWithCovarianceStamped.
inline std::string twist_message(Wire wire, Timestamp stamp, const Eigen::Vector3d& v,
                                 const std::optional<Eigen::Vector3d>& variances = std::nullopt) {
  WireWriter out(wire);
  out.header(stamp, "wheels");
  for (int i = 0; i < 6; ++i) out.number(i < 3 ? v[i] : 0.1);
  for (int i = 0; variances && i < 36; ++i) out.number(i % 7 == 0 && i / 7 < 3 ? (*variances)[i / 7] : 0.0);
  return out.message();
}

/// A complete small recording: 40 event messages, 8 images, 40 IMU samples and 40 poses in 0.2 s from 100 s on.
struct SmallBag {
  std::vector<Event> events;
  std::vector<TestTopic> topics;

  explicit SmallBag(Wire wire) {
    topics = {{"/dvs/events", "dvs_msgs/EventArray", {}, definition_of("dvs_msgs/EventArray", wire)},
              {"/camera/image_raw", "sensor_msgs/Image", {}, definition_of("sensor_msgs/Image", wire)},
              {"/imu/data", "sensor_msgs/Imu", {}, definition_of("sensor_msgs/Imu", wire)},
              {"/pose", "geometry_msgs/TransformStamped", {}, definition_of("geometry_msgs/TransformStamped", wire)}};
    for (int i = 0; i < 40; ++i) {
      const Timestamp t = timestamp_from_ns(100'000'000'000 + 5'000'000LL * i);
      const EventBatch batch = bag_events(t, 50, static_cast<unsigned>(i));
      events.insert(events.end(), batch.events.begin(), batch.events.end());
      topics[0].messages.emplace_back(batch.events.back().t, event_array_message(wire, batch, kBagSensor));
      if (i % 5 == 0)
        topics[1].messages.emplace_back(t, image_message(wire, {t, "frames", cv::Mat(20, 30, CV_8UC1, cv::Scalar(i))}));
      const Eigen::Vector3d v(0.1 * i, 1.0 / 3.0, -2.0);
      topics[2].messages.emplace_back(t, imu_message(wire, {t, v, 3.0 * v}));
      topics[3].messages.emplace_back(t,
                                      transform_message(wire, {t, SE3(Eigen::Quaterniond(0, 0.6, 0, 0.8), v)}, "body"));
    }
  }
};

}  // namespace edged
