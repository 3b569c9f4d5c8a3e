// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/core/timing.hpp"

#include <algorithm>
#include <cmath>

namespace edged {
namespace {
constexpr double kFirstBin_s = 1e-6;
const double kLogWidth = std::log(1.05);
}  // namespace

void StageTiming::add(double seconds) {
  const double bin = std::log(std::max(seconds, kFirstBin_s) / kFirstBin_s) / kLogWidth;
  ++bins_[std::min(static_cast<std::size_t>(bin), static_cast<std::size_t>(kBins - 1))];
  ++count_;
  total_s_ += seconds;
  max_s_ = std::max(max_s_, seconds);
  last_s_ = seconds;
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

StageTimings::Scope StageTimings::measure(const std::string& stage) {
  auto found = std::find_if(stages_.begin(), stages_.end(), [&](const Entry& e) { return e.name == stage; });
  if (found == stages_.end()) {
    stages_.reserve(64);  // scopes hold references: more stages than this would move them
    found = stages_.insert(stages_.end(), Entry{stage, {}});
  }
  return Scope(found->timing);
}

const StageTiming* StageTimings::find(const std::string& stage) const {
  const auto found = std::ranges::find(stages_, stage, &Entry::name);
  return found == stages_.end() ? nullptr : &found->timing;
}

}  // namespace edged
