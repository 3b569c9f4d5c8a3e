// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A finding of a diagnosis.
#pragma once

#include <string>

namespace edged {

enum class Severity {
  Good,     ///< checked, without problem
  Note,     ///< worth knowing
  Warning,  ///< costs accuracy
  Error     ///< a run fails or is wrong
};

struct Finding {
  Severity severity = Severity::Good;
  std::string text;    ///< one line with numbers
  std::string remedy;  ///< remedy; may be empty
};

}  // namespace edged
