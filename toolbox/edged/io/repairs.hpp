// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What was wrong with a recording and passed over, counted; and the point beyond which it is refused.
#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace edged {

/// Counts by kind, e.g. "imu: duplicate stamp". The first of each kind is logged.
class Repairs {
 public:
  void add(const std::string& kind, const std::string& detail);
  const std::map<std::string, std::size_t>& counts() const { return counts_; }

 private:
  std::map<std::string, std::size_t> counts_;
};

/// The damaged lines of one file. Throws InputError, naming the first, when there are more than 1000 and more than 1 %
/// of the lines read so far.
class LineDamage {
 public:
  /// subject: begins each kind, e.g. "events".
  LineDamage(std::string file, std::string subject, Repairs& repairs)
      : file_(std::move(file)), subject_(std::move(subject)), repairs_(repairs) {}

  /// A line that is left out because it is wrong.
  void bad(std::size_t line, const std::string& kind, const std::string& detail);

  /// A line that is mended or harmless: counted only.
  void mended(std::size_t line, const std::string& kind, const std::string& detail);

 private:
  std::string file_, subject_;
  Repairs& repairs_;
  std::size_t bad_ = 0;
  std::string first_;
};

}  // namespace edged
