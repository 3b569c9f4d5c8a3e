// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Semi-dense depth of a simulated flight, and how far it is from the true depth.
#pragma once

#include <string>

#include "edged/dense/dense_mapper.hpp"
#include "end_to_end.hpp"

namespace edged {

struct DenseRun {
  DenseMapper mapper;
  double cpu_s = 0.0;   ///< of the mapper alone
  double span_s = 0.0;  ///< of the odometry's steps
};

DenseRun map_densely(const Flight& flight, Mode mode, const OdometryConfig& config = {});

/// Over all points. The error is that of the depth, over the true one. At the rim of an object its edge belongs to
/// either side: of the pixel and its neighbours the nearest depth counts.
struct DenseScore {
  std::size_t points = 0;
  double median_error = 1.0;
  double outliers = 1.0;  ///< share of the points with errors beyond 0.1
  double complete = 0.0;  ///< share of the edge pixels that have a depth
  double load = 0.0;      ///< [CPU s/s] of the mapper
};

DenseScore score(const DenseRun& run, const SimulatorConfig& truth);

/// One line for a person.
std::string describe(const DenseRun& run, const DenseScore& score);

}  // namespace edged
