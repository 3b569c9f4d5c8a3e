// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The line to an autopilot: UDP or a serial device. Never blocks.
#pragma once

#include <sys/socket.h>

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace edged {

/// One URL:
///   udp:HOST:PORT       sends to that address, and receives the answers
///   udpin:HOST:PORT     listens on an address of this machine, and sends to whoever sent last
///   serial:DEVICE:BAUD
class MavlinkPort {
 public:
  /// Throws InputError where the text is no such URL, or the address or device cannot be opened.
  explicit MavlinkPort(const std::string& url);
  ~MavlinkPort();
  MavlinkPort(const MavlinkPort&) = delete;
  MavlinkPort& operator=(const MavlinkPort&) = delete;

  /// Whether the whole frame has been taken. If not, failure() says why; nothing of it is sent.
  bool send(std::span<const std::uint8_t> frame);
  const std::string& failure() const { return failure_; }

  /// Waits until something has arrived, at most so long. From another thread than send, for as long as it wants.
  bool wait(std::chrono::milliseconds longest) const;
  /// What has arrived; nothing if there is nothing.
  std::vector<std::uint8_t> receive();

 private:
  void open_udp(const std::string& host, const std::string& port, bool listen);
  void open_serial(const std::string& device, const std::string& baud);
  bool fail(std::string reason);
  int waiting_bytes() const;
  bool send_rest();

  std::string url_;
  int handle_ = -1;
  bool serial_ = false, listens_ = false;
  sockaddr_storage peer_{};
  socklen_t peer_size_ = 0;         ///< 0: nobody has sent
  std::vector<std::uint8_t> rest_;  ///< bytes of a frame of which the device has taken a part
  std::string failure_;
};

}  // namespace edged
