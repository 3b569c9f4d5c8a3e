// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/status_line.hpp"

#include <spdlog/fmt/fmt.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "common/text.hpp"

namespace edged {
namespace {

constexpr auto kTerminalPeriod = std::chrono::milliseconds(100);
constexpr auto kPlainPeriod = std::chrono::seconds(5);
constexpr const char* kWipe = "\r\x1b[K";

std::size_t terminal_columns() {
  winsize size = {};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

StatusLine::StatusLine(bool quiet)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1), begin_(std::chrono::steady_clock::now()), last_(begin_) {}

StatusLine::~StatusLine() { clear(); }

bool StatusLine::due() const {
  if (quiet_) return false;
  const auto since = std::chrono::steady_clock::now() - last_;
  return terminal_ ? since >= kTerminalPeriod : since >= kPlainPeriod;
}

void StatusLine::show(const std::string& what, std::optional<double> share) {
  if (quiet_) return;
  last_ = std::chrono::steady_clock::now();
  const std::string text = share_text(share, std::chrono::duration<double>(last_ - begin_).count()) + what;
  if (terminal_) {
    std::fputs((kWipe + fit_columns(text, terminal_columns() - 1)).c_str(), stderr);
  } else {
    std::fputs((text + "\n").c_str(), stderr);
  }
  std::fflush(stderr);
  shown_ = true;
}

void StatusLine::clear() {
  if (shown_ && terminal_) {
    std::fputs(kWipe, stderr);
    std::fflush(stderr);
  }
  shown_ = false;
}

void StderrSink::sink_it_(const spdlog::details::log_msg& message) {
  const std::string_view text(message.payload.data(), message.payload.size());
  const char* wipe = isatty(STDERR_FILENO) == 1 ? kWipe : "";
  const auto level = spdlog::level::to_string_view(message.level);
  fmt::print(stderr, "{}edged: {}: {}\n", wipe, std::string_view(level.data(), level.size()), text);
}

void StderrSink::flush_() { std::fflush(stderr); }

std::string progress_text(Timestamp t, const DatasetInfo& info, std::string_view what) {
  const Timestamp begin = info.begin.value_or(Timestamp());
  const std::string whole = info.end ? fmt::format(" / {:.1f}", to_seconds(*info.end - begin)) : "";
  return fmt::format("{:.1f}{} s {}", to_seconds(t - begin), whole, what);
}

std::optional<double> share_done(Timestamp t, const DatasetInfo& info) {
  if (!info.begin || !info.end || *info.end <= *info.begin) return std::nullopt;
  return std::clamp(to_seconds(t - *info.begin) / to_seconds(*info.end - *info.begin), 0.0, 1.0);
}

void show_progress(StatusLine& status, Timestamp t, const DatasetInfo& info, std::string_view what) {
  if (status.due()) status.show(progress_text(t, info, what), share_done(t, info));
}

std::string share_text(std::optional<double> share, double elapsed_s) {
  constexpr double kLeastShare = 0.01, kLeast_s = 1.0;  // before, the speed is not known
  if (!share) return "";
  const std::string percent = fmt::format("{:.0f} %", std::floor(100.0 * *share));
  if (*share < kLeastShare || elapsed_s < kLeast_s) return percent + "  ";
  const auto left_s = static_cast<long>(std::lround(elapsed_s / *share * (1.0 - *share)));
  const long hours = left_s / 3600, minutes = left_s / 60 % 60;
  const std::string whole = hours > 0 ? fmt::format("{}:{:02}", hours, minutes) : fmt::format("{}", minutes);
  return fmt::format("{}, {}:{:02} left  ", percent, whole, left_s % 60);
}

}  // namespace edged
