// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/calibrate/collector.hpp"

#include <spdlog/fmt/fmt.h>

#include <utility>

#include "edged/calibrate/coverage.hpp"
#include "edged/core/check.hpp"

namespace edged {

ViewCollector::ViewCollector(const TargetSpec& spec, const CollectorOptions& options)
    : detector_(spec), options_(options) {}

void ViewCollector::add(const Measurement& measurement) {
  if (const auto* sample = std::get_if<ImuSample>(&measurement)) {
    if (sample->gyro_B.allFinite() && sample->accel_B.allFinite() && (imu_.empty() || sample->t > imu_.back().t))
      imu_.push_back(*sample);
  } else if (const auto* frame = std::get_if<Frame>(&measurement)) {
    if (options_.frames) take_frame(*frame);
  } else if (const auto* batch = std::get_if<EventBatch>(&measurement)) {
    if (options_.events) take_events(*batch);
  }
}

void ViewCollector::finish() {
  for (auto& [name, camera] : event_cameras_) camera.pictures->finish();
}

TargetViews& ViewCollector::camera(const std::string& name, Modality modality, cv::Size size) {
  TargetViews& out = cameras_[name];
  if (out.width == 0) {
    out.name = name, out.modality = modality;
    out.width = size.width, out.height = size.height;
  }
  if (size.width != out.width || size.height != out.height)
    throw InputError::format("camera {}: a picture of {} x {} px after one of {} x {}; all must have one size", name,
                             size.width, size.height, out.width, out.height);
  return out;
}

void ViewCollector::search(TargetViews& camera, Timestamp t, const cv::Mat& picture) {
  ++camera.pictures;
  std::vector<TargetCorner> corners = detector_.detect(picture);
  if (!corners.empty()) camera.views.push_back({t, std::move(corners)});
}

void ViewCollector::take_frame(const Frame& frame) {
  const auto last = last_frame_.find(frame.camera);
  // A stamp that is far ahead must not hide the frames after it.
  if (last != last_frame_.end() && frame.t >= last->second && frame.t - last->second < options_.frame_interval) return;
  last_frame_[frame.camera] = frame.t;
  search(camera(frame.camera, Modality::Frames, frame.image.size()), frame.t, frame.image);
  for (auto& [name, events] : event_cameras_) ask_for(events, frame.t);
}

void ViewCollector::ask_for(EventCamera& camera, Timestamp t) const {
  if (camera.last_instant && t < *camera.last_instant + options_.event_interval) return;
  camera.last_instant = t;
  camera.pictures->add_instant(t);
}

void ViewCollector::take_events(const EventBatch& batch) {
  if (batch.events.empty()) return;
  const auto sensor = options_.event_sensors.find(batch.camera);
  if (sensor == options_.event_sensors.end()) return;
  EventCamera& events = event_cameras_[batch.camera];
  if (!events.pictures) {
    TargetViews& views = camera(batch.camera, Modality::Events, sensor->second);
    events.pictures = std::make_unique<TargetPictures>(
        views.width, views.height, [this, &views](Timestamp t, const cv::Mat& picture) { search(views, t, picture); });
  }
  if (last_frame_.empty()) ask_for(events, batch.events.front().t);
  events.pictures->add(batch.events);
}

std::vector<TargetViews> ViewCollector::cameras() const {
  std::vector<TargetViews> out;
  for (const auto& [name, camera] : cameras_) out.push_back(camera);
  return out;
}

std::string ViewCollector::progress() const {
  std::string out;
  for (const auto& [name, camera] : cameras_) {
    CornerCells cells;
    for (const TargetView& view : camera.views) cells.add(view, camera.width, camera.height);
    const std::string missing = camera.views.empty() ? "all of the image" : cells.empty_parts();
    out += fmt::format("{}{} {} of {}{}{}", out.empty() ? "" : "; ", name, camera.views.size(), camera.pictures,
                       missing.empty() ? "" : ", missing ", missing);
  }
  return out;
}

}  // namespace edged
