// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/survey/survey.hpp"

#include <algorithm>
#include <opencv2/core.hpp>

#include "edged/core/path_length.hpp"

namespace edged {
namespace {

constexpr Duration kEventSilence = std::chrono::milliseconds(100);

TruthSurvey survey_truth(const GroundTruth& truth) {
  TruthSurvey survey;
  survey.frame = truth.frame;
  StreamSurveyor stream;
  for (const StampedPose& pose : truth.trajectory) stream.add(pose.t, pose.t);
  survey.path_m = path_length(truth.trajectory, &StampedPose::T);
  survey.stream = stream.result();
  return survey;
}

}  // namespace

Duration Survey::overlap() const {
  Timestamp begin = Timestamp::min(), end = Timestamp::max();
  for (const StreamSurvey* stream : {&events, &frames, &imu}) {
    if (stream->count == 0) continue;
    begin = std::max(begin, *stream->begin);
    end = std::min(end, *stream->end);
  }
  return begin == Timestamp::min() ? Duration(0) : end - begin;
}

Surveyor::Surveyor(const DatasetInfo& info) : info_(info), events_(kEventSilence), event_details_(info.event_sensor) {}

void Surveyor::add(const Measurement& measurement, Detail detail) {
  if (const auto* batch = std::get_if<EventBatch>(&measurement)) {
    if (batch->events.empty()) return;
    events_.add(batch->events.front().t, batch->events.back().t, batch->events.size());
    if (detail == Detail::All) event_details_.add(batch->events);
  } else if (const auto* frame = std::get_if<Frame>(&measurement)) {
    frames_.add(frame->t, frame->t);
    if (image_size_.empty()) image_size_ = frame->image.size();
    if (detail != Detail::All) return;
    brightness_sum_ += cv::mean(frame->image)[0];
    ++measured_frames_;
  } else if (const auto* sample = std::get_if<ImuSample>(&measurement)) {
    imu_.add(sample->t, sample->t);
    imu_details_.add(*sample);
  } else if (const auto* external = std::get_if<ExternalSample>(&measurement)) {
    external_[std::string(sensor_of(*external).name)].add(*external);
  }
}

Survey Surveyor::so_far() const {
  Survey survey;
  survey.info = info_;
  survey.events = events_.result();
  survey.frames = frames_.result();
  survey.imu = imu_.result();
  survey.event_details = event_details_.result();
  survey.imu_details = imu_details_.result();
  survey.image_size = image_size_;
  for (const auto& [name, surveyor] : external_) survey.external[name] = surveyor.result();
  if (measured_frames_ > 0) survey.mean_brightness = brightness_sum_ / static_cast<double>(measured_frames_);
  return survey;
}

Survey Surveyor::result(const Dataset& dataset, const std::optional<GroundTruth>& truth) const {
  Survey survey = so_far();
  survey.info = dataset.info();
  if (truth) survey.truth = survey_truth(*truth);
  survey.repairs = dataset.repairs();
  return survey;
}

}  // namespace edged
