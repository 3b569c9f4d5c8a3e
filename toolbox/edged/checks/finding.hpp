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

struct Finding {
  Severity severity = Severity::Good;
  std::string text;    ///< one line with numbers
  std::string remedy;  ///< may be empty
  /// An error of the IMU itself. Until it is corrected, no calibration can be checked.
  bool imu_unusable = false;
};

/// The findings of all checks, in order.
class Findings {
 public:
  void good(std::string text) { list.push_back({Severity::Good, std::move(text), ""}); }
  void note(std::string text, std::string remedy = "") { add(Severity::Note, std::move(text), std::move(remedy)); }
  void warn(std::string text, std::string remedy) { add(Severity::Warning, std::move(text), std::move(remedy)); }
  void error(std::string text, std::string remedy) { add(Severity::Error, std::move(text), std::move(remedy)); }
  void imu_unusable(std::string text, std::string remedy) {
    list.push_back({Severity::Error, std::move(text), std::move(remedy), true});
  }

  std::vector<Finding> list;

 private:
  void add(Severity severity, std::string text, std::string remedy) {
    list.push_back({severity, std::move(text), std::move(remedy)});
  }
};

}  // namespace edged
