// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Live view of a run in a browser: the report's page, filled by a server in threads of its own.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "live/live_feed.hpp"

namespace edged {

/// --serve: the address of the live page of a run.
struct ServeAddress {
  std::string host = "127.0.0.1";
  int port = 8765;  ///< 0: any that is free
};

/// The address of "PORT" or "HOST:PORT" ("[::1]:PORT"); the default for "true", the value of a bare flag. Nothing for
/// any other text.
std::optional<ServeAddress> parse_serve_address(const std::string& text);

/// Calls by the thread of the run do not block, whatever browsers do, except `finish`.
class LivePage {
 public:
  /// Starts to serve url(). about: the title of the run; dense: lives longer. Throws InputError if the address is not
  /// available.
  LivePage(const ServeAddress& address, const nlohmann::ordered_json& about, OutputFrame frame,
           const LivePoints& dense);
  ~LivePage();
  LivePage(const LivePage&) = delete;
  LivePage& operator=(const LivePage&) = delete;

  /// For a browser on this machine.
  const std::string& url() const;

  void add(const Step& step, RunProgress progress, const Snapshots& snapshots);

  /// Notifies the viewers that the run is over. They get report.html of the folder in place of the live page; returns
  /// when all have it, after at most 10 s, or 2 s after the last request.
  void finish(RunProgress progress, const nlohmann::ordered_json& metrics, const std::filesystem::path& folder);

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace edged
