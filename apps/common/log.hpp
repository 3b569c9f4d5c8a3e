// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Logging: warnings go to stderr, and all lines to run.log as soon as its folder exists.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace spdlog::sinks {
class sink;
}

namespace edged {

/// To be called first in main. Keeps the newest lines until attach_log_file().
void start_logging();

/// For a command that runs for long and has no file: informative lines go to stderr, too.
void show_progress_in_log();

/// Writes the kept lines to the file, then all later lines, too.
void attach_log_file(const std::filesystem::path& file);

/// Keeps warnings and errors during its lifetime, for a command that reports them itself. Those that were not taken are
/// logged by the destructor.
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
