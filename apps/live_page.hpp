// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A run to be watched in a browser while it goes on: the report's page, filled by a server in threads of its own.
#pragma once

#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "live_feed.hpp"
#include "serve_address.hpp"

namespace edged {

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
