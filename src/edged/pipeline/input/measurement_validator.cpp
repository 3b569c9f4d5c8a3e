// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/input/measurement_validator.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/pipeline/tuning.hpp"

namespace edged {
namespace {

/// Most batches are in order and inside the sensor: then the stamps of their ends decide about all their events.
bool is_regular(const std::vector<Event>& events, const CameraModel& camera) {
  const int width = camera.width(), height = camera.height();
  Timestamp before = events.front().t;
  for (const Event& event : events) {
    if (event.t < before || event.x >= width || event.y >= height) return false;
    before = event.t;
  }
  return is_plausible(events.front().t) && is_plausible(events.back().t);
}

/// Sets the camera name of an item that the gate held.
template <typename T>
Measurement measurement_of(const std::string& camera, T item) {
  if constexpr (std::is_same_v<T, Event>) {
    return EventBatch{camera, {item}};
  } else {
    return item;
  }
}

}  // namespace

bool ClockWatch::set_back(Timestamp t) {
  if (!newest_ || t > *newest_ - kPipelineTuning.clock_jump) {
    newest_ = std::max(newest_.value_or(t), t);
    behind_since_.reset();
    return false;
  }
  if (!behind_since_ || t < behind_ || t - behind_ > kPipelineTuning.clock_jump)
    behind_since_ = t;  // no stamp that continues from another
  behind_ = t;
  return t - *behind_since_ >= kPipelineTuning.clock_confirmation;
}

MeasurementValidator::MeasurementValidator(const Rig& rig, const Rig& used, const SensorDelays& delays)
    : used_(used), delays_(delays) {
  delays_.validate();
  epochs_.emplace_back(used_, delays_);
  for (const RigCamera& camera : rig.cameras) known_.emplace_back(camera.name, camera.modality);
  for (const RigCamera& camera : used.cameras) {
    if (camera.modality == Modality::Events) {
      events_.push_back({camera.name, camera.model});
    } else {
      frames_.push_back({camera.name, camera.model});
    }
  }
}

void MeasurementValidator::add(Measurement measurement) {
  const std::lock_guard lock(mutex_);
  std::visit([this](auto& item) { accept(std::move(item)); }, measurement);
}

/// Events are checked one by one where not all of the batch can be taken at once.
void MeasurementValidator::accept(EventBatch batch) {
  Sensor<Event>* sensor = find(events_, batch.camera);
  if (sensor == nullptr || batch.events.empty()) return;
  const bool regular = is_regular(batch.events, sensor->model);
  if (!regular) remove_invalid(batch.events, sensor->model);
  // Masked events must not cut packets either, nor count as motion.
  if (sensor->model.is_masked())
    std::erase_if(batch.events, [&](const Event& event) { return !sensor->model.uses(event.x, event.y); });
  if (!batch.events.empty() && !(regular && sensor->gate.passes(batch.events.back().t))) {
    const auto pass = [&batch](const Event& event) { batch.events.push_back(event); };
    const auto drop = [&](const Event&, Timestamp) { ++counters_.far_ahead; };
    for (const Event& event : std::exchange(batch.events, {})) sensor->gate.push(event, pass, drop);
  }
  if (!batch.events.empty()) release(std::move(batch), sensor->clock);
}

void MeasurementValidator::accept(Frame frame) {
  Sensor<Frame>* sensor = find(frames_, frame.camera);
  if (sensor != nullptr && is_valid(frame, sensor->model)) validate(*sensor, std::move(frame));
}

void MeasurementValidator::accept(const ImuSample& sample) {
  if (is_valid(sample)) validate(imu_, sample);
}

void MeasurementValidator::accept(const ExternalSample& sample) {
  if (!is_plausible(time_of(sample))) {
    ++counters_.absurd_stamps;
  } else if (!is_plausible(sample)) {
    ++counters_.external_unfit;
  } else {
    external_[sample.index()].push(
        sample, [this](const ExternalSample& one) { forward(one); },
        [this](const ExternalSample&, Timestamp) { ++counters_.far_ahead; });
  }
}

template <typename T>
void MeasurementValidator::validate(Sensor<T>& sensor, T item) {
  std::vector<T> passed;
  sensor.gate.push(
      std::move(item), [&](T one) { passed.push_back(std::move(one)); },
      [&](const T&, Timestamp) { ++counters_.far_ahead; });
  for (T& one : passed) release(std::move(one), sensor.clock);
}

/// give(gate, sink of its output).
template <typename Give>
void MeasurementValidator::for_each_gate(const Give& give) {
  const auto open = [&]<typename T>(Sensor<T>& sensor) {
    give(sensor.gate, [this, &sensor](T item) { release(measurement_of(sensor.name, std::move(item)), sensor.clock); });
  };
  for (Sensor<Event>& sensor : events_) open(sensor);
  for (Sensor<Frame>& sensor : frames_) open(sensor);
  open(imu_);
  for (JumpGate<ExternalSample>& gate : external_)
    give(gate, [this](const ExternalSample& sample) { forward(sample); });
}

void MeasurementValidator::release(Measurement measurement, ClockWatch& clock) {
  const Timestamp t = *last_stamp(measurement);
  if (clock.set_back(t)) begin_epoch();
  forward(std::move(measurement));
  // Held items near it have no damaged stamp either, and still get into order.
  for_each_gate([t](auto& gate, const auto& pass) { gate.confirm(t, pass); });
}

void MeasurementValidator::forward(Measurement measurement) {
  counters_.no_room += epochs_.back().add(std::move(measurement)) ? 0 : 1;
}

std::array<JumpGate<ExternalSample>, kExternalSensors> MeasurementValidator::fresh_gates() {
  return []<std::size_t... I>(std::index_sequence<I...>) {
    return std::array{(static_cast<void>(I), JumpGate<ExternalSample>(false))...};
  }
  (std::make_index_sequence<kExternalSensors>());
}

void MeasurementValidator::begin_epoch() {
  ++counters_.clocks_set_back;
  const auto begin = []<typename T>(Sensor<T>& sensor) {
    sensor.gate = JumpGate<T>{false};
    sensor.clock = {};
  };
  std::ranges::for_each(events_, begin);
  std::ranges::for_each(frames_, begin);
  begin(imu_);
  external_ = fresh_gates();
  epochs_.back().finish();
  if (epochs_.size() == 2) {                        // next() has not been called for long
    counters_.no_room += epochs_.back().waiting();  // of the epoch that was the newest
    epochs_.pop_back();
  }
  epochs_.emplace_back(used_, delays_);
}

void MeasurementValidator::finish() {
  const std::lock_guard lock(mutex_);
  for_each_gate([](auto& gate, const auto& pass) { gate.finish(pass); });
  epochs_.back().finish();
}

std::optional<MeasurementValidator::Item> MeasurementValidator::next() {
  const std::lock_guard lock(mutex_);
  while (true) {
    if (std::optional<Measurement> measurement = epochs_.front().next())
      return Item{std::move(*measurement), std::exchange(begins_time_, false)};
    if (epochs_.size() == 1 || !epochs_.front().ended()) return std::nullopt;
    epochs_.pop_front();
    begins_time_ = true;
  }
}

bool MeasurementValidator::ended() const {
  const std::lock_guard lock(mutex_);
  return epochs_.size() == 1 && epochs_.front().ended();
}

IntakeCounters MeasurementValidator::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

template <typename T>
MeasurementValidator::Sensor<T>* MeasurementValidator::find(std::vector<Sensor<T>>& cameras, const std::string& name) {
  const auto found = std::ranges::find(cameras, name, &Sensor<T>::name);
  if (found != cameras.end()) return &*found;
  const Modality modality = std::is_same_v<T, Event> ? Modality::Events : Modality::Frames;
  const bool known = std::ranges::find(known_, std::pair(name, modality)) != known_.end();
  ++(known ? counters_.unused_camera : counters_.unknown_camera);
  return nullptr;
}

void MeasurementValidator::remove_invalid(std::vector<Event>& events, const CameraModel& camera) {
  const int width = camera.width(), height = camera.height();
  counters_.events_outside +=
      std::erase_if(events, [=](const Event& event) { return event.x >= width || event.y >= height; });
  counters_.absurd_stamps += std::erase_if(events, [](const Event& event) { return !is_plausible(event.t); });
}

bool MeasurementValidator::is_valid(Frame& frame, const CameraModel& camera) {
  cv::Mat& image = frame.image;
  const bool fits = image.type() == CV_8UC1 && image.cols == camera.width() && image.rows == camera.height();
  counters_.frames_unfit += fits ? 0 : 1;
  if (fits && image.u == nullptr) image = image.clone();  // a driver's memory, which may be freed before it is used
  counters_.absurd_stamps += is_plausible(frame.t) ? 0 : 1;
  return fits && is_plausible(frame.t);
}

bool MeasurementValidator::is_valid(const ImuSample& sample) {
  counters_.absurd_stamps += is_plausible(sample.t) ? 0 : 1;
  return is_plausible(sample.t);
}

}  // namespace edged
