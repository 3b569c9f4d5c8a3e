// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A connection sends the header of a file without the version line, then packets as in a file.
#include "edged/io/aedat/aedat.hpp"

#include <netdb.h>
#include <poll.h>
#include <spdlog/fmt/fmt.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <memory>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/io/aedat/aedat4_dataset.hpp"

namespace edged {
namespace {

constexpr std::size_t kMostHeaderBytes = std::size_t{1} << 20U;
constexpr std::size_t kMostLiveBytes = std::size_t{1} << 26U;  // in a packet: a frame of 20 megapixels in colour
constexpr int kPollMs = 100;

/// A TCP connection that only receives.
class TcpConnection {
 public:
  /// Throws InputError if no server accepts the connection.
  TcpConnection(const std::string& host, const std::string& port) : name_(host + ":" + port) {
    addrinfo wanted{};
    wanted.ai_socktype = SOCK_STREAM;
    addrinfo* list = nullptr;
    if (const int error = getaddrinfo(host.c_str(), port.c_str(), &wanted, &list); error != 0)
      throw InputError::format("tcp://{}: {}: give tcp://HOST:PORT", name_, gai_strerror(error));
    const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(list, &freeaddrinfo);
    int reason = 0;
    for (const addrinfo* a = list; a && socket_ < 0; a = a->ai_next) {
      socket_ = ::socket(a->ai_family, a->ai_socktype | SOCK_CLOEXEC, a->ai_protocol);
      if (socket_ >= 0 && ::connect(socket_, a->ai_addr, a->ai_addrlen) == 0) return;
      reason = errno;
      if (socket_ >= 0) ::close(std::exchange(socket_, -1));
    }
    throw InputError::format("tcp://{}: {}: is the server running, with its TCP output on this port?", name_,
                             std::strerror(reason));
  }
  ~TcpConnection() {
    if (socket_ >= 0) ::close(socket_);
  }
  TcpConnection(const TcpConnection&) = delete;
  TcpConnection& operator=(const TcpConnection&) = delete;

  const std::string& name() const { return name_; }  ///< "HOST:PORT", for messages
  int descriptor() const { return socket_; }         ///< for poll()

  /// Appends the bytes that have arrived, about 64 kB at most, to received(). Closes this end after the server has
  /// closed the connection.
  void receive() {
    constexpr std::size_t kStep = 1 << 16;
    const std::size_t before = received_.size();
    received_.resize(before + kStep);
    const ssize_t got = ::recv(socket_, received_.data() + before, kStep, MSG_DONTWAIT);
    received_.resize(before + (got > 0 ? static_cast<std::size_t>(got) : 0));
    // A server that crashes resets the connection, which counts as its end.
    if (got == 0 || (got < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) open_ = false;
  }
  const Bytes& received() const { return received_; }
  /// Removes the first bytes of received().
  void drop(std::size_t count) {
    received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(count));
  }
  bool open() const { return open_; }

 private:
  std::string name_;
  int socket_ = -1;
  bool open_ = true;
  Bytes received_;
};

/// Waits a moment for any of the open connections and receives what has arrived.
void receive_some(std::vector<TcpConnection*> connections) {
  std::erase_if(connections, [](const TcpConnection* c) { return !c->open(); });
  std::vector<pollfd> polled;
  for (const TcpConnection* c : connections) polled.push_back({c->descriptor(), POLLIN, 0});
  if (::poll(polled.data(), polled.size(), kPollMs) <= 0) return;
  for (std::size_t i = 0; i < polled.size(); ++i)
    if (polled[i].revents != 0) connections[i]->receive();
}

/// The header once it is complete. Throws Damage if the received bytes are not a header.
std::optional<Aedat4Header> take_header(TcpConnection& connection) {
  if (as_text(connection.received()).starts_with(kAedat4Magic)) connection.drop(kAedat4Magic.size());
  const ByteSpan received = connection.received();
  if (received.size() < 4 + kPacketHeadBytes || kAedat4Magic.starts_with(as_text(received))) return std::nullopt;
  const auto bytes = number_at<std::uint32_t>(received, 0);
  if (bytes < kPacketHeadBytes || bytes > kMostHeaderBytes) throw Damage("its length is invalid");
  if (flat_identifier(received.subspan(4)) != "IOHE") throw Damage("is of another type");
  if (received.size() < 4 + bytes) return std::nullopt;
  Aedat4Header header = parse_aedat4_header(received.subspan(4, bytes));
  connection.drop(4 + bytes);
  return header;
}

/// Throws InputError if no header arrives.
Aedat4Header wait_for_header(TcpConnection& connection) {
  constexpr auto kPatience = std::chrono::seconds(5);
  const auto refuse = [&](const std::string& what) {
    return InputError::format("tcp://{}: {}: is it the TCP output of a DV server, without encryption?",
                              connection.name(), what);
  };
  const auto until = std::chrono::steady_clock::now() + kPatience;
  try {
    while (true) {
      if (auto header = take_header(connection)) return *header;
      if (!connection.open()) throw refuse("closed before its header was whole");
      if (std::chrono::steady_clock::now() > until) throw refuse("sent no AEDAT4 header within 5 s");
      receive_some({&connection});
    }
  } catch (const Damage& damage) {
    throw refuse(fmt::format("sends no AEDAT4 header ({})", damage.what()));
  }
}

/// A server, with the streams that are read from it.
struct LiveStream {
  std::unique_ptr<TcpConnection> connection;
  Aedat4Header header;
  std::size_t first = 0;    ///< place of its first stream among those of all servers
  std::uint64_t taken = 0;  ///< bytes of packets so far
};

class Aedat4Live final : public Aedat4Dataset {
 public:
  Aedat4Live(const std::string& address, std::vector<LiveStream> streams, const Rig* rig,
             const RecordingOptions& options)
      : Aedat4Dataset(address, "aedat4-tcp"), streams_(std::move(streams)), interrupted_(options.interrupted) {
    info_.name = "live";
    std::vector<Aedat4Stream> all;
    for (const LiveStream& stream : streams_)
      all.insert(all.end(), stream.header.streams.begin(), stream.header.streams.end());
    choose(all, rig, options);
    begin_chosen();
  }

