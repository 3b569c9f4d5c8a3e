// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/stream_statistics.hpp"

#include <algorithm>
#include <utility>

#include "edged/core/statistics.hpp"

namespace edged {
namespace {

constexpr std::size_t kLearnSteps = 500;
constexpr std::size_t kListedGaps = 5;

}  // namespace

void StreamCollector::add(Timestamp first, Timestamp last, std::size_t count) {
  if (statistics_.end) {
    const Gap step{*statistics_.end, first - *statistics_.end};
    if (longest_step_) {
      judge(step);
    } else {
      steps_.push_back(step);
      if (steps_.size() == kLearnSteps) learn();
    }
  }
  if (!statistics_.begin) statistics_.begin = first;
  statistics_.end = last;
  statistics_.count += count;
}

StreamStatistics StreamCollector::result() const {
  StreamCollector copy = *this;
  if (!copy.steps_.empty()) copy.learn();
  return copy.statistics_;
}

void StreamCollector::learn() {
  std::vector<double> lengths;
  for (const Gap& step : steps_) lengths.push_back(static_cast<double>(step.length.count()));
  statistics_.typical_step = Duration(static_cast<Duration::rep>(median(std::move(lengths))));
  longest_step_ = statistics_.typical_step * 5 / 2;
  for (const Gap& step : std::exchange(steps_, {})) judge(step);
}

void StreamCollector::judge(const Gap& step) {
  if (step.length <= *longest_step_) return;
  ++statistics_.gaps;
  statistics_.missing += step.length;
  const auto longer = [](const Gap& a, const Gap& b) { return a.length > b.length; };
  std::vector<Gap>& list = statistics_.longest;
  list.insert(std::upper_bound(list.begin(), list.end(), step, longer), step);
  if (list.size() > kListedGaps) list.pop_back();
}

}  // namespace edged
