// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/intake.hpp"

#include <algorithm>
#include <utility>

#include "edged/core/measurement_stamps.hpp"

namespace edged {
namespace {

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

Intake::Intake(const Rig& rig, Mode mode, const SensorDelays& delays)
    : sequencer_(mode, as_recorded(delays, rig, mode)) {
  const RigCamera* events = used_camera(rig, mode, Modality::Events);
  const RigCamera* frames = used_camera(rig, mode, Modality::Frames);
  for (const RigCamera& camera : rig.cameras) {
    cameras_.push_back({camera.name, camera.modality, camera.model.width(), camera.model.height(),
                        &camera == events || &camera == frames});
  }
}

bool Intake::add(Measurement measurement) {
  const std::lock_guard lock(mutex_);
  if (!std::visit([this](auto& item) { return admit(item); }, measurement)) return false;
  const bool taken = sequencer_.add(std::move(measurement));
  counters_.no_room += taken ? 0 : 1;
  return taken;
}

void Intake::finish() {
  const std::lock_guard lock(mutex_);
  sequencer_.finish();
}

std::optional<Measurement> Intake::next() {
  const std::lock_guard lock(mutex_);
  return sequencer_.next();
}

bool Intake::ended() const {
  const std::lock_guard lock(mutex_);
  return sequencer_.ended();
}

IntakeCounters Intake::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

const Intake::Camera* Intake::find(const std::string& name, Modality modality) {
  const auto found = std::ranges::find_if(
      cameras_, [&](const Camera& camera) { return camera.name == name && camera.modality == modality; });
  if (found != cameras_.end()) return &*found;
  ++counters_.unknown_camera;
  return nullptr;
}

/// Takes out events that cannot be.
bool Intake::admit(EventBatch& batch) {
  const Camera* camera = find(batch.camera, Modality::Events);
  if (camera == nullptr || !camera->used) return false;
  const int width = camera->width, height = camera->height;
  counters_.events_outside +=
      std::erase_if(batch.events, [=](const Event& event) { return event.x >= width || event.y >= height; });
  counters_.absurd_stamps += std::erase_if(batch.events, [](const Event& event) { return !is_plausible(event.t); });
  return !batch.events.empty();
}

bool Intake::admit(Frame& frame) {
  const Camera* camera = find(frame.camera, Modality::Frames);
  if (camera == nullptr || !camera->used) return false;
  cv::Mat& image = frame.image;
  const bool fits = image.type() == CV_8UC1 && image.cols == camera->width && image.rows == camera->height;
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
