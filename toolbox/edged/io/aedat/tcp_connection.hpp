// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// One TCP connection that only receives. Internal to io.
#pragma once

#include <string>

#include "edged/io/bytes.hpp"

namespace edged {

class TcpConnection {
 public:
  /// Throws InputError when nobody listens there.
  TcpConnection(const std::string& host, const std::string& port);
  ~TcpConnection();
  TcpConnection(TcpConnection&& other) noexcept;
  TcpConnection& operator=(TcpConnection&&) = delete;

  const std::string& name() const { return name_; }  ///< "HOST:PORT", for messages
  int descriptor() const { return socket_; }         ///< to poll

  /// Appends what has come, some 64 kB at most, to received(). The end of the connection closes it.
  void receive();
  const Bytes& received() const { return received_; }
  /// Forgets the first bytes of received().
  void drop(std::size_t count);
  bool open() const { return open_; }

 private:
  std::string name_;
  int socket_ = -1;
  bool open_ = true;
  Bytes received_;
};

}  // namespace edged
