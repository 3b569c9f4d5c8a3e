// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The noise of an IMU at rest from its Allan deviation (IEEE Std 952-1997, annex C).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace edged {

/// The Allan deviation of one signal, by clusters of 2^k samples that do not overlap. Needs memory for the logarithm of
/// the length only.
class AllanDeviation {
 public:
  struct Point {
    double tau_s;       ///< length of a cluster
    double deviation;   ///< between neighbouring clusters, in the unit of the signal
    std::size_t pairs;  ///< pairs of clusters
  };

  /// period_s: of the samples, which are equally spaced.
  explicit AllanDeviation(double period_s) : period_s_(period_s) {}

  void add(double value) { add(0, value); }
  /// Samples are missing: no cluster spans them.
  void skip_gap();
  /// Points with enough pairs, tau_s rising.
  std::vector<Point> points() const;

 private:
  struct Level {
    std::optional<double> before, half;  ///< the cluster before; the first half of one of the next level
    double sum = 0.0;                    ///< sum of squared differences
    std::size_t pairs = 0;
  };
  void add(std::size_t level, double mean);

  double period_s_;
  std::vector<Level> levels_;
};

/// variance(tau) = white^2 / tau + (2 ln 2 / pi) instability^2 + walk^2 tau / 3.
struct SignalNoise {
  double white = 0.0;        ///< density [unit/sqrt(Hz)]
  double instability = 0.0;  ///< bias instability [unit]
  double walk = 0.0;         ///< random walk of the bias [unit/s/sqrt(Hz)]
  double walk_sigma = 0.0;   ///< its standard deviation
};

/// Weighted least squares without negative parts. At least three points, else EDGED_CHECK.
SignalNoise fit_noise(std::span<const AllanDeviation::Point> points);

}  // namespace edged
