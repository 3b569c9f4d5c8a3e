// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// --serve: the live view of a run in a browser.
#pragma once

#include <optional>
#include <string>

namespace edged {

/// --serve: the address of the live page of a run.
struct ServeAddress {
  std::string host = "127.0.0.1";
  int port = 8765;  ///< 0: any that is free
};

/// The address of "PORT" or "HOST:PORT" ("[::1]:PORT"); the default for "true", the value of a bare flag. Nothing for
/// any other text.
std::optional<ServeAddress> parse_serve_address(const std::string& text);

}  // namespace edged
