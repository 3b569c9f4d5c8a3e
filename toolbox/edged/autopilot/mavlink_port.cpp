// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/autopilot/mavlink_port.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "edged/core/check.hpp"

namespace edged {
namespace {

struct Baud {
  const char* text;
  speed_t speed;
};
constexpr std::array<Baud, 9> kBauds = {{{"57600", B57600},
                                         {"115200", B115200},
                                         {"230400", B230400},
                                         {"460800", B460800},
                                         {"500000", B500000},
                                         {"921600", B921600},
                                         {"1000000", B1000000},
                                         {"1500000", B1500000},
                                         {"3000000", B3000000}}};

constexpr std::size_t kLargestRead = 2048;
constexpr int kMostWaiting = 600;  // bytes: two messages of odometry

InputError no_url(const std::string& url) {
  return InputError::format(
      "MAVLink: '{}' is not udp:HOST:PORT, udpin:HOST:PORT or serial:DEVICE:BAUD, such as udp:127.0.0.1:14550", url);
}

bool would_block(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR || error == ENOBUFS; }

}  // namespace

MavlinkPort::MavlinkPort(const std::string& url) : url_(url) {
  const std::size_t colon = url.find(':'), last = url.rfind(':');
  if (last == std::string::npos || last <= colon) throw no_url(url);
  const std::string scheme = url.substr(0, colon), after = url.substr(last + 1);
  std::string place = url.substr(colon + 1, last - colon - 1);
  if (place.starts_with("//")) place.erase(0, 2);  // udp://HOST:PORT, as other programs write it
  if (place.size() > 2 && place.starts_with('[') && place.ends_with(']')) place = place.substr(1, place.size() - 2);
  serial_ = scheme == "serial";
  listens_ = scheme == "udpin";
  if ((!serial_ && !listens_ && scheme != "udp") || place.empty() || after.empty()) throw no_url(url);
  try {
    serial_ ? open_serial(place, after) : open_udp(place, after, listens_);
  } catch (...) {
    if (handle_ >= 0) ::close(handle_);
    throw;
  }
}

MavlinkPort::~MavlinkPort() { ::close(handle_); }

void MavlinkPort::open_udp(const std::string& host, const std::string& port, bool listen) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_DGRAM;
  wanted.ai_flags = AI_NUMERICSERV;
  addrinfo* list = nullptr;
  if (const int error = getaddrinfo(host.c_str(), port.c_str(), &wanted, &list); error != 0)
    throw InputError::format("{}: {}: give the address and the port of the autopilot", url_, gai_strerror(error));
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner(list, &freeaddrinfo);
  const addrinfo* chosen = list;  // of a name like localhost the address that autopilots and their simulators use
  for (const addrinfo* each = list; each; each = each->ai_next)
    if (each->ai_family == AF_INET && chosen->ai_family != AF_INET) chosen = each;
  handle_ = ::socket(chosen->ai_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const auto join = listen ? ::bind : ::connect;
  if (handle_ < 0 || join(handle_, chosen->ai_addr, chosen->ai_addrlen) != 0)
    throw InputError::format(
        "{}: {}: {}", url_, std::strerror(errno),
        listen ? "does another program listen on this port?" : "is there a route to this address?");
}

void MavlinkPort::open_serial(const std::string& device, const std::string& baud) {
  const auto speed = std::ranges::find(kBauds, baud, &Baud::text);
  if (speed == kBauds.end()) {
    std::string known;
    for (const Baud& each : kBauds) known += std::string(known.empty() ? "" : ", ") + each.text;
    throw InputError::format("{}: '{}' is not a speed that a serial line can have: give one of {}", url_, baud, known);
  }
  handle_ = ::open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (handle_ < 0)
    throw InputError::format("{}: {}: is the autopilot plugged in, and are you in the group of the device (dialout)?",
                             url_, std::strerror(errno));
  termios settings{};
  if (tcgetattr(handle_, &settings) != 0)
    throw InputError::format("{}: is not a serial device: give one such as /dev/ttyACM0", url_);
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
  if (cfsetspeed(&settings, speed->speed) != 0 || tcsetattr(handle_, TCSANOW, &settings) != 0)
    throw InputError::format("{}: {}: try another speed", url_, std::strerror(errno));
}

bool MavlinkPort::fail(std::string reason) {
  failure_ = std::move(reason);
  return false;
}

/// That the device has taken but not sent: later poses would be old when they arrive.
int MavlinkPort::waiting_bytes() const {
  int waiting = 0;
  return ioctl(handle_, TIOCOUTQ, &waiting) == 0 ? waiting : 0;
}

/// Whether the device has taken the rest of the frame before.
bool MavlinkPort::send_rest() {
  if (rest_.empty()) return true;
  const ssize_t sent = ::write(handle_, rest_.data(), rest_.size());
  if (sent > 0) rest_.erase(rest_.begin(), rest_.begin() + sent);
  return rest_.empty();
}

bool MavlinkPort::send(std::span<const std::uint8_t> frame) {
  if (listens_ && peer_size_ == 0) return fail("no autopilot has sent anything to this port");
  if (serial_ && (!send_rest() || waiting_bytes() > kMostWaiting))
    return fail("the serial line is too slow, or the autopilot does not read: lower autopilot.rate_hz");
  const auto* peer = listens_ ? reinterpret_cast<const sockaddr*>(&peer_) : nullptr;
  const ssize_t sent = serial_ ? ::write(handle_, frame.data(), frame.size())
                               : ::sendto(handle_, frame.data(), frame.size(), MSG_NOSIGNAL, peer, peer_size_);
  if (sent < 0 && would_block(errno)) return fail("the line is too slow: lower autopilot.rate_hz");
  if (sent < 0) return fail(std::strerror(errno));
  if (serial_) rest_.assign(frame.begin() + sent, frame.end());
  return true;
}

bool MavlinkPort::wait(std::chrono::milliseconds longest) const {
  pollfd one{handle_, POLLIN, 0};
  return ::poll(&one, 1, static_cast<int>(longest.count())) > 0;
}

std::vector<std::uint8_t> MavlinkPort::receive() {
  std::vector<std::uint8_t> bytes(kLargestRead);
  sockaddr_storage from{};
  socklen_t from_size = sizeof from;
  const ssize_t got =
      serial_ ? ::read(handle_, bytes.data(), bytes.size())
              : ::recvfrom(handle_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &from_size);
  bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  if (listens_ && got > 0) {
    peer_ = from;
    peer_size_ = from_size;
  }
  return bytes;
}

}  // namespace edged
