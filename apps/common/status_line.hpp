// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The one living line on stderr while something runs, and the log lines that must not be torn by it.
#pragma once

#include <spdlog/sinks/base_sink.h>

#include <chrono>
#include <mutex>
#include <string>
#include <string_view>

#include "edged/dataset.hpp"

namespace edged {

/// On a terminal the line is rewritten in place, ten times a second at most; elsewhere it is a plain line every five
/// seconds. Leaves a clean line behind when it goes out of scope.
class StatusLine {
 public:
  explicit StatusLine(bool quiet);
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  /// True when it is time for another line: ask first, format then.
  bool due() const;
  void show(const std::string& text);
  /// Wipes the line, so that something else can be printed.
  void clear();

 private:
  bool quiet_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point last_;
};

/// Warnings and errors to stderr, above the living line.
class StderrSink : public spdlog::sinks::base_sink<std::mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override;
  void flush_() override;
};

/// "1234567" -> "1.23 M", for rates and counts.
std::string si_number(double value);

/// "12.3 / 60.0 s read", of a job that has come to t; without the whole where it is not known.
std::string progress_text(Timestamp t, const DatasetInfo& info, std::string_view what);

/// What a terminal has at least.
inline constexpr std::size_t kColumns = 80;

/// A line broken between words where it would be longer than that; what follows is indented. A word alone may be
/// longer.
std::string wrapped(const std::string& line, std::size_t indent);

/// One line, cut to a number of columns.
std::string fit_columns(const std::string& text, std::size_t columns);

}  // namespace edged
