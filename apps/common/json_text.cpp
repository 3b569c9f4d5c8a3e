// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/json_text.hpp"

#include <algorithm>

#include "edged/checks/found_imu_clock.hpp"

namespace edged {

nlohmann::ordered_json rounded(double value, int decimals) {
  if (!std::isfinite(value)) return nullptr;
  const double unit = std::pow(10.0, decimals);
  return std::round(value * unit) / unit;
}

nlohmann::ordered_json to_json(const ChosenImuClock& chosen) {
  const ImuOffset& found = *chosen.found;
  return {{"offset_s", to_seconds(chosen.clock.offset)},
          {"rate", chosen.clock.rate},
          {"offset_sigma_s", found.sigma_s},
          {"rate_sigma", number_or_null(found.rate_sigma)},
          {"correlation", found.match->correlation},
          {"next_correlation", found.match->next_correlation}};
}

std::string base64(const std::vector<unsigned char>& bytes) {
  constexpr const char* kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < n ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= n ? kLetters[group >> (18 - 6 * k) & 63u] : '=';
  }
  return text;
}

}  // namespace edged
