// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// One thing that a diagnosis has found.
#pragma once

#include <string>

namespace edged {

enum class Severity {
  Good,     ///< looked at and found in order
  Note,     ///< worth knowing
  Warning,  ///< costs accuracy
  Error     ///< a run fails or is wrong
};

struct Finding {
  Severity severity = Severity::Good;
  std::string text;    ///< one line with numbers
  std::string remedy;  ///< what to do; empty where nothing is
};

}  // namespace edged
