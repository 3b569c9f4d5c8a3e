// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Validators of numbers on the command line, with readable errors.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <string>

namespace edged {

/// Used instead of the bounds of CLI11, whose messages contain the largest double.
inline CLI::Validator at_least_zero(bool zero_too, const char* wanted, const char* type) {
  return {[zero_too, wanted](std::string& text) {
            double value = 0.0;
            const bool is_number = CLI::detail::lexical_cast(text, value);
            if (is_number && (value > 0.0 || (zero_too && value == 0.0))) return std::string();
            const bool comma = text.find(',') != std::string::npos;
            return fmt::format("'{}' is no number {}{}", text, wanted,
                               comma ? "; decimals have a point, and blanks stand between several numbers" : "");
          },
          type};
}

inline CLI::Validator positive_number() { return at_least_zero(false, "above 0", "POSITIVE"); }
inline CLI::Validator non_negative_number() { return at_least_zero(true, "from 0 on", "NONNEGATIVE"); }

}  // namespace edged
