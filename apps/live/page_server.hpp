// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The HTTP server of the live page, which no client can hold up for long, nor a page of another site read.
#pragma once

#include <Eigen/Core>  // before httplib, whose system headers define _res

#include <httplib.h>

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace edged {

inline constexpr std::size_t kMostViewers = 12;  ///< each occupies a thread of the server while it is connected

/// --serve: the address of the live page of a run.
struct ServeAddress {
  std::string host = "127.0.0.1";
  int port = 8765;  ///< 0: any that is free
};

/// The address of "PORT" or "HOST:PORT" ("[::1]:PORT"); the default for "true", the value of a bare flag. Nothing for
/// any other text.
std::optional<ServeAddress> parse_serve_address(const std::string& text);

void refuse(httplib::Response& response, int status, const char* text);

class PageServer : public httplib::Server {
 public:
  /// host: the address or name it is served at. Throws InputError if its threads cannot be started.
  explicit PageServer(std::string host);

  /// Answers requests that change or send something, and those for another host; false for others. A name that its
  /// owner points at this machine (DNS rebinding) would give the page to a page of his; an address does not.
  bool refuses(const httplib::Request& request, httplib::Response& response) const;
  /// Connections end from now on within a second, whatever their clients do.
  void close() { closing_ = true; }

 private:
  bool process_and_close_socket(socket_t socket) override;

  std::string host_;
  std::atomic<bool> closing_ = false;
  std::unique_ptr<httplib::TaskQueue> threads_;  ///< until it listens
};

}  // namespace edged
