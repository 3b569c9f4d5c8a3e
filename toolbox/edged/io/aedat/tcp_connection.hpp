// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A TCP connection that only receives. Internal to io.
#pragma once

#include <string>

#include "edged/io/archive/bytes.hpp"

namespace edged {

class TcpConnection {
 public:
  /// Throws InputError if no server accepts the connection.
  TcpConnection(const std::string& host, const std::string& port);
  ~TcpConnection();
  TcpConnection(TcpConnection&& other) noexcept;
  TcpConnection& operator=(TcpConnection&&) = delete;

  const std::string& name() const { return name_; }  ///< "HOST:PORT", for messages
  int descriptor() const { return socket_; }         ///< for poll()

  /// Appends the bytes that have arrived, about 64 kB at most, to received(). Closes this end after the server has
  /// closed the connection.
  void receive();
  const Bytes& received() const { return received_; }
  /// Removes the first bytes of received().
  void drop(std::size_t count);
  bool open() const { return open_; }

 private:
  std::string name_;
  int socket_ = -1;
  bool open_ = true;
  Bytes received_;
};

}  // namespace edged
