// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A run to be watched in a browser while it goes on: the report's page, filled by a server in threads of its own.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "common/cli_fwd.hpp"
#include "live/live_feed.hpp"

namespace edged {

/// --serve: where the live page of a run is to be had.
struct ServeAddress {
  std::string host = "127.0.0.1";
  int port = 8765;  ///< 0: any that is free
};

/// Of "PORT" or "HOST:PORT" ("[::1]:PORT"); of "true", which a flag without a value is, the usual one. Nothing where it
/// is none of them.
std::optional<ServeAddress> parse_serve_address(const std::string& text);

/// Adds --serve; text becomes what parse_serve_address takes, and stays empty where the flag is not given.
void add_serve_option(CLI::App& command, std::string& text);

/// What the thread of the run calls returns at once, whatever browsers do, but for `finish`.
class LivePage {
 public:
  /// From now on there is something at url(). about: the run, as the page names it. Throws InputError where the address
  /// cannot be had.
  LivePage(const ServeAddress& address, const nlohmann::ordered_json& about, OutputFrame frame);
  ~LivePage();
  LivePage(const LivePage&) = delete;
  LivePage& operator=(const LivePage&) = delete;

  /// As a browser on this machine takes it.
  const std::string& url() const;

  void add(const Step& step, RunProgress progress, const RunAlbum& album);

  /// Tells the viewers that the run is over. They get report.html of the folder in place of the live page; returns when
  /// all have it, at the latest 10 s later, and 2 s after the last has asked for anything.
  void finish(RunProgress progress, const nlohmann::ordered_json& metrics, const std::filesystem::path& folder);

 private:
  class Server;
  std::unique_ptr<Server> server_;
};

}  // namespace edged
