// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Time: nanoseconds since the recording's own epoch. Seconds appear only in input and output.
#pragma once

#include <chrono>
#include <cstdint>

namespace edged {

using Duration = std::chrono::nanoseconds;

/// The clock of a recording: its stamps count from the epoch the recording chose (Unix time, start of file, ...).
struct RecordingClock {
  using rep = std::int64_t;
  using period = std::nano;
  using duration = Duration;
  using time_point = std::chrono::time_point<RecordingClock>;
  static constexpr bool is_steady = true;
};

/// A strong type: Timestamp - Timestamp is a Duration, Timestamp + Timestamp does not compile.
using Timestamp = RecordingClock::time_point;

constexpr double to_seconds(Duration d) { return static_cast<double>(d.count()) * 1e-9; }

/// Loses sub-microsecond digits for Unix stamps (a double holds 1.7e9 s to 0.2 us): for printing and plots only.
constexpr double to_seconds(Timestamp t) { return to_seconds(t.time_since_epoch()); }

/// Nearest nanosecond.
constexpr Duration duration_from_seconds(double s) {
  return Duration(static_cast<std::int64_t>(s * 1e9 + (s < 0 ? -0.5 : 0.5)));
}

constexpr Timestamp timestamp_from_seconds(double s) { return Timestamp(duration_from_seconds(s)); }
constexpr Timestamp timestamp_from_ns(std::int64_t ns) { return Timestamp(Duration(ns)); }
constexpr std::int64_t to_ns(Timestamp t) { return t.time_since_epoch().count(); }

}  // namespace edged
