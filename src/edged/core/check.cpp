// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/core/check.hpp"

namespace edged {

void fail_check(const char* condition, const char* file, int line, const std::string& message) {
  throw CheckError(fmt::format("{}:{}: check '{}' failed. {}", file, line, condition, message));
}

}  // namespace edged
