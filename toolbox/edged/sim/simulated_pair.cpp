// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/simulated_pair.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "edged/core/measurement_stamps.hpp"

namespace edged {
namespace {

SimulatorConfig of_right(SimulatorConfig config, double baseline_m) {
  config.mount = {SE3(Eigen::Quaterniond::Identity(), {baseline_m, 0, 0}), "2"};
  return config;
}

/// Of what comes first: by its stamp, then IMU, events, frame.
std::pair<Timestamp, int> place(const std::optional<Measurement>& measurement) {
  if (!measurement) return {Timestamp::max(), 3};
  const int rank = std::holds_alternative<ImuSample>(*measurement)    ? 0
                   : std::holds_alternative<EventBatch>(*measurement) ? 1
                                                                      : 2;
  return {*first_stamp(*measurement), rank};
}

/// The part of `measurement` that comes before the other, where that is not of events; the rest stays.
Measurement before(std::optional<Measurement>& measurement, const std::optional<Measurement>& other) {
  const auto [t, rank] = place(other);
  auto* batch = std::get_if<EventBatch>(&*measurement);
  const auto comes_later = [&, limit = t, is_frame = rank == 2](const Event& event) {
    return is_frame ? event.t > limit : event.t >= limit;
  };
  if (batch == nullptr || rank == 1 || !comes_later(batch->events.back()))
    return *std::exchange(measurement, std::nullopt);
  const auto cut = std::ranges::find_if(batch->events, comes_later);
  EventBatch first{batch->camera, {batch->events.begin(), cut}};
  batch->events.erase(batch->events.begin(), cut);
  return first;
}

}  // namespace

SimulatedPair::SimulatedPair(const SimulatorConfig& config, double baseline_m)
    : left_(config), right_(of_right(config, baseline_m)) {}

/// Its IMU is that of the left one.
std::optional<Measurement> SimulatedPair::take_right() {
  while (std::optional<Measurement> measurement = right_.next()) {
    if (!std::holds_alternative<ImuSample>(*measurement)) return measurement;
  }
  return std::nullopt;
}

std::optional<Measurement> SimulatedPair::next() {
  if (!of_left_) of_left_ = left_.next();
  if (!of_right_) of_right_ = take_right();
  if (!of_left_ && !of_right_) return std::nullopt;
  const bool is_left = place(of_left_) <= place(of_right_);
  return is_left ? before(of_left_, of_right_) : before(of_right_, of_left_);
}

void SimulatedPair::leave_out(Modality unwanted) {
  left_.leave_out(unwanted);
  right_.leave_out(unwanted);
}

Calibration SimulatedPair::calibration() const {
  Calibration calibration = left_.calibration();
  std::ranges::move(right_.calibration().rig.cameras, std::back_inserter(calibration.rig.cameras));
  return calibration;
}

}  // namespace edged
