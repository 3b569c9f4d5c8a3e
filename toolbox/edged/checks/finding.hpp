// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What a check reports.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace edged {

enum class Severity {
  Good,     ///< checked, without problem
  Note,     ///< worth knowing
  Warning,  ///< costs accuracy
  Error     ///< a run fails or is wrong
};

/// What nothing can be judged by until a finding is mended.
enum class Unusable {
  Nothing,
  Calibration,  ///< cameras cannot be compared with the IMU
  Truth
};

struct Finding {
  Severity severity = Severity::Good;
  std::string text;    ///< one line with numbers
  std::string remedy;  ///< may be empty
  Unusable unusable = Unusable::Nothing;
};

/// The findings of all checks, in order.
class Findings {
 public:
  void good(std::string text) { list.push_back({Severity::Good, std::move(text), ""}); }
  void note(std::string text, std::string remedy = "") { add(Severity::Note, std::move(text), std::move(remedy)); }
  void warn(std::string text, std::string remedy, Unusable what = Unusable::Nothing) {
    add(Severity::Warning, std::move(text), std::move(remedy), what);
  }
  void error(std::string text, std::string remedy, Unusable what = Unusable::Nothing) {
    add(Severity::Error, std::move(text), std::move(remedy), what);
  }

  std::vector<Finding> list;

 private:
  void add(Severity severity, std::string text, std::string remedy, Unusable what = Unusable::Nothing) {
    list.push_back({severity, std::move(text), std::move(remedy), what});
  }
};

}  // namespace edged
