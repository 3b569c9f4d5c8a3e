// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The exception for what a user can change.
#pragma once

#include <stdexcept>

namespace edged {

/// A checked format string; edged/core/check.hpp defines it, so that this header needs no library for text.
template <typename... Args>
struct FormatText;

/// Bad input, calibration, configuration or arguments. The message is one line that names the file, line or key
/// and the remedy. Caught once, in main.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;

  /// For the library itself.
  template <typename... Args>
  static InputError format(typename FormatText<Args...>::type text, Args&&... args);
};

}  // namespace edged
