// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/simulated_pair.hpp"

#include <algorithm>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/core/measurements/stream_order.hpp"

namespace edged {
namespace {

SimulatorConfig of_right(SimulatorConfig config, double baseline_m) {
  config.mount = {SE3(Eigen::Quaterniond::Identity(), {baseline_m, 0, 0}), "2"};
  return config;
}

/// The stamp of a measurement of type T, for a batch that of its first event. Timestamp::max() for other measurements.
template <typename T>
Timestamp stamp_as(const std::optional<Measurement>& measurement) {
  return measurement && std::holds_alternative<T>(*measurement) ? *first_stamp(*measurement) : Timestamp::max();
}

/// Takes the events before that stamp. The rest stays.
Measurement take_events(std::optional<Measurement>& measurement, Timestamp end) {
  auto& batch = std::get<EventBatch>(*measurement);
  const auto cut = std::ranges::find_if(batch.events, [end](const Event& event) { return event.t >= end; });
  if (cut == batch.events.end()) return *std::exchange(measurement, std::nullopt);
  EventBatch first{batch.camera, {batch.events.begin(), cut}};
  batch.events.erase(batch.events.begin(), cut);
  return first;
}

}  // namespace

SimulatedPair::SimulatedPair(const SimulatorConfig& config, double baseline_m)
    : left_(config), right_(of_right(config, baseline_m)), info_(left_.info()) {
  info_.more_cameras = recorded_cameras(right_.info());
}

/// IMU and external sensors are those of the left simulator.
std::optional<Measurement> SimulatedPair::take_right() {
  while (std::optional<Measurement> measurement = right_.next()) {
    if (camera_of(*measurement)) return measurement;
  }
  return std::nullopt;
}

std::optional<Measurement> SimulatedPair::next() {
  if (!of_left_) of_left_ = left_.next();
  if (!of_right_) of_right_ = take_right();
  const Timestamp left_events = stamp_as<EventBatch>(of_left_), right_events = stamp_as<EventBatch>(of_right_);
  const Timestamp left_frame = stamp_as<Frame>(of_left_), right_frame = stamp_as<Frame>(of_right_);
  const NextStream turn = next_stream(stamp_as<ImuSample>(of_left_), std::min(left_events, right_events),
                                      std::min(left_frame, right_frame), stamp_as<ExternalSample>(of_left_));
  switch (turn.stream) {
    case NextStream::Stream::External:
    case NextStream::Stream::Imu:
      return std::exchange(of_left_, std::nullopt);
    case NextStream::Stream::Events:
      return take_events(left_events <= right_events ? of_left_ : of_right_, turn.events_end);
    case NextStream::Stream::Frame:
      return std::exchange(left_frame <= right_frame ? of_left_ : of_right_, std::nullopt);
    case NextStream::Stream::None:
      break;
  }
  return std::nullopt;
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
