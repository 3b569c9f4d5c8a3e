// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// One thing that a diagnosis has found.
#pragma once

#include <string>
#include <utility>
#include <vector>

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
  /// The IMU itself is wrong: until that is mended nothing can be said of a calibration.
  bool imu_unusable = false;
};

/// Those of one diagnosis, in their order.
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
