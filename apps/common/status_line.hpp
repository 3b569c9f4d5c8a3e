// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The status line on stderr during a run, and log lines above it.
#pragma once

#include <spdlog/sinks/base_sink.h>

#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

#include "edged/dataset.hpp"

namespace edged {

/// On a terminal, the line is rewritten in place, at most ten times per second. Otherwise, a line is printed every five
/// seconds. The destructor clears the line.
class StatusLine {
 public:
  explicit StatusLine(bool quiet);
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  /// True if another line is due. To be checked before formatting.
  bool due() const;
  void show(const std::string& text);
  /// Clears the line, so that something else can be printed.
  void clear();

 private:
  bool quiet_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point last_;
};

/// Warnings and errors to stderr, above the status line.
class StderrSink : public spdlog::sinks::base_sink<std::mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override;
  void flush_() override;
};

/// "1234567" -> "1.23 M", for rates and counts.
std::string si_number(double value);

/// Progress at time t: "12.3 / 60.0 s read", without the total if it is unknown.
std::string progress_text(Timestamp t, const DatasetInfo& info, std::string_view what);

/// Minimum width of a terminal.
inline constexpr std::size_t kColumns = 80;

/// A text wrapped between words at kColumns, with later lines indented. A single word may be longer.
std::string wrapped(const std::string& line, std::size_t indent);

/// One line, cut to a number of columns.
std::string fit_columns(const std::string& text, std::size_t columns);

}  // namespace edged
