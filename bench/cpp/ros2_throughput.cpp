// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Event packets of EVT3 at a high rate over the loopback interface: how many arrive, and what the transport costs.
// Usage: edged_ros2_bench [SECONDS=60] [MEVENTS_PER_S=20] [decode]
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string_view>
#include <thread>

#include "dds/subscription.hpp"
#include "edged/io/parse/evt.hpp"
#include "edged/io/ros/messages/event_packets.hpp"
#include "edged/io/ros/messages/messages.hpp"

namespace edged::ros2 {
namespace {

using Clock = std::chrono::steady_clock;
constexpr const char* kTopic = "/events";
constexpr std::uint32_t kWidth = 1280, kHeight = 720;

double processor_s() {
  rusage used;
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

Discovery bench_discovery() {
  Discovery discovery = discovery_of();
  discovery.range = DiscoveryRange::Localhost;
  return discovery;
}

/// A millisecond of events of independent pixels, which EVT3 compresses least.
std::vector<Event> millisecond(std::size_t count) {
  std::mt19937 random(1);
  std::vector<Event> events(count);
  for (std::size_t i = 0; i < count; ++i)
    events[i] = {timestamp_from_ns(static_cast<std::int64_t>(1000 * i / count) * 1000),
                 static_cast<std::uint16_t>(random() % kWidth), static_cast<std::uint16_t>(random() % kHeight),
                 random() % 2 == 0};
  return events;
}

int send(int seconds, double mevents_per_s) {
  const std::vector<Event> events = millisecond(static_cast<std::size_t>(1e3 * mevents_per_s));
  EvtEncoder encoder(EvtFormat::Evt3);
  const std::string evt3 = encoder.encode(events);
  const Participant participant(bench_discovery());
  const Writer writer(participant, kTopic, "event_camera_msgs/EventPacket", {.reliable = false, .depth = 1000});
  while (writer.readers() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const auto begin = Clock::now();
  const double before_s = processor_s();
  const int packets = 1000 * seconds;
  for (int i = 0; i < packets; ++i) {
    const Duration t = i * std::chrono::milliseconds(1);
    std::this_thread::sleep_until(begin + t);
    const auto ns = static_cast<std::uint64_t>(t.count());
    writer.write(event_packet_message(
        Wire::Cdr, {Timestamp() + t, kWidth, kHeight, static_cast<std::uint64_t>(i), ns, "evt3", as_bytes(evt3)},
        "bench"));
  }
  const double took_s = std::chrono::duration<double>(Clock::now() - begin).count();
  std::printf("sent %d packets of %zu events, %.1f kB, in %.1f s: %.1f MB/s; processor %.2f s/s\n", packets,
              events.size(), 1e-3 * static_cast<double>(evt3.size()), took_s,
              1e-6 * static_cast<double>(evt3.size()) * packets / took_s, (processor_s() - before_s) / took_s);
  std::fflush(stdout);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  return 0;
}

int receive(int seconds, bool decode, int sender) {
  const Participant participant(bench_discovery());
  std::atomic<std::uint64_t> packets = 0, events = 0;
  EventMessageDecoder decoder;
  Subscription subscription(participant, {kTopic,
                                          {.reliable = false, .depth = 1000},
                                          [](const std::string&) { return true; },
                                          [&](const std::string&, ByteSpan cdr) {
                                            const EventPacket packet = read_event_packet(WireReader(Wire::Cdr, cdr));
                                            if (decode) events += decoder.decode(packet).size();
                                            ++packets;
                                          }});
  while (packets == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const auto begin = Clock::now();
  const double before_s = processor_s();
  int status = 0;
  waitpid(sender, &status, 0);
  const double used_s = processor_s() - before_s, took_s = std::chrono::duration<double>(Clock::now() - begin).count();
  std::printf("received %llu of %d packets%s, %zu refused or known to be lost; processor %.2f s/s\n",
              static_cast<unsigned long long>(packets.load()), 1000 * seconds, decode ? " and decoded them" : "",
              subscription.lost() + subscription.refused(), used_s / (took_s - 1.0));
  return 0;
}

}  // namespace
}  // namespace edged::ros2

int main(int argc, char** argv) {
  const int seconds = argc > 1 ? std::atoi(argv[1]) : 60;
  const double mevents_per_s = argc > 2 ? std::atof(argv[2]) : 20.0;
  const bool decode = argc > 3 && std::string_view(argv[3]) == "decode";
  const pid_t sender = fork();
  if (sender == 0) return edged::ros2::send(seconds, mevents_per_s);
  return edged::ros2::receive(seconds, decode, sender);
}
