// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/intake.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "edged/core/measurement_stamps.hpp"

namespace edged {
namespace {

constexpr Duration kBehind = std::chrono::seconds(1);
constexpr Duration kSure = std::chrono::milliseconds(500);
constexpr std::size_t kMostTimes = 2;

/// Stamps are compared as recorded: what a camera's clock is behind the IMU's by, it lags by, and the other way round.
SensorDelays as_recorded(SensorDelays delays, const Rig& rig, Mode mode) {
  delays.validate();
  if (delays == kInOrder) return delays;
  for (const Modality modality : {Modality::Events, Modality::Frames}) {
    const RigCamera* camera = used_camera(rig, mode, modality);
    if (camera == nullptr) continue;
    const double offset_s = to_seconds(camera->time_offset);
    (modality == Modality::Events ? delays.events_s : delays.frames_s) += std::max(0.0, offset_s);
    delays.imu_s = std::max(delays.imu_s, delays.imu_s - offset_s);
  }
  return delays;
}

}  // namespace

bool ClockWatch::set_back(Timestamp t) {
  if (!newest_ || t > *newest_ - kBehind) {
    newest_ = std::max(newest_.value_or(t), t);
    behind_since_.reset();
    return false;
  }
  if (!behind_since_ || t < behind_ || t - behind_ > kBehind) behind_since_ = t;  // no stamp that goes on from another
  behind_ = t;
  return t - *behind_since_ >= kSure;
}

Intake::Intake(const Rig& rig, Mode mode, const SensorDelays& delays)
    : mode_(mode), delays_(as_recorded(delays, rig, mode)) {
  times_.emplace_back(mode_, delays_);
  const RigCamera* events = used_camera(rig, mode, Modality::Events);
  const RigCamera* frames = used_camera(rig, mode, Modality::Frames);
  if (events != nullptr) event_camera_ = events->name;
  for (const RigCamera& camera : rig.cameras) {
    cameras_.push_back({camera.name, camera.modality, camera.model, &camera == events || &camera == frames});
  }
}

void Intake::add(Measurement measurement) {
  const std::lock_guard lock(mutex_);
  std::visit(
      [this](auto& item) {
        if (admit(item)) judge(std::move(item));
      },
      measurement);
}

/// Of events each is judged by itself.
void Intake::judge(EventBatch batch) {
  const std::size_t regular = events_.gate.push_first(batch.events);
  if (regular < batch.events.size()) {
    const auto rest = batch.events.begin() + static_cast<std::ptrdiff_t>(regular);
    std::vector<Event> passed(batch.events.begin(), rest);
    const auto pass = [&](const Event& event) { passed.push_back(event); };
    const auto drop = [&](const Event&, Timestamp) { ++counters_.far_ahead; };
    for (const Event& event : std::span(rest, batch.events.end())) events_.gate.push(event, pass, drop);
    batch.events = std::move(passed);
  }
  if (!batch.events.empty()) take(std::move(batch), events_.clock);
}

template <typename T>
void Intake::judge(Sensor<T>& sensor, T item) {
  std::vector<T> passed;
  sensor.gate.push(
      std::move(item), [&](T one) { passed.push_back(std::move(one)); },
      [&](const T&, Timestamp) { ++counters_.far_ahead; });
  for (T& one : passed) take(std::move(one), sensor.clock);
}

void Intake::take(Measurement measurement, ClockWatch& clock) {
  const Timestamp t = *last_stamp(measurement);
  if (clock.set_back(t)) begin_time();
  counters_.no_room += times_.back().add(std::move(measurement)) ? 0 : 1;
  // What waits near it has not come from a damaged stamp either, and still gets into its place.
  events_.gate.confirm(t, [this](const Event& event) { take(EventBatch{event_camera_, {event}}, events_.clock); });
  frames_.gate.confirm(t, [this](Frame frame) { take(std::move(frame), frames_.clock); });
  imu_.gate.confirm(t, [this](const ImuSample& sample) { take(sample, imu_.clock); });
}

void Intake::begin_time() {
  ++counters_.clocks_set_back;
  events_ = {};
  frames_ = {};
  imu_ = {};
  times_.back().finish();
  if (times_.size() == kMostTimes) {  // next() has not been called for long
    counters_.no_room += times_.back().waiting();
    times_.pop_back();
  }
  times_.emplace_back(mode_, delays_);
}

void Intake::finish() {
  const std::lock_guard lock(mutex_);
  events_.gate.finish([this](const Event& event) { take(EventBatch{event_camera_, {event}}, events_.clock); });
  frames_.gate.finish([this](Frame frame) { take(std::move(frame), frames_.clock); });
  imu_.gate.finish([this](const ImuSample& sample) { take(sample, imu_.clock); });
  times_.back().finish();
}

std::optional<Intake::Item> Intake::next() {
  const std::lock_guard lock(mutex_);
  while (true) {
    if (std::optional<Measurement> measurement = times_.front().next())
      return Item{std::move(*measurement), std::exchange(begins_time_, false)};
    if (times_.size() == 1 || !times_.front().ended()) return std::nullopt;
    times_.pop_front();
    begins_time_ = true;
  }
}

bool Intake::ended() const {
  const std::lock_guard lock(mutex_);
  return times_.size() == 1 && times_.front().ended();
}

IntakeCounters Intake::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

const Intake::Camera* Intake::find(const std::string& name, Modality modality) {
  const auto found = std::ranges::find_if(
      cameras_, [&](const Camera& camera) { return camera.name == name && camera.modality == modality; });
  if (found != cameras_.end() && found->used) return &*found;
  ++(found == cameras_.end() ? counters_.unknown_camera : counters_.unused_camera);
  return nullptr;
}

/// Takes out events that cannot be.
bool Intake::admit(EventBatch& batch) {
  const Camera* camera = find(batch.camera, Modality::Events);
  if (camera == nullptr) return false;
  const int width = camera->model.width(), height = camera->model.height();
  counters_.events_outside +=
      std::erase_if(batch.events, [=](const Event& event) { return event.x >= width || event.y >= height; });
  counters_.absurd_stamps += std::erase_if(batch.events, [](const Event& event) { return !is_plausible(event.t); });
  // What is masked must not cut packets either, nor pass for motion.
  if (camera->model.is_masked())
    std::erase_if(batch.events, [&](const Event& event) { return !camera->model.uses(event.x, event.y); });
  return !batch.events.empty();
}

bool Intake::admit(Frame& frame) {
  const Camera* camera = find(frame.camera, Modality::Frames);
  if (camera == nullptr) return false;
  cv::Mat& image = frame.image;
  const bool fits =
      image.type() == CV_8UC1 && image.cols == camera->model.width() && image.rows == camera->model.height();
  counters_.frames_unfit += fits ? 0 : 1;
  if (fits && image.u == nullptr) image = image.clone();  // a driver's memory, which may be gone by the time it is used
  counters_.absurd_stamps += is_plausible(frame.t) ? 0 : 1;
  return fits && is_plausible(frame.t);
}

bool Intake::admit(const ImuSample& sample) {
  counters_.absurd_stamps += is_plausible(sample.t) ? 0 : 1;
  return is_plausible(sample.t);
}

}  // namespace edged
