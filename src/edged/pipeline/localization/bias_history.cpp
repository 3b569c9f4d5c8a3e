// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/bias_history.hpp"

#include <algorithm>
#include <cmath>

#include "edged/core/statistics.hpp"
#include "edged/pipeline/tuning.hpp"

namespace edged {
double BiasHistory::add(const OdomState& state, const Matrix15d& P) {
  while (!entries_.empty() && state.t - entries_.front().t > kPipelineTuning.judged) entries_.pop_front();
  Entry now{state.t, {}, P.diagonal().tail<6>()};
  now.bias << state.bias_gyro, state.bias_accel;
  double most = 0.0;
  for (const Entry& before : entries_) {
    const double dt = to_seconds(now.t - before.t);
    Vector6d variance = before.variance;
    variance.head<3>().array() += square(kPipelineTuning.gyro_drift) + square(noise_.gyro_walk) * dt;
    variance.tail<3>().array() += square(kPipelineTuning.accel_drift) + square(noise_.accel_walk) * dt;
    most = std::max(most, ((now.bias - before.bias).array() / variance.array().sqrt()).abs().maxCoeff());
  }
  entries_.push_back(now);
  return most;
}

BiasPrior BiasHistory::prior(const Entry& entry) {
  const double gyro = entry.variance.head<3>().maxCoeff(), accel = entry.variance.tail<3>().maxCoeff();
  return {entry.bias.head<3>(), entry.bias.tail<3>(), std::sqrt(gyro + square(kPipelineTuning.gyro_drift)),
          std::sqrt(accel + square(kPipelineTuning.accel_drift))};
}

}  // namespace edged
