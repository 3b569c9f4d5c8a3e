// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The status line on stderr during a run, and log lines above it.
#pragma once

#include <spdlog/sinks/base_sink.h>

#include <chrono>
#include <mutex>
#include <optional>
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
  /// share: of the work that is done, 0 to 1, if it is known: the line begins with it and the time left.
  void show(const std::string& text, std::optional<double> share = std::nullopt);
  /// Clears the line, so that something else can be printed.
  void clear();

 private:
  bool quiet_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point last_;
};

/// Warnings and errors to stderr, above the status line.
class StderrSink : public spdlog::sinks::base_sink<std::mutex> {
 protected:
  void sink_it_(const spdlog::details::log_msg& message) override;
  void flush_() override;
};

/// Progress at time t: "12.3 / 60.0 s read", without the total if it is unknown.
std::string progress_text(Timestamp t, const DatasetInfo& info, std::string_view what);

/// The share of a recording that lies before t, 0 to 1, if its end is known.
std::optional<double> share_done(Timestamp t, const DatasetInfo& info);

/// Shows the progress at time t, with the share done, if another line is due.
void show_progress(StatusLine& status, Timestamp t, const DatasetInfo& info, std::string_view what);

/// "42 %, 1:05 left  ": the time that is left at the speed so far, if it can be told. "" without a share.
std::string share_text(std::optional<double> share, double elapsed_s);

}  // namespace edged
