// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/intake.hpp"

#include <algorithm>
#include <utility>

namespace edged {
namespace {

/// Farther from zero, differences of stamps would not fit into a Duration.
constexpr Duration kLongestTime(std::int64_t{1} << 62U);

bool absurd(Timestamp t) { return t.time_since_epoch() > kLongestTime || t.time_since_epoch() < -kLongestTime; }

}  // namespace

Intake::Intake(const Rig& rig, Mode mode, const SensorDelays& delays) : sequencer_(mode, delays) {
  const RigCamera* events = mode == Mode::Frames ? nullptr : rig.find(Modality::Events);
  const RigCamera* frames = mode == Mode::Events ? nullptr : rig.find(Modality::Frames);
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
  counters_.absurd_stamps += std::erase_if(batch.events, [](const Event& event) { return absurd(event.t); });
  return !batch.events.empty();
}

bool Intake::admit(const Frame& frame) {
  const Camera* camera = find(frame.camera, Modality::Frames);
  if (camera == nullptr || !camera->used) return false;
  const cv::Mat& image = frame.image;
  const bool fits = image.type() == CV_8UC1 && image.cols == camera->width && image.rows == camera->height;
  counters_.frames_unfit += fits ? 0 : 1;
  counters_.absurd_stamps += absurd(frame.t) ? 1 : 0;
  return fits && !absurd(frame.t);
}

bool Intake::admit(const ImuSample& sample) {
  counters_.absurd_stamps += absurd(sample.t) ? 1 : 0;
  return !absurd(sample.t);
}

}  // namespace edged
