// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/external_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

constexpr Duration kMeanOver = std::chrono::milliseconds(500);

}  // namespace

void ExternalCollector::add(const ExternalSample& sample) {
  const Timestamp t = time_of(sample);
  const ExternalNumbers numbers = sensor_of(sample).numbers(sample);
  stream_.add(t, t);
  if (statistics_.least.empty()) {
    statistics_.least = statistics_.most = numbers.values;
    same_since_ = mean_begin_ = t;
    mean_sum_.assign(numbers.values.size(), 0.0);
  }
  for (std::size_t i = 0; i < numbers.values.size(); ++i) {
    if (!std::isfinite(numbers.sigmas[i])) continue;
    statistics_.least[i] = std::min(statistics_.least[i], numbers.values[i]);
    statistics_.most[i] = std::max(statistics_.most[i], numbers.values[i]);
    sigma_sum_ += numbers.sigmas[i];
    ++sigmas_;
  }
  if (numbers.values != last_) same_since_ = t;
  statistics_.constant = std::max(statistics_.constant, t - same_since_);
  add_noise(numbers.values);
  add_to_mean(t, numbers.values);
}

/// The noise from second differences, which are zero in uniform motion. Their variance is six times that of the noise.
void ExternalCollector::add_noise(const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size() && !before_.empty(); ++i) {
    squares_ += std::pow(values[i] - 2.0 * last_[i] + before_[i], 2);
    ++differences_;
  }
  before_ = std::exchange(last_, values);
}

void ExternalCollector::add_to_mean(Timestamp t, const std::vector<double>& values) {
  if (t - mean_begin_ >= kMeanOver && mean_count_ > 0) {
    std::vector<double> mean = mean_sum_;
    for (double& x : mean) x /= static_cast<double>(mean_count_);
    for (std::size_t i = 0; i < mean.size() && !last_mean_.empty(); ++i)
      statistics_.fastest =
          std::max(statistics_.fastest, std::abs(mean[i] - last_mean_[i]) / to_seconds(t - mean_begin_));
    last_mean_ = std::move(mean);
    mean_sum_.assign(values.size(), 0.0);
    mean_count_ = 0;
    mean_begin_ = t;
  }
  for (std::size_t i = 0; i < values.size(); ++i) mean_sum_[i] += values[i];
  ++mean_count_;
}

ExternalStatistics ExternalCollector::result() const {
  ExternalStatistics statistics = statistics_;
  statistics.stream = stream_.result();
  if (differences_ > 0) statistics.noise = std::sqrt(squares_ / (6.0 * static_cast<double>(differences_)));
  if (sigmas_ > 0) statistics.sigma = sigma_sum_ / static_cast<double>(sigmas_);
  return statistics;
}

}  // namespace edged
