// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/recording_statistics.hpp"

#include <algorithm>
#include <opencv2/core.hpp>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

constexpr Duration kEventSilence = std::chrono::milliseconds(100);

/// A recording of that camera alone.
DatasetInfo info_of(const RecordedCamera& camera, const DatasetInfo& of) {
  DatasetInfo info;
  info.name = of.name;
  info.format = of.format;
  info.has_events = camera.modality == Modality::Events;
  info.has_frames = !info.has_events;
  info.event_camera = info.frame_camera = camera.name;
  info.event_sensor = camera.sensor;
  return info;
}

}  // namespace

Duration RecordingStatistics::overlap() const {
  Timestamp begin = Timestamp::min(), end = Timestamp::max();
  for (const StreamStatistics* stream : {&events, &frames, &imu}) {
    if (stream->count == 0) continue;
    begin = std::max(begin, *stream->begin);
    end = std::min(end, *stream->end);
  }
  for (const RecordingStatistics& camera : more) {
    const StreamStatistics& stream = camera.info.has_events ? camera.events : camera.frames;
    if (stream.count == 0) continue;
    begin = std::max(begin, *stream.begin);
    end = std::min(end, *stream.end);
  }
  return begin == Timestamp::min() ? Duration(0) : end - begin;
}

std::optional<std::pair<Timestamp, Timestamp>> RecordingStatistics::cameras() const {
  std::optional<std::pair<Timestamp, Timestamp>> span;
  for (const StreamStatistics* stream : {&events, &frames}) {
    if (stream->count == 0) continue;
    if (!span) span = {*stream->begin, *stream->end};
    span = {std::min(span->first, *stream->begin), std::max(span->second, *stream->end)};
  }
  return span;
}

double RecordingStatistics::imu_span_ratio() const {
  const auto span = cameras();
  return span && span->second > span->first ? to_seconds(imu.length()) / to_seconds(span->second - span->first) : 0.0;
}

RecordingCollector::RecordingCollector(const DatasetInfo& info)
    : info_(info), events_(kEventSilence), event_details_(info.event_sensor) {
  for (const RecordedCamera& camera : info.more_cameras) more_.emplace_back(info_of(camera, info));
}

void RecordingCollector::add(const Measurement& measurement, Detail detail, std::size_t every) {
  if (const std::string* camera = camera_of(measurement); camera && !more_.empty())
    for (std::size_t i = 0; i < more_.size(); ++i)
      if (info_.more_cameras[i].name == *camera) return more_[i].add(measurement, detail, every);
  if (const auto* batch = std::get_if<EventBatch>(&measurement)) {
    if (batch->events.empty()) return;
    events_.add(batch->events.front().t, batch->events.back().t, batch->events.size());
    if (detail != Detail::All) return;
    event_details_.add(batch->events, every);
    watch_image(*batch);
  } else if (const auto* frame = std::get_if<Frame>(&measurement)) {
    frames_.add(frame->t, frame->t);
    if (image_size_.empty()) image_size_ = frame->image.size();
    if (detail != Detail::All) return;
    brightness_sum_ += cv::mean(frame->image)[0];
    ++measured_frames_;
    count_repeated(frame->image);
    watch_image(*frame);
  } else if (const auto* sample = std::get_if<ImuSample>(&measurement)) {
    for (const ImuSample& passed : gate_.push(*sample)) imu_.add(passed.t, passed.t), imu_details_.add(passed);
  } else if (const auto* external = std::get_if<ExternalSample>(&measurement)) {
    external_[std::string(sensor_of(*external).name)].add(*external);
  }
}

/// True if the image moves, by comparison with an earlier frame: a rotation of a few degrees changes more pixels than
/// noise and flicker.
void RecordingCollector::watch_image(const Frame& frame) {
  constexpr Duration kApart = std::chrono::milliseconds(300);
  constexpr double kNoise = 4.0, kOfContrast = 0.15;  // grey levels; share of their standard deviation
  if (compared_.size() == frame.image.size()) {
    if (frame.t - compared_at_ < kApart) return;
    cv::Scalar mean, deviation;
    cv::meanStdDev(frame.image, mean, deviation);
    const double changed = cv::norm(frame.image, compared_, cv::NORM_L1) / static_cast<double>(frame.image.total());
    if (changed > kNoise + kOfContrast * deviation[0]) imu_details_.image_moves();
  }
  compared_ = frame.image;
  compared_at_ = frame.t;
}

/// True if the events show motion of the image. Noise, flicker and walkers cause fewer events than a rotation.
void RecordingCollector::watch_image(const EventBatch& batch) {
  constexpr Duration kCounted = std::chrono::milliseconds(100);
  constexpr double kQuiet = 1.0;  // events a pixel and second
  const Timestamp now = batch.events.back().t;
  counted_ += batch.events.size();
  if (now - counted_from_ < kCounted) return;
  const double rate = static_cast<double>(std::exchange(counted_, 0)) / to_seconds(now - counted_from_);
  if (!info_.event_sensor.empty() && rate > kQuiet * info_.event_sensor.area()) imu_details_.image_moves();
  counted_from_ = now;
}

/// Images at rest, or of darkness, are alike for longer.
void RecordingCollector::count_repeated(const cv::Mat& image) {
  constexpr std::size_t kMostAlike = 5;
  if (before_.size() == image.size() && cv::norm(image, before_, cv::NORM_INF) == 0.0) {
    ++alike_;
  } else if (const std::size_t alike = std::exchange(alike_, 0); alike <= kMostAlike) {
    repeated_ += alike;
  }
  before_ = image;
}

RecordingStatistics RecordingCollector::so_far() const {
  RecordingStatistics statistics;
  statistics.info = info_;
  statistics.events = events_.result();
  statistics.frames = frames_.result();
  statistics.imu = imu_.result();
  statistics.event_details = event_details_.result();
  statistics.imu_details = imu_details_.result();
  statistics.imu_faults = gate_.faults();
  statistics.image_size = image_size_;
  for (const RecordingCollector& camera : more_) statistics.more.push_back(camera.so_far());
  for (const auto& [name, collector] : external_) statistics.external[name] = collector.result();
  if (measured_frames_ > 0) {
    statistics.mean_brightness = brightness_sum_ / static_cast<double>(measured_frames_);
    statistics.repeated_share = static_cast<double>(repeated_) / static_cast<double>(measured_frames_);
  }
  return statistics;
}

RecordingStatistics RecordingCollector::result(const Dataset& dataset, const std::optional<GroundTruth>& truth) const {
  RecordingStatistics statistics = so_far();
  statistics.info = dataset.info();
  for (std::size_t i = 0; i < statistics.more.size() && i < statistics.info.more_cameras.size(); ++i)
    statistics.more[i].info.event_sensor = statistics.info.more_cameras[i].sensor;
  if (truth) statistics.truth = truth_statistics(*truth);
  statistics.repairs = dataset.repairs();
  return statistics;
}

}  // namespace edged
