// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Where log lines go: warnings to stderr at once, everything to run.log as soon as there is a folder for it.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace spdlog::sinks {
class sink;
}

namespace edged {

/// Call first in main. Keeps the newest lines until attach_log_file.
void start_logging();

/// From now on everything also goes to the file, the lines kept so far first.
void attach_log_file(const std::filesystem::path& file);

/// While it lives, warnings and errors are kept for a command that reports them itself. The rest is logged at the end.
class HeldWarnings {
 public:
  HeldWarnings();
  ~HeldWarnings();
  HeldWarnings(const HeldWarnings&) = delete;
  HeldWarnings& operator=(const HeldWarnings&) = delete;

  std::vector<std::string> take();

 private:
  class Sink;
  std::shared_ptr<Sink> sink_;
  std::vector<std::shared_ptr<spdlog::sinks::sink>> before_;
};

}  // namespace edged
