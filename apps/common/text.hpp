// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Text for people: quantities, lines that fit a terminal, words of a command line.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <concepts>
#include <string>
#include <string_view>
#include <vector>

namespace edged {

/// "1 error", "2 errors": for nouns that take an s.
inline std::string quantity(std::integral auto count, std::string_view noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

/// "1234567" -> "1.23 M", for rates and counts.
std::string si_number(double value);

/// Minimum width of a terminal.
inline constexpr std::size_t kColumns = 80;

/// A text wrapped between words at kColumns, with later lines indented. A single word may be longer.
std::string wrapped(const std::string& line, std::size_t indent);

/// The parts of a text between separators; a separator at its end adds none.
std::vector<std::string> split(std::string_view text, std::string_view separator);

/// One line, cut to a number of columns.
std::string fit_columns(const std::string& text, std::size_t columns);

/// A text as one word of a command line, quoted if necessary.
std::string shell_word(const std::string& text);

}  // namespace edged
