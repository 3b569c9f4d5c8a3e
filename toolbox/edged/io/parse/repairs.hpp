// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Counts errors of a recording that are repaired or skipped, and the limit beyond which the recording is refused.
#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace edged {

/// Counts by kind, e.g. "imu: duplicate stamp". The first of each kind is logged.
class Repairs {
 public:
  void add(const std::string& kind, const std::string& detail, std::size_t count = 1);
  const std::map<std::string, std::size_t>& counts() const { return counts_; }

 private:
  std::map<std::string, std::size_t> counts_;
};

/// The damaged lines of one file. Throws InputError, naming the first, when there are more than 1000 and more than 1 %
/// of the lines read so far.
class LineDamage {
 public:
  /// subject: the prefix of each kind, such as "events".
  LineDamage(std::string file, std::string subject, Repairs& repairs)
      : file_(std::move(file)), subject_(std::move(subject)), repairs_(repairs) {}

  /// A wrong line, which is left out.
  void bad(std::size_t line, const std::string& kind, const std::string& detail);

  /// A repaired or harmless line, which is only counted.
  void mended(std::size_t line, const std::string& kind, const std::string& detail);

 private:
  std::string file_, subject_;
  Repairs& repairs_;
  std::size_t bad_ = 0;
  std::string first_;
};

}  // namespace edged
