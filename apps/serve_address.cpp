// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "serve_address.hpp"

#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include <charconv>

namespace edged {

std::optional<ServeAddress> parse_serve_address(const std::string& text) {
  ServeAddress address;
  if (text == "true") return address;
  std::string port = text;
  if (const std::size_t colon = text.rfind(':'); colon != std::string::npos) {
    address.host = text.substr(0, colon);
    port = text.substr(colon + 1);
    if (address.host.starts_with('[') && address.host.ends_with(']'))
      address.host = address.host.substr(1, address.host.size() - 2);
  }
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  const bool whole = error == std::errc() && end == port.data() + port.size();
  if (!whole || address.host.empty() || address.port < 0 || address.port > 65535) return std::nullopt;
  return address;
}

void add_serve_option(CLI::App& command, std::string& text) {
  command
      .add_flag(
          "--serve", text,
          "Watch the run in a browser while it goes on; --serve=PORT or --serve=HOST:PORT, port 0: any that is free "
          "[127.0.0.1:8765]")
      ->check([](const std::string& given) {
        return parse_serve_address(given) ? ""
                                          : fmt::format("'{}' is no PORT or HOST:PORT, such as --serve=8765", given);
      });
}

}  // namespace edged