 private:
  /// Waits for a packet. False once all servers have closed the connection, or after an interrupt.
  bool read_on() override {
    while (!interrupted_ || !interrupted_()) {
      bool any = false, open = false;
      for (LiveStream& stream : streams_) {
        any = take_whole_packets(stream) || any;
        open = open || stream.connection->open();
      }
      if (any) return true;
      if (!open) break;
      std::vector<TcpConnection*> connections;
      for (LiveStream& stream : streams_) connections.push_back(stream.connection.get());
      receive_some(connections);
    }
    for (const LiveStream& stream : streams_)
      if (!stream.connection->received().empty())
        repairs_.add("stream: cut within a packet",
                     fmt::format("tcp://{}: ended within a packet", stream.connection->name()));
    return false;
  }

  /// False if no packet was complete.
  bool take_whole_packets(LiveStream& stream) {
    const ByteSpan received = stream.connection->received();
    std::size_t at = 0;
    while (received.size() - at >= kPacketHeadBytes) {
      const Aedat4PacketHead packet = parse_packet_head(received.subspan(at), stream.header.streams);
      const std::size_t body = at + kPacketHeadBytes, size = static_cast<std::size_t>(packet.bytes);
      if (!packet.stream || size > kMostLiveBytes)
        throw InputError::format(
            "tcp://{}: a packet of stream {} with {} bytes is invalid: the stream is damaged; start again",
            stream.connection->name(), packet.number, packet.bytes);
      if (received.size() - body < size) break;
      const std::size_t place = stream.first + *packet.stream;
      if (reads(place))
        take_packet(place, stream.header.compression, received.subspan(body, size),
                    fmt::format("{} bytes into tcp://{}", stream.taken + at, stream.connection->name()));
      at = body + size;
    }
    stream.taken += at;
    stream.connection->drop(at);
    return at > 0;
  }

  std::vector<LiveStream> streams_;
  std::function<bool()> interrupted_;
};

/// Host and ports of "tcp://HOST:PORT,PORT".
std::pair<std::string, std::vector<std::string>> parse_address(const std::string& address) {
  std::string_view rest = std::string_view(address).substr(kTcpPrefix.size());
  const std::size_t colon = rest.rfind(':');
  std::pair<std::string, std::vector<std::string>> out;
  if (colon != std::string_view::npos) {
    out.first = rest.substr(0, colon);
    if (out.first.starts_with('[') && out.first.ends_with(']')) out.first = out.first.substr(1, out.first.size() - 2);
    for (rest.remove_prefix(colon + 1); !rest.empty();) {
      const std::size_t end = std::min(rest.size(), rest.find(','));
      out.second.emplace_back(rest.substr(0, end));
      rest.remove_prefix(std::min(rest.size(), end + 1));
    }
  }
  if (out.first.empty() || out.second.empty())
    throw InputError::format("{}: write tcp://HOST:PORT, or tcp://HOST:PORT,PORT for streams on several ports",
                             address);
  return out;
}

}  // namespace

Recording open_aedat4_tcp(const std::string& address, const Rig* rig, const RecordingOptions& options) {
  const auto [host, ports] = parse_address(address);
  std::vector<LiveStream> streams;
  std::size_t first = 0;
  for (const std::string& port : ports) {
    auto connection = std::make_unique<TcpConnection>(host, port);
    Aedat4Header header = wait_for_header(*connection);
    const std::size_t count = header.streams.size();
    streams.push_back({std::move(connection), std::move(header), first});
    first += count;
  }
  return {std::make_unique<Aedat4Live>(address, std::move(streams), rig, options), std::nullopt};
}

}  // namespace edged
