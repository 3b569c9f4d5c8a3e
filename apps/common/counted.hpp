// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A number with its noun, in the singular where it is one.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <concepts>
#include <string>
#include <string_view>

namespace edged {

/// "1 error", "2 errors": of nouns that take an s.
inline std::string counted(std::integral auto count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace edged
