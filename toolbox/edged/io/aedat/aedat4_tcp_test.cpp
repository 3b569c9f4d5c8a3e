// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// AEDAT4 over TCP, from a server in this process that behaves like one of DV.
#include "edged/io/aedat/aedat.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "edged/io/aedat/aedat4_dataset.hpp"
#include "edged/io/aedat/aedat4_writer.hpp"
#include "edged/io/open_recording.hpp"
#include "edged/io/parse/evt_test_support.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

const cv::Size kLiveSensor(346, 260);

/// The header without the version line, as servers send it.
std::string network_header(const Aedat4Encoder& encoder) { return encoder.header().substr(kAedat4Magic.size()); }

/// Sends bytes to the first client, in pieces, and closes the connection.
class Server {
 public:
  Server(std::string bytes, std::size_t piece, bool stays = false)
      : listener_(::socket(AF_INET, SOCK_STREAM, 0)), bytes_(std::move(bytes)), piece_(piece), stays_(stays) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(listener_, 1), 0);
    socklen_t size = sizeof address;
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~Server() {
    end_ = true;
    ::shutdown(listener_, SHUT_RDWR);
    thread_.join();
    ::close(listener_);
  }

  std::string port() const { return std::to_string(port_); }
  std::string address() const { return "tcp://127.0.0.1:" + port(); }

 private:
  void serve() {
    const int client = ::accept(listener_, nullptr, nullptr);
    if (client < 0) return;
    for (std::size_t at = 0; at < bytes_.size();) {
      const ssize_t sent = ::send(client, bytes_.data() + at, std::min(piece_, bytes_.size() - at), MSG_NOSIGNAL);
      if (sent <= 0) break;
      at += static_cast<std::size_t>(sent);
    }
    while (stays_ && !end_) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ::close(client);
  }

  int listener_;
  std::string bytes_;
  std::size_t piece_;
  bool stays_;
  std::uint16_t port_ = 0;
  std::atomic<bool> end_ = false;
  std::thread thread_;
};

/// 10000 events in packets of this size, with some IMU samples and frames.
struct LiveTalk {
  explicit LiveTalk(std::ptrdiff_t packet_events) {
    Aedat4Encoder encoder(Aedat4Encoder::Compression::Lz4, kLiveSensor);
    text = network_header(encoder);
    for (auto at = events.begin(); at != events.end();) {
      const auto end = at + std::min(packet_events, events.end() - at);
      const ImuSample sample{at->t, {1, 2, 3}, {0, 0, 9.8}};
      text += encoder.imu({&sample, 1});
      text += encoder.frame({at->t, "", cv::Mat(260, 346, CV_8UC1, cv::Scalar(7))});
      text += encoder.events({&*at, static_cast<std::size_t>(end - at)});
      ++packets;
      at = end;
    }
  }

  std::vector<Event> events = generated_events(10'000, kLiveSensor.width, kLiveSensor.height, 50);
  std::size_t packets = 0;
  std::string text;
};

TEST(Aedat4Tcp, GivesWhatTheServerSendsHoweverItComes) {
  for (const std::ptrdiff_t packet_events : {100, 4000}) {
    const LiveTalk talk(packet_events);
    for (const std::size_t piece : {std::size_t{7}, std::size_t{1460}, std::size_t{1} << 20U}) {
      const Server server(talk.text, piece);
      const Recording recording = open_recording(server.address());
      EXPECT_EQ(recording.dataset->info().event_sensor, kLiveSensor);
      const Contents c = read_all(*recording.dataset);
      EXPECT_TRUE(c.events == talk.events);
      EXPECT_EQ(c.imu.size(), talk.packets);
      EXPECT_EQ(c.frames.size(), talk.packets);
      EXPECT_TRUE(recording.dataset->repairs().empty());
    }
  }
}

TEST(Aedat4Tcp, AVersionLineInFrontIsNoHindrance) {
  const LiveTalk talk(1000);
  const Server server("#!AER-DAT4.0\r\n" + talk.text, 5);
  EXPECT_TRUE(read_all(*open_recording(server.address()).dataset).events == talk.events);
}

TEST(Aedat4Tcp, StreamsOfSeveralPortsAreMerged) {
  const LiveTalk talk(1000);
  Aedat4Encoder encoder(Aedat4Encoder::Compression::Zstd, kLiveSensor);
  const auto only = [](std::string header, const std::vector<std::string>& others) {
    for (const std::string& type : others) header.replace(header.find(">" + type) + 1, 4, "TRIG");
    return header;
  };
  std::string imu = only(network_header(encoder), {"EVTS", "FRME"});
  for (std::size_t i = 0; i < talk.events.size(); i += 100) {
    const ImuSample sample{talk.events[i].t, {1, 2, 3}, {0, 0, 9.8}};
    imu += encoder.imu({&sample, 1});
  }
  std::string events = only(network_header(encoder), {"FRME", "IMUS"});
  for (std::size_t i = 0; i < talk.events.size(); i += 500) events += encoder.events({&talk.events[i], 500});
  const Server first(events, 1000), second(imu, 1000);
  const Recording recording = open_recording(first.address() + "," + second.port());
  EXPECT_FALSE(recording.dataset->info().has_frames);
  const Contents c = read_all(*recording.dataset);
  EXPECT_EQ(c.events.size(), talk.events.size());
  EXPECT_EQ(c.imu.size(), 100u);
}

TEST(Aedat4Tcp, AServerThatDiesWithinAPacketEndsTheRecording) {
  const LiveTalk talk(1000);
  const Server server(talk.text.substr(0, talk.text.size() - 100), 1460);
  const Recording recording = open_recording(server.address());
  const Contents c = read_all(*recording.dataset);
  EXPECT_EQ(c.events.size(), 9000u);
  EXPECT_EQ(recording.dataset->repairs().at("stream: cut within a packet"), 1u);
}

TEST(Aedat4Tcp, AnInterruptEndsTheWaiting) {
  const LiveTalk talk(1000);
  const Server server(talk.text, 1460, true);
  std::atomic<bool> enough = false;
  const Recording recording =
      open_recording(server.address(), nullptr, {.interrupted = [&enough] { return enough.load(); }});
  EXPECT_TRUE(recording.dataset->next());
  enough = true;
  EXPECT_GT(read_all(*recording.dataset).all.size(), 0u);  // what had arrived before
}

TEST(Aedat4Tcp, RefusalsSayWhatIsWrong) {
  std::string closed;
  {
    const Server server("", 1);
    closed = server.address();
    EXPECT_THAT(input_error([&] { open_recording(closed); }), HasSubstr("closed before its header"));
  }
  EXPECT_THAT(input_error([&] { open_recording(closed); }), HasSubstr("is the server running"));
  EXPECT_THAT(input_error([] { open_recording("tcp://nowhere"); }), HasSubstr("write tcp://HOST:PORT"));
  const Server web("HTTP/1.1 400 Bad Request\r\n\r\n", 100);
  EXPECT_THAT(input_error([&] { open_recording(web.address()); }), HasSubstr("no AEDAT4 header"));
  LiveTalk talk(1000);
  talk.text = talk.text.substr(0, talk.text.size() / 2) + std::string(200'000, '\xff');
  const Server damaged(talk.text, 1460);
  EXPECT_THAT(input_error([&] { read_all(*open_recording(damaged.address()).dataset); }),
              HasSubstr("the stream is damaged"));
}

}  // namespace
}  // namespace edged
