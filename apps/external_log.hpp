// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// external.csv of a run folder: the samples of height and velocity sensors that came, for the report.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "edged/core/external_sensor.hpp"

namespace edged {

/// The file comes into being with the first sample.
class ExternalLog {
 public:
  explicit ExternalLog(const std::filesystem::path& folder) : file_(folder / "external.csv") {}

  /// Of any measurement; those of other sensors are passed over.
  void add(const Measurement& measurement);
  void flush() { out_.flush(); }
  const std::map<std::string, std::size_t>& counts() const { return counts_; }

 private:
  std::filesystem::path file_;
  std::ofstream out_;
  std::map<std::string, std::size_t> counts_;
};

/// By sensor: `t` [s since origin] and `y`, its value, of several their norm. At most so many samples of each; empty
/// without the file.
nlohmann::ordered_json external_json(const std::filesystem::path& folder, Timestamp origin, std::size_t most);

}  // namespace edged
