// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A connection sends the header of a file without the version line, then packets as in a file.
#include "edged/io/aedat/aedat4_tcp.hpp"

#include <poll.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>

#include "edged/core/check.hpp"
#include "edged/io/aedat/aedat4_dataset.hpp"
#include "edged/io/aedat/flat_table.hpp"
#include "edged/io/aedat/tcp_connection.hpp"
#include "edged/io/core/geometry.hpp"

namespace edged {
namespace {

constexpr std::size_t kLiveHeadBytes = 8;  // of a packet
constexpr std::size_t kMostHeaderBytes = std::size_t{1} << 20U;
constexpr std::size_t kMostLiveBytes = std::size_t{1} << 26U;  // in a packet: a frame of 20 megapixels in colour
constexpr int kPollMs = 100;

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
  if (received.size() < 4 + kLiveHeadBytes || kAedat4Magic.starts_with(as_text(received))) return std::nullopt;
  const auto bytes = number_at<std::uint32_t>(received, 0);
  if (bytes < kLiveHeadBytes || bytes > kMostHeaderBytes) throw Damage("its length is invalid");
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
  TcpConnection connection;
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
        open = open || stream.connection.open();
      }
      if (any) return true;
      if (!open) break;
      std::vector<TcpConnection*> connections;
      for (LiveStream& stream : streams_) connections.push_back(&stream.connection);
      receive_some(connections);
    }
    for (const LiveStream& stream : streams_)
      if (!stream.connection.received().empty())
        repairs_.add("stream: cut within a packet",
                     fmt::format("tcp://{}: ended within a packet", stream.connection.name()));
    return false;
  }

  /// False if no packet was complete.
  bool take_whole_packets(LiveStream& stream) {
    const ByteSpan received = stream.connection.received();
    std::size_t at = 0;
    while (received.size() - at >= kLiveHeadBytes) {
      const auto number = number_at<std::int32_t>(received, at), bytes = number_at<std::int32_t>(received, at + 4);
      const std::vector<Aedat4Stream>& known = stream.header.streams;
      const auto found = std::ranges::find(known, number, &Aedat4Stream::number);
      if (found == known.end() || bytes <= 0 || static_cast<std::size_t>(bytes) > kMostLiveBytes)
        throw InputError::format(
            "tcp://{}: a packet of stream {} with {} bytes is invalid: the stream is damaged; start again",
            stream.connection.name(), number, bytes);
      const std::size_t body = at + kLiveHeadBytes, size = static_cast<std::size_t>(bytes);
      if (received.size() - body < size) break;
      const std::size_t place = stream.first + static_cast<std::size_t>(found - known.begin());
      if (reads(place))
        take_packet(place, stream.header.compression, received.subspan(body, size),
                    fmt::format("{} bytes into tcp://{}", stream.taken + at, stream.connection.name()));
      at = body + size;
    }
    stream.taken += at;
    stream.connection.drop(at);
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
    TcpConnection connection(host, port);
    Aedat4Header header = wait_for_header(connection);
    const std::size_t count = header.streams.size();
    streams.push_back({std::move(connection), std::move(header), first});
    first += count;
  }
  return {std::make_unique<Aedat4Live>(address, std::move(streams), rig, options), std::nullopt};
}

}  // namespace edged
