// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "dds/player.hpp"

#include <algorithm>
#include <chrono>

#include "edged/core/check.hpp"
#include "edged/core/measurements/external_sensor.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/parse/evt.hpp"
#include "edged/io/parse/text_parsing.hpp"
#include "edged/io/ros/messages/messages.hpp"
#include "edged/live/live_clock.hpp"

namespace edged::ros2 {
namespace {

constexpr Duration kPacketTime = std::chrono::milliseconds(1), kClockPeriod = std::chrono::milliseconds(10);
constexpr Duration kLongestFlush = std::chrono::seconds(2);
constexpr std::size_t kPacketEvents = 16'384, kDepth = 1000;
constexpr const char* kClock = "/clock";

bool whole_microseconds(std::span<const Event> events) {
  return std::ranges::all_of(events, [](const Event& event) { return to_ns(event.t) % 1000 == 0; });
}

/// 64 bits each: polarity 1, row 15, column 16, nanoseconds since the first event 32.
std::string encode_mono(std::span<const Event> events) {
  std::string bytes;
  for (const Event& event : events) {
    const auto since = static_cast<std::uint64_t>((event.t - events.front().t).count());
    append_number(bytes, since | std::uint64_t{event.x} << 32U | std::uint64_t{event.y} << 48U |
                             std::uint64_t{event.positive ? 1U : 0U} << 63U);
  }
  return bytes;
}

}  // namespace

Player::Player(const PlaySetup& setup, WriterSetup recording)
    : setup_(setup), recording_(std::move(recording)), participant_(setup.discovery), clock_(kClockPeriod) {
  const DatasetInfo& info = recording_.info;
  const auto add_cameras = [&](Modality modality, bool has, std::string_view type) {
    for (std::size_t i = 0; has && i < recording_.cameras(modality); ++i) {
      const std::string topic = camera_topic(i, modality);
      add_topic(topic, type);
      if (modality == Modality::Events) streams_[topic].sensor = recording_.event_sensor(i);
    }
  };
  add_cameras(Modality::Events, info.has_events, "event_camera_msgs/EventPacket");
  add_cameras(Modality::Frames, info.has_frames, "sensor_msgs/Image");
  if (info.has_imu) add_topic("imu", "sensor_msgs/Imu");
  for (std::size_t i = 0; i < external_sensors().size(); ++i) {
    const std::string name(external_sensors()[i].name);
    if (std::ranges::count(info.external, name) > 0) add_topic(name, external_type(i));
  }
  add_topic(kClock, "rosgraph_msgs/Clock");
  setup_.names->check_remappings();
}

/// The first of a kind has a short name, another its own.
std::string Player::camera_topic(std::size_t place, Modality modality) const {
  const std::string topic = modality == Modality::Events ? "events" : "image";
  return place == 0 ? topic : recording_.camera_name(modality, place) + "/" + topic;
}

void Player::add_topic(const std::string& topic, std::string_view type) {
  const bool reliable = !setup_.best_effort || topic == kClock;
  const Qos qos{.reliable = reliable, .depth = kDepth, .longest_block = std::chrono::seconds(1)};
  writers_.try_emplace(topic, participant_, setup_.names->full_name(topic), type, qos);
}

std::string Player::unsubscribed() const {
  const auto imu = writers_.find("imu");
  const auto asked = imu == writers_.end() ? writers_.begin() : imu;
  const auto is_read = [](const auto& writer) { return writer.second.readers() > 0; };
  const bool read = is_read(*asked) || (imu == writers_.end() && std::ranges::any_of(writers_, is_read));
  return read ? "" : setup_.names->full_name(asked->first);
}

PlayCounters Player::play(Dataset& dataset, const std::function<bool()>& stop,
                          const std::function<void(Timestamp)>& progress) {
  counters_ = {};
  LiveClock pace;
  std::optional<Timestamp> first;
  while (!stop()) {
    const std::optional<Measurement> measurement = dataset.next();
    if (!measurement) break;
    const std::optional<Timestamp> t = last_stamp(*measurement);
    if (!t) continue;
    check_stamp(*first_stamp(*measurement));
    check_stamp(*t);
    if (!first) first = *t;
    pace.wait_for(*first + duration_from_seconds(to_seconds(*t - *first) / setup_.rate), stop);
    send(*measurement, stop);
    send_clock(*t);
    progress(*t);
  }
  if (!stop()) flush();
  return counters_;
}

void Player::check_stamp(Timestamp t) const {
  if (t < Timestamp() || t > latest_stamp(Wire::Cdr))
    throw InputError::format("{}: ROS messages cannot hold the stamp {} s; shift the recording's clock",
                             recording_.info.name, format_seconds(t));
}

/// Until reliable subscribers have all, but not longer than they may take together.
void Player::flush() const {
  const auto end = std::chrono::steady_clock::now() + kLongestFlush;
  for (const auto& [topic, writer] : writers_)
    writer.flush(std::max(Duration(0), Duration(end - std::chrono::steady_clock::now())));
}

void Player::send(const std::string& topic, const std::string& message) {
  const auto writer = writers_.find(topic);
  if (writer == writers_.end()) return;
  ++counters_.messages;
  if (!writer->second.write(message)) ++counters_.dropped;
}

void Player::send(const Measurement& measurement, const std::function<bool()>& stop) {
  if (const auto* batch = std::get_if<EventBatch>(&measurement)) {
    send(*batch, stop);
  } else if (const auto* frame = std::get_if<Frame>(&measurement)) {
    const std::size_t place = recording_.place_of(frame->camera, Modality::Frames);
    send(camera_topic(place, Modality::Frames), image_message(Wire::Cdr, *frame));
  } else if (const auto* sample = std::get_if<ImuSample>(&measurement)) {
    send("imu", imu_message(Wire::Cdr, *sample));
  } else {
    const auto& external = std::get<ExternalSample>(measurement);
    send(std::string(sensor_of(external).name), external_message(Wire::Cdr, external));
  }
}

/// In packets like those of a driver; each may wait for a slow subscriber.
void Player::send(const EventBatch& batch, const std::function<bool()>& stop) {
  const std::string topic = camera_topic(recording_.place_of(batch.camera, Modality::Events), Modality::Events);
  EventStream& stream = streams_[topic];
  for (std::span<const Event> rest = batch.events; !rest.empty() && !stop();) {
    const auto late =
        std::ranges::find_if(rest, [&](const Event& event) { return event.t - rest.front().t >= kPacketTime; });
    const std::size_t count = std::min<std::size_t>(static_cast<std::size_t>(late - rest.begin()), kPacketEvents);
    send_packet(stream, topic, batch.camera, rest.first(count));
    rest = rest.subspan(count);
    counters_.events += count;
  }
}

void Player::send_packet(EventStream& stream, const std::string& topic, const std::string& camera,
                         std::span<const Event> events) {
  if (stream.encoding.empty()) stream.encoding = whole_microseconds(events) ? "evt3" : "mono";
  EvtEncoder encoder(EvtFormat::Evt3);  // anew for each packet, which can be decoded by itself then
  const std::string bytes = stream.encoding == "evt3" ? encoder.encode(events) : encode_mono(events);
  const EventPacket packet{events.front().t,
                           static_cast<std::uint32_t>(stream.sensor.width),
                           static_cast<std::uint32_t>(stream.sensor.height),
                           stream.sequence++,
                           static_cast<std::uint64_t>(to_ns(events.front().t)),
                           stream.encoding,
                           as_bytes(bytes)};
  send(topic, event_packet_message(Wire::Cdr, packet, camera));
}

void Player::send_clock(Timestamp t) {
  if (!clock_.begins(t)) return;
  WireWriter out(Wire::Cdr);
  out.time(t);
  send(kClock, out.message());
}

}  // namespace edged::ros2
