// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Json as text: what --json prints, what files hold.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace edged {

/// Indented. Bytes of names that are no UTF-8 are replaced: recordings bring any.
inline std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// The same in one line.
inline std::string compact_json(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace edged
