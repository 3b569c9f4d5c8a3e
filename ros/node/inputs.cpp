// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/inputs.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged::node {

Inputs::Inputs(Transport& transport, double max_age_s, std::function<void(const ImuSample&)> on_imu)
    : transport_(transport), on_imu_(std::move(on_imu)), queue_({.max_age_s = max_age_s}), thinner_(max_age_s) {}

void Inputs::subscribe(const std::string& topic, Role role, const std::string& camera) {
  const std::string name = transport_.full_name(topic);
  const auto [entry, is_new] = inputs_.try_emplace(name, transport_.wire(), role, camera);
  SensorInput& input = entry->second;
  if (!is_new)
    throw InputError::format("{} is used for both {} and {}: remap one of them", name, input.sensor(),
                             sensor_text(role, camera));
  if (!clocks_) clocks_.emplace(name);  // the first camera's
  transport_.subscribe(name, role, [this, name, &input](const WireMessage& message) {
    try {
      on_message(name, input, message);
    } catch (...) {  // which would end the process from a thread of the transport
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
  });
  spdlog::info(fmt::format("{} from {}", input.sensor(), name));
}

void Inputs::on_message(const std::string& topic, SensorInput& input, const WireMessage& message) {
  std::optional<Measurement> measurement = input.read(message);
  if (!measurement) return;
  const std::lock_guard lock(order_);
  // No other clock tells what an IMU with an epoch of its own does.
  if (imu_clock_ && std::holds_alternative<ImuSample>(*measurement)) return queue(topic, std::move(*measurement));
  for (auto& [from, passed] : stamps_.pass(topic, std::move(*measurement), input.clock(), StampClock::Clock::now()))
    queue(from, std::move(passed));
}

void Inputs::queue(const std::string& topic, Measurement measurement) {
  if (const auto t = last_stamp(measurement)) {
    inputs_.at(topic).note_time(*t);
    if (const auto wrong = clocks_->note(topic, *t)) spdlog::warn(*wrong);
  }
  if (imu_clock_) {
    std::optional<Measurement> passed = imu_clock_->pass(std::move(measurement));
    if (!passed) return;
    measurement = std::move(*passed);
  }
  if (const auto* sample = std::get_if<ImuSample>(&measurement)) on_imu_(*sample);
  const MeasurementQueue::Clock::time_point now = MeasurementQueue::Clock::now();
  if (auto* batch = std::get_if<EventBatch>(&measurement))
    thinner_.thin(*batch, to_seconds(now - queue_.waits_since().value_or(now)));
  queue_.push(std::move(measurement), now);
}

std::optional<Measurement> Inputs::next(std::chrono::milliseconds longest) {
  std::optional<Measurement> measurement = queue_.pop(longest);
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
  return measurement;
}

void Inputs::describe(NodeHealth& health) const {
  health.dropped = queue_.dropped();
  health.dropped.events += thinner_.dropped();
  health.wrong_clocks = clocks_->wrong();
  {
    const std::lock_guard lock(order_);
    health.imu_clock_unknown = imu_clock_ && !imu_clock_->known();
  }
  for (const auto& [topic, input] : inputs_) health.inputs.emplace(topic, input.counters());
  for (const auto& [topic, troubles] : transport_.troubles()) {
    const auto [entry, no_sensor] = health.inputs.try_emplace(topic);
    InputCounters& input = entry->second;
    input.optional = input.optional || no_sensor;  // requests and transforms
    input.lost = troubles.lost;
    input.refused = troubles.refused;
    input.transport_trouble = troubles.trouble;
  }
}

}  // namespace edged::node
