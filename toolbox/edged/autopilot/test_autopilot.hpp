// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The other end of the line in tests: a UDP socket of this machine, or the master of a pseudo terminal.
#pragma once

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

namespace edged {

/// Receives waits at most 5 s.
class TestEnd {
 public:
  TestEnd(const TestEnd&) = delete;
  TestEnd& operator=(const TestEnd&) = delete;
  ~TestEnd() { close(); }

  void close() {
    if (handle_ >= 0) ::close(handle_);
    handle_ = -1;
  }
  std::vector<std::uint8_t> receive() const {
    pollfd one{handle_, POLLIN, 0};
    std::vector<std::uint8_t> bytes(4096);
    const ssize_t got = ::poll(&one, 1, 5000) > 0 ? ::read(handle_, bytes.data(), bytes.size()) : 0;
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }

 protected:
  TestEnd() = default;
  int handle_ = -1;
};

class TestUdp : public TestEnd {
 public:
  TestUdp() {
    handle_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_in address = local(0);
    if (::bind(handle_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) std::abort();
    socklen_t size = sizeof address;
    getsockname(handle_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
  }
  std::string port() const { return std::to_string(port_); }
  std::string url() const { return "udp:127.0.0.1:" + port(); }
  void send(std::span<const std::uint8_t> bytes, int port) const {
    const sockaddr_in address = local(port);
    ::sendto(handle_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  }
  /// To the sender of the next datagram, which is received.
  void answer(std::span<const std::uint8_t> bytes) const {
    sockaddr_storage from{};
    socklen_t size = sizeof from;
    std::vector<std::uint8_t> ignored(4096);
    ::recvfrom(handle_, ignored.data(), ignored.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    ::sendto(handle_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&from), size);
  }

 private:
  static sockaddr_in local(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    return address;
  }
  int port_ = 0;
};

class TestSerial : public TestEnd {
 public:
  TestSerial() {
    handle_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (handle_ < 0 || ::grantpt(handle_) != 0 || ::unlockpt(handle_) != 0) std::abort();
  }
  std::string url(const std::string& baud = "921600") const {
    return "serial:" + std::string(::ptsname(handle_)) + ":" + baud;
  }
  void send(std::span<const std::uint8_t> bytes) const {
    if (::write(handle_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) std::abort();
  }
};

}  // namespace edged
