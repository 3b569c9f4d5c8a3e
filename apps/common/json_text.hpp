// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Json for --json and for files.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace edged {

struct ChosenImuClock;

/// Indented text. Bytes that are not UTF-8 are replaced, as names in recordings may contain any bytes.
inline std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// Text in one line, with bytes replaced as by json_text.
inline std::string compact_json(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// Null for a number that is not finite, as json has none.
inline nlohmann::ordered_json number_or_null(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

/// A value, or null without one.
template <typename T>
nlohmann::ordered_json value_or_null(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

/// A number rounded to so many decimals, to save space as text; null if it is not finite.
nlohmann::ordered_json rounded(double value, int decimals);

/// Of one that was found.
nlohmann::ordered_json to_json(const ChosenImuClock& chosen);

/// Bytes as text of 64 letters (RFC 4648).
std::string base64(const std::vector<unsigned char>& bytes);

}  // namespace edged
