// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The two kinds of exception: InputError for what a user can correct, CheckError (EDGED_CHECK) for a bug of ours.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "edged/input_error.hpp"

namespace edged {

template <typename... Args>
struct FormatText {
  using type = fmt::format_string<Args...>;
};

template <typename... Args>
InputError InputError::format(typename FormatText<Args...>::type text, Args&&... args) {
  return InputError(fmt::format(text, std::forward<Args>(args)...));
}

/// A broken precondition: a bug, with the values that show it.
class CheckError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// The message of a library, shortened for the one line of an InputError.
inline std::string first_line(const std::string& text) {
  return text.substr(0, std::min<std::size_t>(text.find('\n'), 160));
}

[[noreturn]] void fail_check(const char* condition, const char* file, int line, const std::string& message);

}  // namespace edged

/// EDGED_CHECK(n > 0, "n is {}", n) throws CheckError when the condition does not hold, in every build type.
#define EDGED_CHECK(condition, ...)                                                       \
  do {                                                                                    \
    if (!(condition)) {                                                                   \
      ::edged::fail_check(#condition, __FILE__, __LINE__, ::fmt::format("" __VA_ARGS__)); \
    }                                                                                     \
  } while (false)
