// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Statistics of one external sensor: rate, range, noise, and longest time without change.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "edged/checks/statistics/stream_statistics.hpp"
#include "edged/core/measurements/external_sensor.hpp"

namespace edged {

struct ExternalStatistics {
  StreamStatistics stream;
  std::vector<double> least, most;  ///< bounds of the measured values of each column
  double noise = 0.0;               ///< standard deviation of a sample, from differences of consecutive samples
  double sigma = 0.0;               ///< mean sigma of the samples; 0: none
  double fastest = 0.0;             ///< largest change in a second, of any column, between means of half a second
  Duration constant{0};             ///< the longest time in which no number changed
};

/// Samples of one sensor, in time order. Memory is bounded.
class ExternalCollector {
 public:
  void add(const ExternalSample& sample);
  ExternalStatistics result() const;

 private:
  void add_noise(const std::vector<double>& values);
  void add_to_mean(Timestamp t, const std::vector<double>& values);

  StreamCollector stream_;
  ExternalStatistics statistics_;
  std::vector<double> last_, before_;  ///< values of the last sample and of the one before
  Timestamp same_since_;
  double squares_ = 0.0, sigma_sum_ = 0.0;
  std::size_t differences_ = 0, sigmas_ = 0;
  Timestamp mean_begin_;
  std::vector<double> mean_sum_, last_mean_;
  std::size_t mean_count_ = 0;
};

/// The statistics by the names of the sensors.
using ExternalStatisticsByName = std::map<std::string, ExternalStatistics, std::less<>>;

}  // namespace edged
