// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/stream_survey.hpp"

#include <algorithm>
#include <utility>

#include "edged/core/statistics.hpp"

namespace edged {
namespace {

constexpr std::size_t kLearnSteps = 500;
constexpr std::size_t kListedGaps = 5;

}  // namespace

void StreamSurveyor::add(Timestamp first, Timestamp last, std::size_t count) {
  if (survey_.end) {
    const Gap step{*survey_.end, first - *survey_.end};
    if (longest_step_) {
      judge(step);
    } else {
      steps_.push_back(step);
      if (steps_.size() == kLearnSteps) learn();
    }
  }
  if (!survey_.begin) survey_.begin = first;
  survey_.end = last;
  survey_.count += count;
}

StreamSurvey StreamSurveyor::result() const {
  StreamSurveyor copy = *this;
  if (!copy.steps_.empty()) copy.learn();
  return copy.survey_;
}

void StreamSurveyor::learn() {
  std::vector<double> lengths;
  for (const Gap& step : steps_) lengths.push_back(static_cast<double>(step.length.count()));
  survey_.typical_step = Duration(static_cast<Duration::rep>(median(std::move(lengths))));
  longest_step_ = survey_.typical_step * 5 / 2;
  for (const Gap& step : std::exchange(steps_, {})) judge(step);
}

void StreamSurveyor::judge(const Gap& step) {
  if (step.length <= *longest_step_) return;
  ++survey_.gaps;
  survey_.missing += step.length;
  const auto longer = [](const Gap& a, const Gap& b) { return a.length > b.length; };
  std::vector<Gap>& list = survey_.longest;
  list.insert(std::upper_bound(list.begin(), list.end(), step, longer), step);
  if (list.size() > kListedGaps) list.pop_back();
}

}  // namespace edged
