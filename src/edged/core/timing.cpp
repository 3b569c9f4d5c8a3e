// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/timing.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace edged {
namespace {
constexpr double kFirstBin_s = 1e-6;
const double kLogWidth = std::log(1.05);
}  // namespace

double thread_cpu_s() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void StageTiming::add(double seconds, std::optional<double> cpu_seconds) {
  const double bin = std::log(std::max(seconds, kFirstBin_s) / kFirstBin_s) / kLogWidth;
  ++bins_[std::min(static_cast<std::size_t>(bin), static_cast<std::size_t>(kBins - 1))];
  ++count_;
  total_s_ += seconds;
  max_s_ = std::max(max_s_, seconds);
  last_s_ = seconds;
  if (cpu_seconds) add_cpu(*cpu_seconds);
}

double StageTiming::quantile_s(double q) const {
  const auto wanted = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (int i = 0; i < kBins; ++i) {
    seen += bins_[static_cast<std::size_t>(i)];
    if (seen >= wanted && seen > 0) return std::min(max_s_, kFirstBin_s * std::exp((i + 1) * kLogWidth));
  }
  return max_s_;
}

StageTimings::Scope::Scope(StageTiming& stage, bool with_cpu)
    : stage_(stage), start_(std::chrono::steady_clock::now()) {
  if (with_cpu) cpu_start_s_ = thread_cpu_s();
}

StageTimings::Scope::~Scope() {
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start_;
  stage_.add(wall.count(), cpu_start_s_ ? std::optional(thread_cpu_s() - *cpu_start_s_) : std::nullopt);
}

StageTiming& StageTimings::timing_of(const std::string& stage) {
  auto found = std::find_if(stages_.begin(), stages_.end(), [&](const Entry& e) { return e.name == stage; });
  if (found == stages_.end()) {
    stages_.reserve(64);  // scopes hold references: more stages than this would move them
    found = stages_.insert(stages_.end(), Entry{stage, {}});
  }
  return found->timing;
}

const StageTiming* StageTimings::find(const std::string& stage) const {
  const auto found = std::ranges::find(stages_, stage, &Entry::name);
  return found == stages_.end() ? nullptr : &found->timing;
}

}  // namespace edged
