// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/command.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/json_text.hpp"
#include "edged/config.hpp"

namespace edged {
namespace {

CLI::Validator number_above(bool zero_too, const char* wanted, const char* type) {
  return {[zero_too, wanted](const std::string& text) {
            double value = 0.0;
            const bool is_number = CLI::detail::lexical_cast(text, value);
            if (is_number && (value > 0.0 || (zero_too && value == 0.0))) return std::string();
            const bool comma = text.find(',') != std::string::npos;
            return fmt::format("'{}' is not a number {}{}", text, wanted,
                               comma ? "; use a decimal point, and blanks between several numbers" : "");
          },
          type};
}

}  // namespace

void print_result(bool as_json, const nlohmann::ordered_json& json, const std::string& text) {
  fmt::print("{}", as_json ? json_text(json) + "\n" : text);
}

std::string did_you_mean(const std::vector<std::string>& known, const std::string& word) {
  const std::size_t most_edits = std::max<std::size_t>(2, word.size() / 4);
  std::string nearest = nearest_name(known, word, most_edits);
  const auto begins_alike = [&](const std::string& name) {
    return std::min(name.size(), word.size()) > 2 && (word.starts_with(name) || name.starts_with(word));
  };
  if (const auto name = std::ranges::find_if(known, begins_alike); nearest.empty() && name != known.end())
    nearest = *name;
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

CLI::Validator positive_number() { return number_above(false, "above 0", "POSITIVE"); }
CLI::Validator non_negative_number() { return number_above(true, "from 0 on", "NONNEGATIVE"); }

}  // namespace edged
