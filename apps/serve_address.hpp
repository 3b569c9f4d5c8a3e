// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// --serve: where the live page of a run is to be had.
#pragma once

#include <optional>
#include <string>

#include "cli_fwd.hpp"

namespace edged {

struct ServeAddress {
  std::string host = "127.0.0.1";
  int port = 8765;  ///< 0: any that is free
};

/// Of "PORT" or "HOST:PORT" ("[::1]:PORT"); of "true", which a flag without a value is, the usual one. Nothing where it
/// is none of them.
std::optional<ServeAddress> parse_serve_address(const std::string& text);

/// Adds --serve; text becomes what parse_serve_address takes, and stays empty where the flag is not given.
void add_serve_option(CLI::App& command, std::string& text);

}  // namespace edged
