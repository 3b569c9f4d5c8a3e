// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"

#include <algorithm>

namespace edged {

std::string si_number(double value) {
  if (value >= 1e9) return fmt::format("{:.2f} G", value * 1e-9);
  if (value >= 1e6) return fmt::format("{:.2f} M", value * 1e-6);
  if (value >= 1e3) return fmt::format("{:.1f} k", value * 1e-3);
  return fmt::format("{:.0f} ", value);
}

std::string wrapped(const std::string& line, std::size_t indent) {
  std::string text, rest = line;
  while (rest.size() > kColumns) {
    std::size_t at = rest.rfind(' ', kColumns);
    if (at == std::string::npos || at <= indent) at = rest.find(' ', std::max(kColumns, indent));
    if (at == std::string::npos) break;
    const std::size_t end = rest.find_last_not_of(' ', at);
    text += rest.substr(0, end + 1) + '\n';
    rest = std::string(indent, ' ') + rest.substr(at + 1);
  }
  return text + rest;
}

std::vector<std::string> split(std::string_view text, std::string_view separator) {
  std::vector<std::string> parts;
  for (std::size_t end; (end = text.find(separator)) != std::string_view::npos;) {
    parts.emplace_back(text.substr(0, end));
    text.remove_prefix(end + separator.size());
  }
  if (!text.empty() || parts.empty()) parts.emplace_back(text);
  return parts;
}

std::string fit_columns(const std::string& text, std::size_t columns) {
  return text.substr(0, std::min(text.find('\n'), columns));
}

std::string shell_word(const std::string& text) {
  const bool plain =
      text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./:=,+-~") ==
      std::string::npos;
  if (plain && !text.empty()) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace edged
