// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// POSIX sockets.
#include "edged/io/aedat/tcp_connection.hpp"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <utility>

#include "edged/core/check.hpp"

namespace edged {

TcpConnection::TcpConnection(const std::string& host, const std::string& port) : name_(host + ":" + port) {
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

TcpConnection::TcpConnection(TcpConnection&& other) noexcept
    : name_(std::move(other.name_)),
      socket_(std::exchange(other.socket_, -1)),
      open_(other.open_),
      received_(std::move(other.received_)) {}

TcpConnection::~TcpConnection() {
  if (socket_ >= 0) ::close(socket_);
}

void TcpConnection::receive() {
  constexpr std::size_t kStep = 1 << 16;
  const std::size_t before = received_.size();
  received_.resize(before + kStep);
  const ssize_t got = ::recv(socket_, received_.data() + before, kStep, MSG_DONTWAIT);
  received_.resize(before + (got > 0 ? static_cast<std::size_t>(got) : 0));
  // A server that crashes resets the connection, which counts as its end.
  if (got == 0 || (got < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) open_ = false;
}

void TcpConnection::drop(std::size_t count) {
  received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace edged
