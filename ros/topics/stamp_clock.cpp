// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "topics/stamp_clock.hpp"

#include <algorithm>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged::node {
namespace {

constexpr Duration kJump = std::chrono::milliseconds(20);       // less than SensorClock takes for a step
constexpr auto kPacketsEnded = std::chrono::milliseconds(500);  // no packet for so long: nothing can be told
constexpr int kAveraged = 8;                                    // over which the usual one is averaged

void shift(Measurement& measurement, Duration by) {
  if (auto* batch = std::get_if<EventBatch>(&measurement)) {
    for (Event& event : batch->events) event.t -= by;
  } else if (auto* frame = std::get_if<Frame>(&measurement)) {
    frame->t -= by;
  } else if (auto* sample = std::get_if<ImuSample>(&measurement)) {
    sample->t -= by;
  } else {
    std::visit([by](auto& value) { value.t -= by; }, std::get<ExternalSample>(measurement));
  }
}

}  // namespace

std::optional<std::size_t> StampClock::step_of(const Topic& topic, Duration jump) const {
  for (std::size_t i = topic.steps; i < steps_.size(); ++i)
    if (std::chrono::abs(steps_[i] - jump) < kJump) return i;
  return std::nullopt;
}

/// Steps that the clock of a sensor has told. Of two cameras the second tells the same one again.
void StampClock::follow(Topic& topic, const std::vector<ClockStep>& steps) {
  for (; topic.own_steps < steps.size(); ++topic.own_steps) {
    const ClockStep& step = steps[topic.own_steps];
    if (!step.of_stamps) continue;
    if (!step_of(topic, step.stamps_by)) {
      steps_.push_back(step.stamps_by);
      undoubted_.reset();
    }
    topic.steps = *step_of(topic, step.stamps_by) + 1;
    topic.set_by += step.stamps_by;
  }
}

/// Whether what is held can go.
bool StampClock::decide(Topic& topic, Clock::time_point now) const {
  if (const auto step = step_of(topic, topic.jump)) {
    topic.set_by += steps_[*step];
    topic.steps = *step + 1;
    return true;
  }
  return (undoubted_ && *undoubted_ >= topic.decided_at) || now - packet_at_ > kPacketsEnded;
}

/// Whether the measurement has to wait as its stamp jumps while it can be told why.
bool StampClock::jumps(Topic& topic, Timestamp stamp, Clock::time_point now) {
  if (!topic.held.empty()) return true;
  if (!topic.last) return false;
  const Duration interval = stamp - *topic.last, jump = interval - topic.interval;
  const bool usual = topic.interval == Duration(0) || std::chrono::abs(jump) < kJump;
  if (usual) topic.interval += (interval - topic.interval) / (topic.interval == Duration(0) ? 1 : kAveraged);
  if (usual || now - packet_at_ > kPacketsEnded) return false;
  topic.jump = jump;
  topic.decided_at = std::max(stamp, *topic.last + topic.interval) + kJump;  // whichever clock is right
  return true;
}

std::vector<StampClock::Passed> StampClock::pass(const std::string& name, Measurement measurement,
                                                 const SensorClock* sensor, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  std::vector<Passed> passed;
  Topic& topic = topics_[name];
  const std::optional<Timestamp> stamp = last_stamp(measurement);
  if (sensor != nullptr) {
    follow(topic, sensor->steps());
    packet_at_ = now;
    if (!sensor->in_doubt()) undoubted_ = std::max(undoubted_.value_or(sensor->stamp()), sensor->stamp());
  }
  const bool waits = sensor == nullptr && stamp && jumps(topic, *stamp, now);
  if (stamp) topic.last = *stamp;
  if (waits) {
    topic.held.push_back(std::move(measurement));
  } else {
    shift(measurement, topic.set_by);
    passed.push_back({name, std::move(measurement)});
  }
  for (auto& [other, waiting] : topics_) {
    if (waiting.held.empty() || !decide(waiting, now)) continue;
    for (Measurement& held : std::exchange(waiting.held, {})) {
      shift(held, waiting.set_by);
      passed.push_back({other, std::move(held)});
    }
  }
  return passed;
}

Duration StampClock::set_by() const {
  const std::lock_guard lock(mutex_);
  Duration sum{0};
  for (const Duration step : steps_) sum += step;
  return sum;
}

}  // namespace edged::node
