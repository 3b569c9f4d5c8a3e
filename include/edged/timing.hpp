// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Stage timers: wall time per call, kept as a histogram of bounded size, and the processor time of all of them.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace edged {

/// Processor time that the calling thread has used so far [s].
double thread_cpu_s();

/// Durations of one stage in logarithmic bins 5 % wide from 1 us to about 1000 s.
class StageTiming {
 public:
  void add(double seconds, std::optional<double> cpu_seconds = std::nullopt);
  /// Adds processor time of calls that were added without it.
  void add_cpu(double seconds) { cpu_s_ = cpu_s_.value_or(0.0) + seconds; }
  std::uint64_t count() const { return count_; }
  double mean_s() const { return count_ == 0 ? 0.0 : total_s_ / static_cast<double>(count_); }
  double total_s() const { return total_s_; }
  double max_s() const { return max_s_; }
  double last_s() const { return last_s_; }  ///< the newest call
  /// Processor time of the threads that measured; none where it was not taken.
  std::optional<double> cpu_s() const { return cpu_s_; }
  /// Upper edge of the bin that holds the share q in [0, 1] of the calls: exact to 5 %.
  double quantile_s(double q) const;

 private:
  static constexpr int kBins = 440;
  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  double total_s_ = 0.0;
  double max_s_ = 0.0, last_s_ = 0.0;
  std::optional<double> cpu_s_;
};

/// All stages of a run, in the order of their first use.
class StageTimings {
 public:
  /// Measures the time until it goes out of scope.
  class Scope {
   public:
    Scope(StageTiming& stage, bool with_cpu);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    StageTiming& stage_;
    std::chrono::steady_clock::time_point start_;
    std::optional<double> cpu_start_s_;
  };

  /// Measures this thread in both kinds of time.
  [[nodiscard]] Scope measure(const std::string& stage) { return {timing_of(stage), true}; }
  /// Measures without processor time, which costs a system call: for what is entered thousands of times a second.
  [[nodiscard]] Scope measure_often(const std::string& stage) { return {timing_of(stage), false}; }
  /// Adds a stage that the caller has measured.
  void put(const std::string& stage, const StageTiming& timing) { timing_of(stage) = timing; }
  struct Entry {
    std::string name;
    StageTiming timing;
  };
  const std::vector<Entry>& all() const { return stages_; }
  /// Null where it was never measured.
  const StageTiming* find(const std::string& stage) const;

 private:
  StageTiming& timing_of(const std::string& stage);

  std::vector<Entry> stages_;
};

}  // namespace edged
